"""The two mappings beside each other: how far the robot's upper arm points from where the operator's does."""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, cos, degrees, radians, sin
from pathlib import Path
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from robot_sim.arm_angles import upper_arm_direction
from robot_sim.studies.figures import new_figure, save
from robot_sim.studies.report import Report, table
from teleop.config.intent import AngleConfig, MappingConfig
from teleop.joints import JOINT_INDEX, N_JOINTS
from teleop.mapping import measure, nearest_step
from teleop.skeleton import Skeleton

F64 = npt.NDArray[np.float64]
Name = Literal["paper", "direction"]
STEP_DEG: Final = 2.5
UPPER_ARM_M: Final = 0.3


def raised_arm(raised_deg: float, turned_deg: float) -> tuple[Skeleton, tuple[float, float, float]]:
    """A right arm raised from hanging by an angle, turned from outwards (0) to forwards (90); its (f, o, u)."""
    e, a = radians(raised_deg), radians(turned_deg)
    forward, outward, up = sin(e) * sin(a), sin(e) * cos(a), -cos(e)
    joints = np.full((N_JOINTS, 3), np.nan)
    bone = UPPER_ARM_M * np.array([outward, up, -forward])
    for i, name in enumerate(("shoulder_right", "elbow_right", "wrist_right")):
        joints[JOINT_INDEX[name]] = i * bone
    return Skeleton(0, joints, np.ones(N_JOINTS)), (forward, outward, up)


def pointing_error_deg(raised_deg: float, turned_deg: float, name: Name, steps: bool) -> float:
    """Angle between the operator's and the robot's upper arm [deg]; NaN where the mapping holds (no answer).

    steps: shoulder angles in steps of 15 degrees, as the source sends them.
    """
    body, wanted = raised_arm(raised_deg, turned_deg)
    config = MappingConfig(mapping=name)
    m = measure(body, "right", config, AngleConfig())
    if m.c1_deg is None or m.c2_deg is None:
        return float("nan")
    c1, c2 = (min(90.0, max(0.0, angle)) for angle in (m.c1_deg, m.c2_deg))
    if steps:
        c1, c2 = nearest_step(c1, config), nearest_step(c2, config)
    got = upper_arm_direction(c1, c2)
    return degrees(acos(min(1.0, max(-1.0, sum(a * b for a, b in zip(wanted, got, strict=True))))))


@dataclass(frozen=True, slots=True, eq=False)
class Difference:
    """Errors [deg] over raised (rows) and turned (columns), NaN = held. page: the report."""

    errors_deg: dict[str, F64]
    page: Path


def run_mapping_study(folder: Path) -> Difference:
    """Sweep the quarter sphere that the source's 0..90 degrees span; write table, plot and report."""
    raised, turned = np.arange(0.0, 90.1, STEP_DEG), np.arange(0.0, 90.1, STEP_DEG)
    kinds: tuple[tuple[str, Name, bool], ...] = (
        ("paper, continuous", "paper", False),
        ("paper, 15-degree steps", "paper", True),
        ("direction", "direction", False),
    )
    errors = {
        label: np.array([[pointing_error_deg(r, t, name, steps) for t in turned] for r in raised])
        for label, name, steps in kinds
    }
    report = Report("Mapping: paper and direction", folder)
    report.text(
        "The operator raises the right upper arm by an angle, turned from outwards (0 deg) to forwards (90 deg). "
        "Error: angle between the operator's upper arm and the robot's. `paper` sends the two projected angles of "
        "eq. (17), (18) to C2 and C1; they are the joint angles only while the arm stays in one of the two planes. "
        "`direction` solves C1, C2 for the arm's direction. Both measure with a signed atan2 instead of the source's "
        "arc cosine: equal on 0..90 deg, but an arm swung back or across the body gives a negative angle, which is "
        "clamped to 0 and told as limit.shoulder_range, where the arc cosine would send the arm to the wrong side."
    )
    rows = [
        (label, float(np.nanmean(e)), float(np.nanmax(e)), float(100 * np.isnan(e).mean()))
        for label, e in errors.items()
    ]
    header = ("mapping", "mean error [deg]", "largest [deg]", "held: projection too short [%]")
    report.table(table("errors", "Pointing error", header, rows))
    figure = new_figure(11.5, 3.8)
    for k, (label, e) in enumerate(errors.items()):
        ax = figure.add_subplot(1, 3, k + 1)
        image = ax.pcolormesh(turned, raised, e, vmin=0, vmax=45, cmap="viridis", shading="nearest")
        ax.set_facecolor("lightgrey")
        ax.set_title(label)
        ax.set_xlabel("turned from outwards to forwards [deg]")
        if k == 0:
            ax.set_ylabel("raised from hanging [deg]")
    figure.colorbar(image, ax=figure.axes, label="pointing error [deg]; grey: held")
    folder.mkdir(parents=True, exist_ok=True)
    report.picture(save(figure, folder / "mapping.png"), "Pointing error of the two mappings")
    return Difference(errors, report.write())
