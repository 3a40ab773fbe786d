"""Pictures of the plantlet study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robot_sim.kinematics import PitchArm
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.studies.figures import axes_3d, equal_3d, new_figure
from robot_sim.studies.plantlet_path import Cycle
from robot_sim.studies.plantlet_tables import MM, Targets

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_cycle(arm: PitchArm, cycle: Cycle) -> Figure:
    """Left: the gripping point's way in space with both bottles; right: the entry into the first bottle in section."""
    figure = new_figure(12, 5.6)
    ax = axes_3d(figure, (1, 2, 1))
    everything = []
    for leg in cycle.legs:
        tool = arm.chain.forward(leg.motion.q)[:, :3, 3]
        everything.append(tool)
        ax.plot(*tool.T, color="tab:red" if leg.kind == "line" else "tab:blue", lw=1.6)
    for name, q in cycle.points.items():
        ax.text(*arm.chain.forward(q)[:3, 3], name, fontsize=9)
    turn = np.linspace(0, 2 * np.pi, 40)
    for b in cycle.bottles:
        for r, depth in b.profile:
            ring = np.stack([r * np.cos(turn), r * np.sin(turn), np.full_like(turn, -depth)], axis=1) + b.mouth_m
            ax.plot(*ring.T, color="0.6", lw=0.8)
    frames = np.concatenate([np.zeros((1, 3)), arm.chain.frames(cycle.points["P1"])[:, :3, 3]])
    ax.plot(*frames.T, "o-", color="0.3", lw=3)
    everything.append(frames)
    equal_3d(ax, np.concatenate(everything))
    ax.set_title("carrying (blue) and straight lines (red)")
    section = figure.add_subplot(1, 2, 2)
    b = cycle.bottles[0]
    profile = b.profile
    for side in (-1, 1):
        section.plot(side * profile[:, 0] * MM, -profile[:, 1] * MM, color="0.4", lw=3)
    q_in = [leg.motion.q for leg in cycle.legs if leg.name in ("P1-P2", "P2-A")]
    tool = arm.chain.forward(np.concatenate(q_in))[:, :3, 3] - b.mouth_m
    away = tool[-1, :2] / max(1e-9, float(np.linalg.norm(tool[-1, :2])))
    section.plot(tool[:, :2] @ away * MM, tool[:, 2] * MM, color="tab:red", lw=2, label="gripping point P1-P2-A")
    section.set_aspect("equal")
    section.set_xlabel("towards the plantlet [mm]")
    section.set_ylabel("above the mouth [mm]")
    section.legend(fontsize=8)
    section.set_title("taking a plantlet, in section")
    return figure


def draw_errors_map(targets: Targets, plain: FloatArray, better: FloatArray, tolerance_m: float) -> Figure:
    """End-point errors in x-y and x-z, plain and compensated; the square is the tolerance."""
    figure = new_figure(12, 5.8)
    for row, (words, errors) in enumerate((("plain", plain), ("compensated", better))):
        for column, (a, b) in enumerate(((0, 1), (0, 2), (1, 2))):
            ax = figure.add_subplot(2, 3, 3 * row + column + 1)
            for name, e in zip(targets.names, errors, strict=True):
                ax.plot(e[:, a] * MM, e[:, b] * MM, ".", ms=2, alpha=0.5, label=name)
            t = tolerance_m * MM
            ax.plot([-t, t, t, -t, -t], [-t, -t, t, t, -t], "k", lw=1)
            ax.set_xlim(-1.2, 1.2)
            ax.set_ylim(-1.2, 1.2)
            ax.set_aspect("equal")
            ax.set_xlabel(f"{'xyz'[a]} [mm]")
            ax.set_ylabel(f"{'xyz'[b]} [mm]")
            ax.set_title(words, fontsize=10)
            if row == 0 and column == 0:
                ax.legend(fontsize=7, markerscale=4)
    return figure


def draw_line(t_s: FloatArray, plain: FloatArray, better: FloatArray) -> Figure:
    """Deviation from the line over time, x, y, z; bands are the largest and smallest of all runs."""
    figure = new_figure(11, 3.2)
    for k, word in enumerate("xyz"):
        ax = figure.add_subplot(1, 3, k + 1)
        for e, name, color in ((plain, "plain", "tab:orange"), (better, "compensated", "tab:green")):
            v = e[:, :, k] * MM
            ax.fill_between(t_s, v.min(axis=1), v.max(axis=1), color=color, alpha=0.3)
            ax.plot(t_s, v.mean(axis=1), color=color, label=name)
        ax.axhline(0.5, color="k", lw=0.8, ls="--")
        ax.axhline(-0.5, color="k", lw=0.8, ls="--")
        ax.set_xlabel("time [s]")
        ax.set_ylabel(f"{word} off the line [mm]")
        if k == 0:
            ax.legend(fontsize=8)
    return figure
