"""Pictures of the grape study."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner.shapes import Box, Cylinder, Solid
from robot_sim.studies.figures import axes_3d, equal_3d, new_figure
from robot_sim.studies.grape_plan import PickPlan
from robot_sim.studies.grape_scene import GrapeScene
from robot_sim.studies.grape_trial import Outcome

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _wire(ax: Any, solid: Solid, color: str) -> None:
    turn = np.linspace(0, 2 * np.pi, 33)
    if isinstance(solid, Cylinder):
        for z in (-solid.height_m / 2, solid.height_m / 2):
            ring = np.stack(
                [solid.radius_m * np.cos(turn), solid.radius_m * np.sin(turn), np.full_like(turn, z)], axis=1
            )
            ax.plot(*(ring @ solid.T[:3, :3].T + solid.T[:3, 3]).T, color=color, lw=1)
        for a in turn[::8]:
            r = solid.radius_m * np.array([np.cos(a), np.sin(a)])
            line = np.array([[*r, -solid.height_m / 2], [*r, solid.height_m / 2]])
            ax.plot(*(line @ solid.T[:3, :3].T + solid.T[:3, 3]).T, color=color, lw=0.8)
    elif isinstance(solid, Box):
        half = np.array(solid.half_m)
        line = np.array([[-half[0], 0, 0], [half[0], 0, 0]])
        ax.plot(*(line @ solid.T[:3, :3].T + solid.T[:3, 3]).T, color=color, lw=3)


def draw_pick(scene: GrapeScene, seen: GrapeScene, plan: PickPlan, skeletons: Sequence[FloatArray]) -> Figure:
    """A pick in space: berries, seen volumes, key points, the arm at a few moments."""
    figure = new_figure(9, 7.5)
    ax = axes_3d(figure)
    for b, v in zip(scene.bunches, seen.bunches, strict=True):
        ax.scatter(*b.berries_m.T, s=60, color="purple", alpha=0.35)
        stem = np.stack([b.top_m, b.top_m + np.array([0, 0, b.peduncle_m])])
        ax.plot(*stem.T, color="olive", lw=2)
        _wire(ax, v.volume, "tab:orange")
    for o in scene.obstacles:
        _wire(ax, o, "saddlebrown")
    ax.plot(*plan.key_points_m.T, "o-", color="tab:blue", ms=3, lw=1, label=f"{len(plan.key_points_m)} key points")
    for frames, color in zip(skeletons, ("0.7", "0.2", "0.5"), strict=False):
        joints = np.concatenate([np.zeros((1, 3)), frames[:, :3, 3]])
        ax.plot(*joints.T, "o-", color=color, lw=3, ms=4)
    equal_3d(ax, np.concatenate([plan.key_points_m, *(b.berries_m for b in scene.bunches), np.zeros((1, 3))]))
    ax.legend(fontsize=8)
    ax.view_init(25, -60)
    return figure


def draw_summary(curve: Sequence[tuple[float, float, float]], trials: Sequence[Outcome], looks: int) -> Figure:
    """Success against margin; path lengths; deviation of the fingers' middle from the true peduncle."""
    figure = new_figure(13, 3.8)
    ax = figure.add_subplot(1, 3, 1)
    h, single, pair = np.array(curve).T
    ax.plot(h, single, "o-", label="single")
    ax.plot(h, pair, "s-", label="overlapping")
    ax.axhline(88.89, color="0.5", ls="--", lw=1, label="source, virtual")
    ax.axhline(86.05, color="0.5", ls=":", lw=1, label="source, physical")
    ax.set_xlabel("safety margin H1 [mm]")
    ax.set_ylabel("success [%]")
    ax.set_title(f"fixed margin, {'one look' if looks == 1 else f'{looks} looks'}", fontsize=10)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    ax = figure.add_subplot(1, 3, 2)
    lengths = [o.path_m * 100 for o in trials if o.key_points]
    ax.hist(lengths, bins=30, color="tab:blue", alpha=0.7, label="here")
    ax.axvspan(219.26, 282.46, color="tab:orange", alpha=0.25, label="source's range")
    ax.set_xlabel("path length [cm]")
    ax.set_ylabel("trials")
    ax.legend(fontsize=8)
    ax = figure.add_subplot(1, 3, 3)
    for pair_kind, color in ((False, "tab:blue"), (True, "tab:orange")):
        some = [o for o in trials if o.key_points and o.overlapping is pair_kind]
        for ok, marker in ((True, "."), (False, "x")):
            xz = np.array([(o.error_x_m, o.error_z_m) for o in some if o.success is ok]).reshape(-1, 2) * 1e3
            name = ("overlapping" if pair_kind else "single") + ("" if ok else ", failed")
            ax.plot(xz[:, 0], xz[:, 1], marker, color=color if ok else "red", ms=4 if ok else 7, alpha=0.6, label=name)
    turn = np.linspace(0, 2 * np.pi, 80)
    ax.plot(10 * np.cos(turn), 10 * np.sin(turn), "k--", lw=0.8)
    ax.set_xlabel("peduncle across the fingers [mm]")
    ax.set_ylabel("peduncle along the fingers [mm]")
    ax.set_aspect("equal")
    ax.legend(fontsize=7)
    return figure
