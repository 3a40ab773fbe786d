"""Somebody stands on a border for a minute with 20 mm RMS of white 3-D noise on every joint at 30 Hz: flips, and delay.

Everything behind the tracker is the real pipeline. The delay is that of zones, task and bins alone: from the true
crossing, under the same noise, to the frame that follows it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1] / "tests" / "support"))

import itertools

from scripted import Rig, engaged
from stick_figure import Person, raised

from teleop.config import TeleopConfig
from teleop.pipeline import PipelineOutput

RMS_MM, HZ, MINUTE_S = 20.0, 30, 60
Shown = Callable[[Rig, PipelineOutput], object]
WORK = Person(legs_apart_deg=25)


def _zone(_: Rig, out: PipelineOutput) -> object:
    return out.intent.zone


def _mode(_: Rig, out: PipelineOutput) -> object:
    return out.intent.mode


def _stride(r: Rig, _: PipelineOutput) -> object:
    return r.state.intent.task.stride.above


def _arm(_: Rig, out: PipelineOutput) -> object:
    arm = out.command.right_arm
    return None if arm is None else (arm.c1_deg, arm.c2_deg)


def flips(person: Person, shown: Shown, seed: int, seconds: int = MINUTE_S) -> int:
    """Changes of what is shown in a minute, after three seconds to settle."""
    r = engaged(TeleopConfig(), person)
    r.rng = np.random.default_rng(seed)
    seen = [shown(r, r.show(person)) for _ in range((3 + seconds) * HZ)][3 * HZ :]
    return sum(a != b for a, b in itertools.pairwise(seen))


def delay_s(path: Sequence[Person], crossed: int, shown: Shown, seed: int) -> float | None:
    """Time from frame ``crossed`` of a movement to the first other answer, under the same noise; None: never."""
    r = engaged(TeleopConfig(), path[0])
    r.rng = np.random.default_rng(seed)
    before = [shown(r, r.show(path[0])) for _ in range(3 * HZ)][-1]
    for i, person in enumerate((*path, *([path[-1]] * 2 * HZ))):
        if shown(r, r.show(person)) != before:
            return (i - crossed) / HZ
    return None


def _walk(a: tuple[float, float], b: tuple[float, float], legs: float = 25.0) -> list[Person]:
    """From a to b at 0.8 m/s."""
    n = round(np.hypot(b[0] - a[0], b[1] - a[1]) / 0.8 * HZ)
    return [Person(*(np.array(a) + (np.array(b) - a) * i / n), legs_apart_deg=legs) for i in range(n + 1)]


def _swept(make: Callable[[float], Person], a: float, b: float, seconds: float) -> list[Person]:
    n = round(seconds * HZ)
    return [make(a + (b - a) * i / n) for i in range(n + 1)]


def _row(name: str, counts: Iterable[int], delays: Iterable[float | None]) -> tuple[int, str]:
    counted, known = list(counts), [d for d in delays if d is not None]
    late = f"{1e3 * np.median(known):.0f} | {1e3 * np.percentile(known, 95):.0f}" if known else "- | -"
    return sum(counted), f"| {name} | {len(counted)} | {sum(counted)} | {late} |"


def main(seeds: int = 1) -> bool:
    """Print the table; False when anything flipped. About a minute."""
    print(f"{RMS_MM:.0f} mm RMS, {HZ} Hz, one minute each; movements at 0.8 m/s, 40 deg/s (legs), 60 deg/s (arms)")
    print("| border | minutes | flips | delay p50 [ms] | p95 [ms] |\n|---|---:|---:|---:|---:|")
    total = 0
    places = {
        "out - forward": ((0.0, 1.4), (0.0, 1.75), (0.0, 1.2)),
        "forward - work": ((0.0, 1.9), (0.0, 1.65), (0.0, 2.15)),
        "work - back": ((0.0, 2.8), (0.0, 2.5), (0.0, 3.1)),
        "back - out": ((0.0, 3.4), (0.0, 3.2), (0.0, 3.7)),
        "work - right": ((0.4, 2.3), (0.1, 2.3), (0.7, 2.3)),
        "work - left": ((-0.4, 2.3), (-0.1, 2.3), (-0.7, 2.3)),
        "right - out": ((0.9, 2.3), (0.7, 2.3), (1.1, 2.3)),
        "corner of four zones": ((0.4, 1.9), (0.2, 1.7), (0.6, 2.1)),
    }
    for name, (border, a, b) in places.items():
        path = _walk(a, b)
        share = np.hypot(border[0] - a[0], border[1] - a[1]) / np.hypot(b[0] - a[0], b[1] - a[1])
        crossed = round(share * (len(path) - 1))
        some = [delay_s(path, crossed, _zone, s) for s in range(3)]
        count, line = _row(name, [flips(Person(*border), _zone, s) for s in range(seeds)], some)
        total += count
        print(line, flush=True)
    for name, make, edge, shown in (
        ("T1: spraying - picking", lambda d: Person(legs_apart_deg=d), 12.0, _mode),
        ("T2: head camera", lambda d: WORK.but(stride_deg=d), 14.0, _stride),
    ):
        up, down = (_swept(make, edge - s * 9, edge + s * 9, 0.45) for s in (1, -1))
        some = [delay_s(p, len(p) // 2, shown, s) for p in (up, down) for s in range(3)]
        count, line = _row(name, [flips(make(edge), shown, s) for s in range(seeds)], some)
        total += count
        print(line, flush=True)
    for plane in ("outward_deg", "forward_deg"):
        counts, some = [], []
        for edge in (7.5, 22.5, 37.5, 52.5, 67.5, 82.5):

            def make(d: float, plane: str = plane) -> Person:
                return WORK.but(right=raised(**{plane: d}))

            counts += [flips(make(edge), _arm, s) for s in range(seeds)]
            path = _swept(make, edge - 7.5, edge + 7.5, 0.25)
            some += [delay_s(path, len(path) // 2, _arm, s) for s in range(3)]
        count, line = _row(f"15-degree bins, {plane.removesuffix('_deg')}", counts, some)
        total += count
        print(line, flush=True)
    print(f"\n{total} flips")
    return total == 0


if __name__ == "__main__":
    main()
