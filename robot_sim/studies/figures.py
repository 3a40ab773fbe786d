"""The plotting library, loaded when a study first draws; drawing helpers that all studies share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.trajectories import Motion

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def new_figure(width_in: float, height_in: float) -> Figure:
    """An empty figure without a display. Raises RobotError when matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise RobotError(
            "studies draw with matplotlib; install it with: pip install 'greenhouse-teleop[train]'"
        ) from None
    return Figure(figsize=(width_in, height_in), layout="constrained")


def save(figure: Figure, path: Path) -> str:
    """Write a PNG; returns its file name for the report."""
    figure.savefig(path, dpi=110)
    return path.name


def axes_3d(figure: Figure, place: tuple[int, int, int] = (1, 1, 1)) -> Any:
    """A 3-D plot in metres with equal scales."""
    ax = figure.add_subplot(*place, projection="3d")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    ax.set_zlabel("z [m]")
    return ax


def equal_3d(ax: Any, points: FloatArray) -> None:
    """Same length for a metre on all three axes."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2, float((high - low).max()) / 2 or 0.1
    for setter, m in zip((ax.set_xlim, ax.set_ylim, ax.set_zlim), middle, strict=True):
        setter(m - half, m + half)
    ax.set_box_aspect((1, 1, 1))


def joint_curves(motion: Motion, names: tuple[str, ...], title: str) -> Figure:
    """Angle, speed and acceleration of every joint over time, in degrees."""
    figure = new_figure(11, 3.6)
    units = ("angle [deg]", "speed [deg/s]", "acceleration [deg/s²]")
    for k, (values, unit) in enumerate(zip((motion.q, motion.qd, motion.qdd), units, strict=True)):
        ax = figure.add_subplot(1, 3, k + 1)
        ax.plot(motion.t_s, np.degrees(values), label=names)
        ax.set_xlabel("time [s]")
        ax.set_ylabel(unit)
        ax.grid(alpha=0.3)
        if k == 0:
            ax.legend(fontsize=8)
    figure.suptitle(title)
    return figure
