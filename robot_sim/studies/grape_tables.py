"""The grape study's tables: trials one by one, success rates with intervals, margins, localisation, planners."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np

from robot_sim.planner import path_length, rrt_connect
from robot_sim.studies.config import GrapeStudyConfig
from robot_sim.studies.grape_plan import approaches, level_pose
from robot_sim.studies.grape_scene import camera_error, make_scene, seen_scene
from robot_sim.studies.grape_trial import SELF_PAIRS, Outcome, PickWorld, find_plan, run_pick
from robot_sim.studies.report import Cell, Table, table

CM, MM = 100.0, 1000.0


def wilson(successes: int, n: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson 1927), 0..1."""
    if n == 0:
        return 0.0, 1.0
    z, p = 1.96, successes / n
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return middle - half, middle + half


def run_trials(
    at: PickWorld,
    count: int,
    overlapping: bool | None,
    looks: int,
    seed: int,
    tick: Callable[[], None],
    height_m: float | None = None,
) -> list[Outcome]:
    """Random trials; overlapping None alternates. The same seed gives the same scenes whatever the looks."""
    out = []
    for k in range(count):
        rng = np.random.default_rng((seed, k))
        pair = bool(k % 2) if overlapping is None else overlapping
        scene = make_scene(at.study, pair, rng)
        seen, _ = seen_scene(scene, at.study, looks, rng)
        out.append(run_pick(at, scene, seen, height_m)[0])
        tick()
    return out


def share(outcomes: Sequence[Outcome]) -> float:
    """Share of successes, 0..1."""
    return sum(o.success for o in outcomes) / max(1, len(outcomes))


def trial_table(outcomes: Sequence[Outcome], name: str, title: str) -> Table:
    """One row a trial, as the source's table 1."""
    rows: list[tuple[Cell, ...]] = [
        (
            i,
            "pair" if o.overlapping else "single",
            o.path_m * CM,
            o.key_points,
            o.collision,
            o.minima,
            o.plans,
            o.tray_deg,
            "success" if o.success else o.failure,
        )
        for i, o in enumerate(outcomes, start=1)
    ]
    header = (
        "trial",
        "bunches",
        "path [cm]",
        "key points",
        "collision",
        "minima left",
        "plans",
        "tray [deg]",
        "result",
    )
    return table(name, title, header, rows)


def _range(values: Sequence[float]) -> str:
    known = [v for v in values if not math.isnan(v)]
    return f"{min(known):.2f}-{max(known):.2f}" if known else "-"


def against_source(outcomes: Sequence[Outcome]) -> Table:
    """The 18 virtual trials beside the source's table 1."""
    good = [o for o in outcomes if o.key_points]
    rows: list[tuple[Cell, ...]] = [
        (
            "success",
            "16 of 18 (88.89 %)",
            f"{sum(o.success for o in outcomes)} of {len(outcomes)} ({share(outcomes):.2%})",
        ),
        ("path length [cm]", "219.26-282.46", _range([o.path_m * CM for o in good])),
        (
            "key points",
            "34-43",
            f"{min(o.key_points for o in good)}-{max(o.key_points for o in good)}" if good else "-",
        ),
        ("collisions", "2", str(sum(o.collision for o in outcomes))),
    ]
    return table("against_source", "18 virtual trials beside the source's", ("measure", "source", "here"), rows)


def rates_table(groups: Sequence[tuple[str, str, Sequence[Outcome]]]) -> Table:
    """Success by group with 95 % intervals; groups are (name, the source's figure, outcomes)."""
    rows: list[tuple[Cell, ...]] = []
    for name, source, outcomes in groups:
        wins = sum(o.success for o in outcomes)
        low, high = wilson(wins, len(outcomes))
        planned = [o for o in outcomes if o.key_points]
        rows.append(
            (
                name,
                source,
                len(outcomes),
                100 * share(outcomes),
                f"{100 * low:.1f}-{100 * high:.1f}",
                sum(o.collision for o in outcomes),
                len(outcomes) - len(planned),
                float(np.mean([o.path_m for o in planned])) * CM if planned else math.nan,
            )
        )
    header = ("trials", "source [%]", "n", "success [%]", "95 % interval", "touched", "no plan", "mean path [cm]")
    return table(
        "success", "Success: clamped, carried, cut, delivered, no finger or blade touched a bunch", header, rows
    )


def failure_table(outcomes: Sequence[Outcome]) -> Table:
    """What failed, how often."""
    counted = Counter(("pair" if o.overlapping else "single", o.failure) for o in outcomes if not o.success)
    rows = [(kind, why, n) for (kind, why), n in counted.most_common()] or [("-", "nothing", 0)]
    return table("failures", "What failed in the random trials", ("bunches", "failure", "times"), rows)


def margin_table(
    at: PickWorld, count: int, looks: int, seed: int, tick: Callable[[], None]
) -> tuple[Table, list[tuple[float, float, float]]]:
    """Success against a fixed margin H1 over the bunch, single and overlapping; and against the window's middle."""
    rows: list[tuple[Cell, ...]] = []
    curve = []
    half = at.arm_config.finger_height_m / 2
    for h1 in (0.0, 0.003, 0.006, 0.010, 0.015, 0.020, 0.030, None):
        height = None if h1 is None else half + h1
        groups = [run_trials(at, count, pair, looks, seed, tick, height) for pair in (False, True)]
        shares = [100 * share(g) for g in groups]
        refused = sum(o.key_points == 0 for g in groups for o in g)
        label: Cell = "middle of the bare peduncle" if h1 is None else h1 * MM
        rows.append((label, count, *shares, refused))
        if h1 is not None:
            curve.append((h1 * MM, shares[0], shares[1]))
    title = f"Success against the safety margin H1, {'one look' if looks == 1 else f'{looks} looks'}"
    return table("margin", title, ("H1 [mm]", "n each", "single [%]", "overlapping [%]", "refused"), rows), curve


def localisation_table(study: GrapeStudyConfig, count: int, seed: int) -> Table:
    """The camera's error alone, apart from success: Ex, Ez (12), (13) and the share within the source's limit."""
    rows: list[tuple[Cell, ...]] = []
    for pair, source in ((False, "5.46 / 6.56, 93.33 %"), (True, "6.34 / 7.87, 82.14 %")):
        for looks in (1, study.looks):
            rng = np.random.default_rng((seed, looks, pair))
            ahead = np.array([1.0, 0.0, 0.0])  # depth is x, across is y
            errors = [camera_error(study, pair, ahead, looks, rng)[[1, 0]] for _ in range(count)]
            a = np.abs(np.array(errors))
            near = float((np.hypot(a[:, 0], a[:, 1]) <= study.close_m).mean())
            kind = "overlapping" if pair else "single"
            rows.append((kind, looks, float(a[:, 0].mean()) * MM, float(a[:, 1].mean()) * MM, 100 * near, source))
    header = (
        "bunches",
        "looks",
        "Ex [mm]",
        "Ez [mm]",
        "within 10 mm of the point [%]",
        "source: Ex / Ez [mm], within 10 mm",
    )
    return table("localisation", "Localisation apart from picking", header, rows)


def planner_table(at: PickWorld, count: int, seed: int, tick: Callable[[], None]) -> Table:
    """Potential field and RRT-Connect from start to ready pose on the same scenes, both checked by PyBullet."""
    field_s, rrt_s, field_m, rrt_m = [], [], [], []
    solved = [0, 0]
    for k in range(count):
        rng = np.random.default_rng((seed, 7, k))
        scene = make_scene(at.study, bool(k % 2), rng)
        at.clear()
        began = time.perf_counter()
        plan, _, _ = find_plan(at, scene)
        field_s.append(time.perf_counter() - began)
        if plan is not None:
            solved[0] += 1
            field_m.append(path_length(at.arm.chain.forward(at.dense(plan.out_q))[:, :3, 3]))
        a = plan.approach if plan is not None else approaches(scene, at.arm_config, at.study)[0]
        grip = scene.bunches[a.bunch].top_m + np.array([0.0, 0.0, a.height_m])
        T = level_pose(grip, a.yaw_rad)
        T[:3, 3] -= at.study.back_off_m * T[:3, 2]
        goal = at.arm.inverse(T, q_ref=at.q_start).nearest(at.q_start)
        names = at.add_seen(scene)
        tool = a.tool()

        def is_free(q: np.ndarray, tool: np.ndarray = tool, names: tuple[str, ...] = names) -> bool:
            at.place(q, tool)
            return not at.world.contacts(0.0, names) and not at.world.self_contacts(SELF_PAIRS)

        began = time.perf_counter()
        found = None
        if goal is not None:
            found = rrt_connect(at.q_start, goal, at.arm.chain.lower, at.arm.chain.upper, is_free, rng)
        rrt_s.append(time.perf_counter() - began)
        if found is not None and found.ok:
            solved[1] += 1
            rrt_m.append(path_length(at.arm.chain.forward(found.path)[:, :3, 3]))
        at.clear()
        tick()
    rows: list[tuple[Cell, ...]] = []
    for name, wins, seconds, lengths, what in (
        ("potential field", solved[0], field_s, field_m, "the whole pick, all approaches tried"),
        ("RRT-Connect", solved[1], rrt_s, rrt_m, "start to ready pose only"),
    ):
        p50, p95 = np.percentile(seconds, [50, 95])
        length = float(np.median(lengths)) * CM if lengths else math.nan
        rows.append((name, f"{wins} of {count}", float(p50), float(p95), length, what))
    header = ("planner", "solved", "time p50 [s]", "time p95 [s]", "median tool path start-ready [cm]", "time covers")
    return table("planners", "Potential field and RRT-Connect on the same scenes", header, rows)
