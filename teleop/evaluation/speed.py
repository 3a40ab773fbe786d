"""Depth frame to skeleton: milliseconds a frame, and by stage; 640x480, one person of about 25,000 pixels."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from teleop.evaluation.answers import Tracker
from teleop.evaluation.motions import FreeMotion
from teleop.evaluation.section import BATCHES_A_SEED, Bench, Section, table
from teleop.evaluation.stages import BESIDE, staged
from teleop.frames import DepthFrame

TIMED_PX = (20_000, 30_000)
"""Operators of this many pixels are timed: the published figures are for about 25,000."""
REPEATS = 4
PEOPLE = 6
FRAMES = 60


def step_seconds(tracker: Tracker, runs: Sequence[Sequence[DepthFrame]]) -> tuple[npt.NDArray[np.float64], list[int]]:
    """Wall seconds of each step over runs of frames, tracked in order, and the operator's pixels in them."""
    seconds, area = [], []
    for frames in runs:
        state = tracker.initial_state()
        for frame in frames:
            start = time.perf_counter()
            track, state = tracker.step(frame, state)
            seconds.append(time.perf_counter() - start)
            area.append(0 if track.mask is None else int(track.mask.sum()))
    return np.array(seconds), area


def stage_seconds(tracker: Tracker, runs: Sequence[Sequence[DepthFrame]]) -> dict[str, npt.NDArray[np.float64]]:
    """Seconds (F,) of each stage, and of the rest of the step."""
    laps = []
    with staged() as clock:
        for frames in runs:
            state = tracker.initial_state()
            for frame in frames:
                clock.lap()
                start = time.perf_counter()
                _, state = tracker.step(frame, state)
                whole = time.perf_counter() - start
                lap = clock.lap()
                laps.append(
                    {**lap, "rest of the step": whole - sum(v for k, v in lap.items() if not k.endswith(BESIDE))}
                )
    names = sorted({name for lap in laps for name in lap}, key=lambda n: -sum(lap.get(n, 0.0) for lap in laps))
    return {name: np.array([lap.get(name, 0.0) for lap in laps]) for name in names}


def timed_runs(bench: Bench, *, room: bool) -> list[list[DepthFrame]]:
    """People in motion whose operator has about the published number of pixels, REPEATS times over."""
    runs, found = [], 0
    with bench.counting(f"frames to time, {'in rooms' if room else 'cut out'}", 2 * PEOPLE) as advance:
        cases = list(bench.store.cases(FreeMotion(FRAMES, room=room), 2 * PEOPLE, advance, bench.seed * BATCHES_A_SEED))
    for first in range(0, len(cases), FRAMES):
        run = cases[first : first + FRAMES]
        own = [int((c.part < 255).sum()) for c in run if c.part is not None]
        if found < PEOPLE and TIMED_PX[0] <= np.median(own) <= TIMED_PX[1]:
            found += 1
            runs.append([replace(c.frame, color_rgb=None) for c in run])
    return runs * REPEATS


def speed_section(bench: Bench) -> list[Section]:
    """Tracking people who move, warmed up; wall time, which includes whatever else the machine does."""
    rows: list[list[str]] = []
    figures: dict[str, float] = {}
    stages_text = ""
    for room in (True, False):
        runs = timed_runs(bench, room=room)
        if not runs:
            continue
        bench.smooth.warm_up(runs[0][0].camera)
        step_seconds(bench.smooth, runs[:1])
        seconds, area = step_seconds(bench.smooth, runs)
        name = "in a room" if room else "cut out"
        p50, p95, p99 = 1e3 * np.quantile(seconds, (0.5, 0.95, 0.99))
        best = 1e3 * np.quantile(seconds, 0.05)
        rows.append([name, str(len(seconds)), f"{np.median(area):.0f}", *(f"{v:.2f}" for v in (p50, p95, p99, best))])
        key = "speed" if room else "speed_cut_out"
        figures |= {f"{key}.median_ms": float(p50), f"{key}.p99_ms": float(p99)}
        if room:
            stages = stage_seconds(bench.smooth, runs[: len(runs) // REPEATS])
            stages_text = table(
                ("stage (module of teleop.body)", "median ms", "p99 ms"),
                [[n, *(f"{1e3 * v:.2f}" for v in np.quantile(s, (0.5, 0.99)))] for n, s in stages.items()],
            )
    load = os.getloadavg()[0]
    head = ("640x480, depth frame to skeleton", "frames", "operator px", "median ms", "p95", "p99", "fastest 5 %")
    text = f"Filter on, one process, {os.cpu_count()} cores, load of the machine {load:.1f}.\n\n" + table(head, rows)
    return [Section("Speed", text + "\n\n" + stages_text, figures | {"speed.load": load})]
