"""Pictures of the cherry-tomato study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from robot_sim.kinematics.transforms import FloatArray
from robot_sim.studies.figures import axes_3d, equal_3d, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_workspace(points: FloatArray, hit: npt.NDArray[np.bool_], origin: FloatArray, voxel_m: float) -> Figure:
    """Top row: the source's samples in three projections and 3-D; bottom row: the fine grid's central slices."""
    figure = new_figure(15, 7.6)
    pairs = ((0, 1), (1, 2), (0, 2))
    words = "xyz"
    for k, (a, b) in enumerate(pairs):
        ax = figure.add_subplot(2, 4, k + 1)
        ax.plot(points[:, a], points[:, b], ".", ms=1.2, alpha=0.5)
        ax.set_aspect("equal")
        ax.set_xlabel(f"{words[a]} [m]")
        ax.set_ylabel(f"{words[b]} [m]")
        ax.set_title(f"source's steps, {words[a]}-{words[b]}")
    ax3 = axes_3d(figure, (2, 4, 4))
    ax3.scatter(*points[::3].T, s=0.5, c=points[::3, 2], cmap="viridis")
    equal_3d(ax3, points)
    ax3.set_title("source's steps, 3-D")
    for k, (a, b) in enumerate(pairs):
        ax = figure.add_subplot(2, 4, k + 5)
        across = 3 - a - b
        middle = round(float(-origin[across]) / voxel_m) if across < 2 else hit.shape[2] // 2
        section = np.take(hit, middle, axis=across)
        extent = (
            origin[a],
            origin[a] + voxel_m * hit.shape[a],
            origin[b],
            origin[b] + voxel_m * hit.shape[b],
        )
        ax.imshow(section.T, origin="lower", extent=extent, cmap="Greens", vmin=0, vmax=1.4, interpolation="nearest")
        ax.set_xlabel(f"{words[a]} [m]")
        ax.set_ylabel(f"{words[b]} [m]")
        ax.set_title(f"fine grid, slice {words[a]}-{words[b]}")
    shell = hit & ~_eroded(hit)
    shell[:, : int((0.0 - origin[1]) / voxel_m), :] = False  # cut open at y = 0
    where = np.argwhere(shell) * voxel_m + origin
    ax3 = axes_3d(figure, (2, 4, 8))
    ax3.scatter(*where.T, s=1.0, c=where[:, 2], cmap="viridis")
    equal_3d(ax3, np.argwhere(hit) * voxel_m + origin)
    ax3.set_title("fine grid, boundary of the half y > 0")
    return figure


def _eroded(hit: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    from scipy import ndimage

    return np.asarray(ndimage.binary_erosion(hit))


def draw_tool_path(tool: FloatArray, skeleton: FloatArray) -> Figure:
    """The tool's way in space and the arm at its end."""
    figure = new_figure(6, 5.5)
    ax = axes_3d(figure)
    ax.plot(*tool.T, lw=2, label="tool path")
    arm = np.concatenate([np.zeros((1, 3)), skeleton])
    ax.plot(*arm.T, "o-", color="0.4", lw=3, label="arm at q2")
    ax.scatter(*tool[0], color="g", label="start")
    ax.scatter(*tool[-1], color="r", label="end")
    equal_3d(ax, np.concatenate([tool, arm]))
    ax.legend(fontsize=8)
    return figure
