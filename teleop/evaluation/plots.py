"""Drawings of the evaluation's figures (matplotlib, extra ``train``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from teleop.body.parts import PART_NAMES
from teleop.evaluation.metrics import JointFigures
from teleop.joints import JOINT_NAMES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Curve = list[tuple[float, float, float, int]]


def new_figure(width: float, height: float) -> Figure:
    """A figure without a window."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def joint_plot(f: JointFigures, title: str) -> Figure:
    """Median, mean and 95th percentile of each joint's error; share within 10 cm."""
    figure = new_figure(10, 6)
    above, below = figure.subplots(2, 1, sharex=True)
    x = np.arange(len(JOINT_NAMES))
    for k, (name, values) in enumerate((("median", f.median_m), ("mean", f.mean_m), ("95 %", f.p95_m))):
        above.bar(x + 0.27 * (k - 1), 1000 * np.nan_to_num(values), 0.25, label=name)
    above.set_ylabel("error [mm]")
    above.legend()
    above.set_title(title)
    below.bar(x, 100 * np.nan_to_num(f.near), 0.7)
    below.axhline(95, color="0.4", linestyle="--", linewidth=1)
    below.set_ylabel("within 10 cm [%]")
    below.set_ylim(min(80.0, 100 * float(np.nanmin(f.near, initial=1.0)) - 2), 100)
    below.set_xticks(x, [n.replace("_", " ") for n in JOINT_NAMES], rotation=60, ha="right")
    return figure


def confusion_plot(confusion: npt.NDArray[np.int64], title: str) -> Figure:
    """Share of the true part's pixels given each part."""
    figure = new_figure(9, 8)
    axes = figure.subplots()
    share = confusion / np.maximum(confusion.sum(axis=1, keepdims=True), 1)
    image = axes.imshow(share, vmin=0, vmax=1, cmap="viridis")
    names = [n.replace("_", " ") for n in PART_NAMES]
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize=7)
    axes.set_yticks(range(len(names)), names, fontsize=7)
    axes.set_xlabel("answered")
    axes.set_ylabel("true")
    axes.set_title(title)
    figure.colorbar(image, ax=axes, shrink=0.8)
    return figure


def angle_plot(curves: dict[str, Curve], title: str) -> Figure:
    """Mean error and mean absolute error against the true angle, a panel an angle."""
    figure = new_figure(11, 6)
    panels = figure.subplots(2, 3).ravel()
    for axes, (name, curve) in zip(panels, curves.items(), strict=False):
        if curve:
            x, bias, size, _ = zip(*curve, strict=True)
            axes.plot(x, size, "o-", label="mean absolute")
            axes.plot(x, bias, "s--", label="mean")
        axes.axhline(0, color="0.6", linewidth=0.8)
        axes.set_title(name)
        axes.set_xlabel("true angle [deg]")
        axes.set_ylabel("error [deg]")
    panels[0].legend()
    for axes in panels[len(curves) :]:
        axes.set_visible(False)
    figure.suptitle(title)
    return figure


def testers_plot(panels: dict[str, tuple[list[float], list[float], list[float], float]]) -> Figure:
    """The source's figure 12: level [deg] against the mean error over testers and its spread, a panel a movement.

    panels: name to (levels, mean errors, standard deviations over testers, the source's largest error).
    """
    figure = new_figure(11, 7)
    for axes, (name, (levels, mean, spread, source)) in zip(figure.subplots(2, 2).ravel(), panels.items(), strict=True):
        axes.errorbar(levels, mean, yerr=spread, fmt="o-", capsize=3, label="ours: mean, s.d. over testers")
        for sign in (-1, 1):
            axes.axhline(
                sign * source, color="C3", linestyle="--", linewidth=1, label="source's largest" if sign > 0 else None
            )
        axes.axhline(0, color="0.6", linewidth=0.8)
        axes.set_title(name)
        axes.set_xlabel("angle asked for [deg]")
        axes.set_ylabel("captured - true [deg]")
    axes.legend()
    return figure


def bars(names: list[str], values: list[float], label: str, line: float | None = None) -> Figure:
    """Horizontal bars, one a setting, with their values."""
    figure = new_figure(9, 0.35 * len(names) + 1.2)
    axes = figure.subplots()
    axes.bar_label(axes.barh(range(len(names)), values), fmt="%.1f", label_type="center", color="white")
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel(label)
    if line is not None:
        axes.axvline(line, color="C3", linestyle="--", linewidth=1)
    return figure
