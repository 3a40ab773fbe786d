"""The body tracker against MediaPipe Pose on the same rendered frames in one run: time a frame, error of the elbow.

MediaPipe is given what it asks for: undisturbed colour images of 640x480 in good light, one whole person in view 2 to
2.6 m away, 30 frames/s, its tracking mode with smoothing and its full model (the default, the one its package has).
We are given the depth images of the same instants, with a Kinect's noise. Both run one after the other, with the
machine's defaults for threads. The elbow's inner angle lies between world landmarks, which are metric: shoulder, elbow
and wrist; turned or shifted as they may be, the angle does not care. Elbows that are seen count, the same for both.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from teleop.angles import angle_deg
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.errors import DataError
from teleop.evaluation.answers import run_tracker
from teleop.evaluation.cases import Case
from teleop.evaluation.motions import FreeMotion
from teleop.evaluation.section import table
from teleop.evaluation.speed import step_seconds
from teleop.evaluation.store import FrameStore
from teleop.joints import JOINT_INDEX

_KEPT = Path("build/evaluation")
_ENVIRONMENT = Path("build/mediapipe-env")
_PACKAGES = ("mediapipe==0.10.21", "numpy<2")
_FRAMES = 60
_LANDMARKS = {"right": (12, 14, 16), "left": (11, 13, 15)}
"""Shoulder, elbow, wrist of BlazePose's 33 landmarks."""

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """seconds (F,) a frame; elbow_deg (F, 2) right and left, NaN unanswered."""

    seconds: Floats
    elbow_deg: Floats


def environment() -> Path | None:
    """The Python of MediaPipe's own environment, made on first use; None, said why, when it cannot be had."""
    python = _ENVIRONMENT / "bin" / "python"
    ready = _ENVIRONMENT / ".installed"
    if ready.is_file():
        return python
    print("making an environment for MediaPipe (once)", flush=True)
    try:
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(_ENVIRONMENT)], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "-q", *_PACKAGES], check=True)
    except subprocess.CalledProcessError as error:
        print(f"MediaPipe cannot be installed here ({error}): ours alone")
        return None
    ready.touch()
    return python


def _elbow(shoulder: Floats, elbow: Floats, wrist: Floats) -> float:
    if np.isnan([shoulder, elbow, wrist]).any():
        return float("nan")
    angle = angle_deg(shoulder - elbow, wrist - elbow)
    return float("nan") if angle is None else angle


def _elbows(joints_m: Floats) -> Floats:
    names = [[JOINT_INDEX[f"{n}_{side}"] for n in ("shoulder", "elbow", "wrist")] for side in ("right", "left")]
    return np.array([[_elbow(*joints[three]) for three in names] for joints in joints_m])


def ours(cases: list[Case]) -> Outcome:
    """Our tracker as it is shipped, filter on."""
    tracker = BodyTracker(load_model(), TeleopConfig().body)
    answers = run_tracker(tracker, cases, single=False)
    runs = [[c.frame.without_color() for c in cases[k : k + _FRAMES]] for k in range(0, len(cases), _FRAMES)]
    seconds, _ = step_seconds(tracker, runs)
    return Outcome(seconds, _elbows(answers.joints_m))


def theirs(python: Path, images: Path) -> Outcome:
    """MediaPipe in a process of its own."""
    out = images.with_name("out.npz")
    script = Path(__file__).with_name("tracker_mediapipe.py")
    subprocess.run([str(python), str(script), str(images), str(out)], check=True, stderr=subprocess.DEVNULL)
    with np.load(out) as data:
        world = data["world_m"]
        elbows = [[_elbow(*marks[list(three)]) for three in _LANDMARKS.values()] for marks in world]
        return Outcome(data["seconds"], np.array(elbows))


def report(outcomes: dict[str, Outcome], true_deg: Floats) -> str:
    """One row a tracker; true_deg (F, 2), NaN where the elbow is not seen. Ratios are to the first row."""
    rows = []
    first: tuple[float, float] | None = None
    for name, o in outcomes.items():
        seen = ~np.isnan(true_deg)
        error = np.abs(o.elbow_deg - true_deg)[seen]
        known = error[~np.isnan(error)]
        p50, p99 = 1e3 * np.quantile(o.seconds, (0.5, 0.99))
        mean = float(known.mean()) if len(known) else float("nan")
        first = first or (p50, mean)
        rows.append(
            [name, f"{p50:.2f}", f"{p99:.2f}", f"{p50 / first[0]:.1f}", f"{100 * len(known) / len(error):.1f}",
             f"{mean:.2f}", f"{np.quantile(known, 0.95):.2f}", f"{mean / first[1]:.1f}"]
        )  # fmt: skip
    head = ("640x480", "median ms", "p99", "times ours", "answered %", "elbow mean deg", "p95", "times ours")
    return table(head, rows)


def main(people: float = 8) -> None:
    """Print the table. people: how many, each in a room of their own."""
    store = FrameStore(_KEPT, os.cpu_count() or 1)
    try:
        cases = list(store.cases(FreeMotion(_FRAMES, color=True), int(people)))
    except DataError as error:
        print(f"tracker: {error}")
        return
    outcomes = {"ours": ours(cases)}
    truth = np.stack([c.joints_m for c in cases])
    seen = np.stack([c.counted for c in cases])
    true_deg = _elbows(np.where(seen[..., None], truth, np.nan))
    if (python := environment()) is not None:
        with tempfile.TemporaryDirectory() as folder:
            images = Path(folder) / "images.npz"
            np.savez(images, color=np.stack([c.frame.color_rgb for c in cases]), run=[c.group for c in cases])
            outcomes["MediaPipe Pose 0.10.21"] = theirs(python, images)
    print(f"{people:.0f} unseen people in rooms, moving both arms freely, {_FRAMES} frames each at 30 frames/s")
    print(report(outcomes, true_deg))
    print(f"load of the machine {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
