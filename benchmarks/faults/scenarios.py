"""The faults: where the operator stands, what goes wrong, what the robot has to do, with which reason."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from benchmarks.faults.actors import flat, pictures
from benchmarks.faults.stage import Stage, with_joints
from benchmarks.faults.watch import ARMS, State, commanded_still
from robot_sim.clearance import margins_m
from robot_sim.commands import ARM_NAMES
from teleop.frames import DepthFrame
from teleop.joints import JOINT_INDEX

ACTING: Final = ("picking", "spraying", "forward", "back", "left", "right")
IDLE: Final = ("no_person", "seen", "engaged", "held", "stopped")
_STEADY_DEG: Final = 0.5


@dataclass(frozen=True, slots=True)
class Fault:
    """name; mode before it; begin: makes it happen.

    must: ``still`` (and stays so), ``steady`` (goes on, arms not displaced) or ``unmoved`` (either of them).
    reasons: one of these codes must be seen; none for what disturbs nobody and is answered by going on.
    watch_s: how long the outcome is watched.
    """

    name: str
    mode: str
    begin: Callable[[Stage], None]
    must: str
    reasons: tuple[str, ...]
    watch_s: float = 1.6


@dataclass(frozen=True, slots=True)
class Outcome:
    """What was seen. Times in ms after the fault began, None: never. displaced_deg: largest change of an arm target.
    stayed: nothing was commanded to move after the robot had been told to stand still."""

    fault: Fault
    command_ms: float | None
    rest_ms: float | None
    displaced_deg: float
    mode_after: str
    stayed: bool
    codes: tuple[str, ...] = field(default=())

    @property
    def fulfilled(self) -> bool:
        """Whether the robot did what it has to, with a reason."""
        reasoned = not self.fault.reasons or any(code in self.codes for code in self.fault.reasons)
        stood = self.command_ms is not None and self.rest_ms is not None and self.stayed
        steady = self.displaced_deg <= _STEADY_DEG and self.command_ms is None
        kept = {"still": stood, "steady": steady, "unmoved": self.displaced_deg <= _STEADY_DEG}
        return reasoned and kept[self.fault.must]

    @property
    def did(self) -> str:
        """In words."""
        if self.command_ms is None:
            return "went on, arms in place" if self.displaced_deg <= _STEADY_DEG else "went on, arms moved"
        return "stood still" if self.stayed else "stood still for a moment"


def _stamps(change: Callable[[int, int], int]) -> Callable[[Stage], None]:
    def begin(on: Stage) -> None:
        on.stamp = change

    return begin


def _scene(frame: Callable[[Stage], object]) -> Callable[[Stage], None]:
    def begin(on: Stage) -> None:
        picture = frame(on)
        on.scene = lambda _i: picture  # type: ignore[assignment, return-value]

    return begin


def _nothing(on: Stage) -> None:
    on.scene = lambda _i: None


def _kept(of: int) -> Callable[[Stage], None]:
    """One frame of so many comes."""

    def begin(on: Stage) -> None:
        seen = on.scene
        # those that come are not one and the same picture, which would count as frozen
        on.scene = lambda i: seen(i // of) if i % of == 0 else None

    return begin


def _duplicates(on: Stage) -> None:
    kept: dict[int, int] = {}
    on.stamp = lambda i, now_ns: kept.setdefault(i // 2, now_ns)


def _all_duplicates(on: Stage) -> None:
    now = time.monotonic_ns()
    on.stamp = lambda _i, _now: now


def _reordered(on: Stage) -> None:
    on.stamp = lambda i, now_ns: now_ns - (300_000_000 if i % 2 else 0)


def _nan(on: Stage) -> None:
    on.tracker.spoil = with_joints(lambda joints: np.full_like(joints, np.nan))


def _infinite(on: Stage) -> None:
    on.tracker.spoil = with_joints(lambda joints: np.full_like(joints, np.inf))


def _teleport(on: Stage) -> None:
    count = iter(range(10**9))

    def jump(joints: np.ndarray) -> np.ndarray:
        if next(count) % 6 == 0:  # one frame in six
            joints[[JOINT_INDEX[n] for n in ("elbow_right", "wrist_right", "hand_right")]] += (0.6, 1.1, 0.0)
        return joints

    on.tracker.spoil = with_joints(jump)


def _swapped(on: Stage) -> None:
    pairs = [(JOINT_INDEX[f"{n}_right"], JOINT_INDEX[f"{n}_left"]) for n in ("shoulder", "elbow", "wrist", "hand")]

    def swap(joints: np.ndarray) -> np.ndarray:
        for a, b in pairs:
            joints[[a, b]] = joints[[b, a]]
        return joints

    on.tracker.spoil = with_joints(swap)


def _other_pose(pose: str) -> Callable[[Stage], None]:
    def begin(on: Stage) -> None:
        on.scene = lambda i: pictures(pose)[i % len(pictures(pose))]

    return begin


def _two_sources(on: Stage) -> None:
    on.post("/robot/command", {"drive_m_s": 0.4, "right_arm": {"c1_deg": 90, "c2_deg": 90, "elbow_deg": 90}})


def _two_clients(on: Stage) -> None:
    on.post("/engage", client="a" * 16)
    on.post("/robot/command", {"drive_m_s": 0.4, "spray_on": True}, client="b" * 16)
    on.post("/lease/release", client="a" * 16)


def _estop(on: Stage) -> None:
    on.post("/estop")


def _estop_and_engage(on: Stage) -> None:
    on.post("/estop")
    on.post("/engage")


def _estop_and_reset(on: Stage) -> None:
    on.post("/estop")
    time.sleep(0.4)
    on.post("/estop/reset")


def _storm(on: Stage) -> None:
    rng = np.random.default_rng(1)
    clean = on.scene

    def noise(i: int) -> DepthFrame | None:
        frame = clean(i)
        return frame and replace(frame, depth_mm=rng.integers(500, 6000, frame.depth_mm.shape).astype(np.uint16))

    on.scene = noise


def _torn(on: Stage) -> None:
    clean = on.scene

    def upper_half(i: int) -> DepthFrame | None:
        frame = clean(i)
        if frame is None or i % 3:
            return frame
        depth_mm = frame.depth_mm.copy()
        depth_mm[len(depth_mm) // 2 :] = 0
        return replace(frame, depth_mm=depth_mm)

    on.scene = upper_half


def _frozen(on: Stage) -> None:
    picture = on.scene(0)
    on.scene = lambda _i: picture


FAULTS: Final[tuple[Fault, ...]] = (
    Fault("no more frames", "forward", _nothing, "still", ("hold.no_frame",)),
    Fault("no more frames", "spraying", _nothing, "still", ("hold.no_frame",)),
    Fault("every other frame dropped", "picking", _kept(2), "steady", ()),
    Fault("two of three frames dropped", "picking", _kept(3), "unmoved", ()),
    Fault("four of five frames dropped", "picking", _kept(5), "unmoved", ("hold.no_frame",)),
    Fault("every frame twice", "picking", _duplicates, "steady", ("refused.frame_duplicate",)),
    Fault("the same frame for ever", "forward", _all_duplicates, "still", ("refused.frame_duplicate",)),
    Fault("every other frame reordered", "picking", _reordered, "steady", ("refused.frame_reordered",)),
    Fault("frames 0.8 s late", "forward", _stamps(lambda _i, now: now - 800_000_000), "still",
          ("refused.frame_reordered", "refused.frame_stale")),
    Fault("stamps a minute ahead", "forward", _stamps(lambda _i, now: now + 60_000_000_000), "still",
          ("refused.frame_future",)),
    Fault("blank frames", "forward", _scene(lambda _: flat(0)), "still", ("refused.frame_blank",)),
    Fault("saturated frames", "picking", _scene(lambda _: flat(4000)), "still", ("refused.frame_saturated",)),
    Fault("frozen picture, stamps go on", "forward", _frozen, "still", ("refused.frame_frozen",)),
    Fault("nothing but noise", "forward", _storm, "still", ("hold.tracking_lost", "refused.operator_jump")),
    Fault("lower half missing, one frame in three", "picking", _torn, "unmoved", ()),
    Fault("joints NaN", "picking", _nan, "still", ("hold.tracking_lost",)),
    Fault("joints infinite", "forward", _infinite, "still", ("refused.joint_not_finite",)),
    Fault("arm teleports, one frame in six", "picking", _teleport, "steady", ("refused.joint_jump",)),
    Fault("left and right swapped", "picking", _swapped, "steady", ("refused.joint_jump", "hold.not_facing")),
    Fault("operator gone", "forward", _other_pose("nobody"), "still", ("hold.tracking_lost",)),
    Fault("operator walked out", "right", _other_pose("outside"), "still",
          ("refused.operator_jump", "stop.out_of_range", "mode.operator_changed")),
    Fault("second person enters", "picking", _other_pose("picking, second person"), "steady", ()),
    Fault("second person takes the place", "forward", _other_pose("second person alone"), "still",
          ("mode.operator_changed", "hold.tracking_lost", "refused.operator_jump")),
    Fault("two sources command at once", "picking", _two_sources, "steady", ("refused.request_operator_engaged",)),
    Fault("two clients command at once", "picking", _two_clients, "steady", ("lease",)),
    Fault("camera unplugged", "forward", Stage.unplug, "still", ("stop.source_failed",)),
    *(
        Fault("forearms crossed", mode, _other_pose(f"{mode}, forearms crossed"), "still", ("stop.body",))
        for mode in ACTING
    ),
    *(Fault("emergency stop", mode, _estop, "still", ("stop.estop",)) for mode in (*ACTING, *IDLE)),
    Fault("emergency stop, then its reset", "picking", _estop_and_reset, "still", ("mode.estop_reset",)),
    Fault("engage during an emergency stop", "seen", _estop_and_engage, "still", ("refused.engage_estop",)),
)  # fmt: skip


def prepare(on: Stage, fault: Fault) -> None:
    """The operator in control, in the fault's mode, the arms arrived."""
    on.calm(fault.mode if fault.mode in ACTING else "picking" if fault.mode in ("seen", "engaged") else "forward")
    on.post("/estop/reset")
    if on.camera_gone:
        on.open()
    await_calm(on)
    if fault.mode == "seen":
        on.post("/disengage")
    elif fault.mode != "no_person":
        if fault.mode == "engaged":
            on.tracker.spoil = with_joints(_without_legs)  # so that they choose no task
        on.engage("forward" if fault.mode in ("held", "stopped") else fault.mode)
        settle(on, 5.0)
    if fault.mode in ("held", "no_person"):
        on.calm("nobody")
    if fault.mode == "stopped":
        on.calm("forward, forearms crossed")
    on.await_mode(fault.mode)


def _without_legs(joints: np.ndarray) -> np.ndarray:
    joints[[JOINT_INDEX[f"{name}_{side}"] for name in ("knee", "ankle", "foot") for side in ("right", "left")]] = np.nan
    return joints


def await_calm(on: Stage, calm_s: float = 0.7, most_s: float = 10.0) -> None:
    """Wait until the fault before is over: nothing refused, frames coming, nobody lost, for longer than a watchdog.

    Raises RuntimeError when that does not come.
    """
    begun_s = time.monotonic()
    while time.monotonic() - begun_s < most_s:
        time.sleep(0.05)
        recent = on.watch.since(max(begun_s, time.monotonic() - calm_s))
        codes = [code for _, state in recent for code in state["reasons"]]
        if time.monotonic() - begun_s > calm_s and recent and not any(c.startswith(_DISTURBED) for c in codes):
            return
    raise RuntimeError(f"the fault before is not over: {sorted(set(codes))}")


def settle(on: Stage, most_s: float) -> None:
    """Wait until arm targets do not change any more."""
    end = time.monotonic() + most_s
    while time.monotonic() < end:
        recent = on.watch.since(time.monotonic() - 0.8)
        told = [_targets(s) for _, s in recent]
        easing = any("limit.ease_in" in s["reasons"] or "hold.disc_turning" in s["reasons"] for _, s in recent)
        if told and not easing and all(t == told[0] for t in told):
            return
        time.sleep(0.1)


_DISTURBED = ("refused.", "stop.", "hold.no_frame", "hold.tracking_lost")


def _targets(state: State) -> dict[str, tuple[float, ...] | None]:
    command = state["command"]
    return {arm: tuple(command[arm].values()) if command[arm] else None for arm in ARMS}


_ATTEMPTS: Final = 3
_FRAMES_STAYED_AWAY: Final = frozenset({"hold.no_frame", "stop.no_frame", "mode.operator_changed"})
"""What the robot says where frames stay away, or come so late that the operator counts as a new one."""


def run(on: Stage, fault: Fault) -> Outcome:
    """One fault from a fresh start; the stage is left as it is.

    A robot that has to go on is tried again where frames stayed away for longer than the fault keeps them: the machine
    was busy, and it was right to stop.
    """
    for _ in range(_ATTEMPTS):
        outcome = _once(on, fault)
        busy = _FRAMES_STAYED_AWAY.intersection(outcome.codes).difference(fault.reasons)
        if outcome.fulfilled or fault.must == "still" or not busy:
            break
    return outcome


def _once(on: Stage, fault: Fault) -> Outcome:
    prepare(on, fault)
    on.refused.clear()
    before = _targets(on.watch.states[-1][1])
    begun_s = time.monotonic()
    fault.begin(on)
    time.sleep(fault.watch_s)
    seen = on.watch.since(begun_s)
    still_s = next((t for t, s in seen if commanded_still(s)), None)
    rest_s = None
    if still_s is not None:
        rest_s = next(
            (t for (t, s), (_, b) in zip(seen[1:], seen, strict=False) if t >= still_s and _rests(b, s)), None
        )
    displaced = 0.0
    for _, s in seen:
        for arm, target in _targets(s).items():
            old = before[arm]
            if target is not None and old is not None:
                # the elbow is continuous and trembles; the shoulder's steps must not change at all
                displaced = max(displaced, *(abs(a - b) for a, b in zip(target[:2], old[:2], strict=True)))
    codes = tuple(
        dict.fromkeys((*on.watch.codes_since(begun_s), *on.refused, *(c for _, s in seen for c in s["reasons"])))
    )
    last = seen[-1][1] if seen else {"mode": "?"}
    return Outcome(
        fault,
        None if still_s is None else 1e3 * (still_s - begun_s),
        None if rest_s is None else 1e3 * (rest_s - begun_s),
        displaced,
        str(last["mode"]),
        all(commanded_still(s) for t, s in seen if still_s is not None and t >= still_s),
        codes,
    )


def _rests(before: State, now: State) -> bool:
    robot, old = now["robot"], before["robot"]
    dt_s = robot["sim_time_s"] - old["sim_time_s"]
    if dt_s <= 0 or abs(robot["drive_m_s"]) > 0.02 or abs(robot["turn_rad_s"]) > 0.03 or robot["spray_on"]:
        return False
    arms = [f"{arm}_{axis}" for arm in ARM_NAMES for axis in ("c1", "c2", "elbow")]
    return all(abs(robot["joints"][j] - old["joints"][j]) / dt_s < 0.05 for j in arms)


def smallest_gap_m(on: Stage) -> float:
    """Nearest that two arms came in all that was watched [m]."""
    names = [f"{arm}_{axis}" for arm in ARM_NAMES for axis in ("c1", "c2", "elbow")]
    poses = [[s["robot"]["joints"][n] for n in names] for _, s in on.watch.states[::10]]
    return min(float(margins_m(q, on.watch.robot)[:3].min()) for q in poses)
