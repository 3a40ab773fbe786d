"""The plantlet study's measurements as tables: end points, the line, compensation, what it depends on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robot_sim.kinematics import PitchArm
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.studies.calibration import calibrate, compensated
from robot_sim.studies.config import PlantletStudyConfig
from robot_sim.studies.plantlet_path import Cycle
from robot_sim.studies.report import Cell, Table, table
from robot_sim.studies.servo_model import ServoModel, draw_errors, fit_errors, share_within, tip_errors

MM = 1e3


@dataclass(frozen=True, slots=True, eq=False)
class Targets:
    """The end points of the source's test: names, commands and last directions (K, n), positions (K, 3) in m."""

    names: tuple[str, ...]
    commands: FloatArray
    directions: FloatArray
    positions: FloatArray


def carrying_targets(arm: PitchArm, cycle: Cycle) -> Targets:
    """P3, P4, P1 as reached by the source's three carrying moves."""
    names = ("P1-P3", "P3-P4", "P4-P1")
    legs = {leg.name: leg.motion for leg in cycle.legs}
    commands = np.array([legs[n].q[-1] for n in names])
    directions = np.array([legs[n].q[-1] - legs[n].q[0] for n in names])
    return Targets(names, commands, directions, arm.chain.forward(commands)[:, :3, 3])


def end_point_table(name: str, title: str, targets: Targets, errors: FloatArray, tolerance_m: float) -> Table:
    """Mean and largest deviation in x, y, z per move and over all; errors (K, R, 3) in m."""
    rows: list[tuple[Cell, ...]] = []
    for label, e in [*zip(targets.names, errors, strict=True), ("all", errors.reshape(-1, 3))]:
        a = np.abs(e) * MM
        rows.append(
            (label, len(a), *map(float, a.mean(axis=0)), *map(float, a.max(axis=0)), 100 * share_within(e, tolerance_m))
        )
    rows.append(("source, all", 60, "< 0.5", "< 0.5", "< 0.5", 0.86, 0.72, 0.74, 90.0))
    axes = ("x", "y", "z")
    header = (
        "move",
        "repeats",
        *(f"mean {a} [mm]" for a in axes),
        *(f"max {a} [mm]" for a in axes),
        "within ±0.5 mm [%]",
    )
    return table(name, title, header, rows)


def line_errors(
    model: ServoModel,
    cycle: Cycle,
    every_s: float,
    runs: int,
    rng: np.random.Generator,
    plan: ServoModel | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Times (K,) and deviations (K, runs, 3) in m from the planned line P1-P2; plan compensates when given."""
    m = next(leg.motion for leg in cycle.legs if leg.name == "P1-P2")
    at = [int(np.argmin(np.abs(m.t_s - t))) for t in np.arange(every_s, m.t_s[-1] + 1e-9, every_s)]
    q, d = m.q[at], m.qd[at]
    commands = q if plan is None else np.array([compensated(plan, a, b) for a, b in zip(q, d, strict=True)])
    ideal = model.arm.chain.forward(q)[:, :3, 3]
    return m.t_s[at], tip_errors(model, ideal, commands, d, rng.standard_normal((len(at), runs, q.shape[1])))


def line_table(name: str, title: str, t_s: FloatArray, errors: FloatArray) -> Table:
    """Mean and largest deviation in x, y, z at each time."""
    rows: list[tuple[Cell, ...]] = []
    for t, e in [*zip([f"{t:.0f}" for t in t_s], errors, strict=True), ("all", errors.reshape(-1, 3))]:
        a = np.abs(e) * MM
        rows.append((t, len(a), *map(float, a.mean(axis=0)), *map(float, a.max(axis=0))))
    rows.append(("source, all", 20, *("< 0.5",) * 3, *("< 1",) * 3))
    axes = ("x", "y", "z")
    return table(
        name, title, ("t [s]", "runs", *(f"mean {a} [mm]" for a in axes), *(f"max {a} [mm]" for a in axes)), rows
    )


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Plain and compensated end-point errors (K, R, 3) in m of one arm, with its models."""

    truth: ServoModel
    fitted: ServoModel
    plain: FloatArray
    compensated: FloatArray
    rms_before_m: float
    rms_after_m: float


def compare(
    arm: PitchArm, study: PlantletStudyConfig, targets: Targets, repeats: int, rng: np.random.Generator
) -> Comparison:
    """Draw one arm, fit its errors to the source's share, calibrate it, and test both ways of control."""
    truth = fit_errors(
        draw_errors(arm, study, rng), study, targets.positions, targets.commands, targets.directions, rng
    )
    noise = rng.standard_normal((2, len(targets.names), repeats, arm.chain.n))
    plain = tip_errors(truth, targets.positions, targets.commands, targets.directions, noise[0])
    calibration = calibrate(truth, study, rng)
    commands = np.array(
        [compensated(calibration.model, q, d) for q, d in zip(targets.commands, targets.directions, strict=True)]
    )
    better = tip_errors(truth, targets.positions, commands, targets.directions, noise[1])
    return Comparison(truth, calibration.model, plain, better, calibration.rms_before_m, calibration.rms_after_m)


def sensitivity_table(
    arm: PitchArm, study: PlantletStudyConfig, targets: Targets, arms: int, repeats: int, rng: np.random.Generator
) -> Table:
    """Compensated share against the part of the error that is random, which the source does not tell."""
    rows: list[tuple[Cell, ...]] = []
    for ratio in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7):
        here = study.model_copy(update={"random_ratio": ratio})
        results = [compare(arm, here, targets, repeats, rng) for _ in range(arms)]
        shares = [[100 * share_within(e, study.tolerance_m) for e in (c.plain, c.compensated)] for c in results]
        plain, better = np.array(shares).T
        rows.append((ratio, arms, float(plain.mean()), float(better.mean()), float(better.min())))
    header = (
        "random part of the variance",
        "arms drawn",
        "plain [%]",
        "compensated, mean [%]",
        "compensated, worst arm [%]",
    )
    return table("sensitivity", "What compensation can do depends on how much of the error repeats", header, rows)


def ablation_table(
    comparison: Comparison, study: PlantletStudyConfig, targets: Targets, repeats: int, rng: np.random.Generator
) -> Table:
    """Which part of the compensation brings what."""
    fitted, truth = comparison.fitted, comparison.truth
    zero = np.zeros_like(fitted.offset_rad)
    variants: list[tuple[str, ServoModel | None, bool]] = [
        ("plain", None, False),
        ("backlash only", replace(fitted, offset_rad=zero, length_m=np.zeros(6)), False),
        ("zeros and lengths only", replace(fitted, backlash_rad=zero), False),
        ("all, rounded to encoder steps", fitted, False),
        ("all, best encoder steps", fitted, True),
    ]
    rows: list[tuple[Cell, ...]] = []
    noise = rng.standard_normal((len(targets.names), repeats, len(zero)))
    for name, model, search in variants:
        commands = targets.commands
        if model is not None:
            pairs = zip(targets.commands, targets.directions, strict=True)
            commands = np.array([compensated(model, q, d, search) for q, d in pairs])
        e = tip_errors(truth, targets.positions, commands, targets.directions, noise)
        a = np.abs(e) * MM
        rows.append(
            (
                name,
                float(np.linalg.norm(e, axis=-1).mean() * MM),
                float(a.max()),
                100 * share_within(e, study.tolerance_m),
            )
        )
    header = ("control", "mean distance [mm]", "largest on an axis [mm]", "within ±0.5 mm [%]")
    return table("compensation", f"Parts of the compensation, {repeats} repeats of each move", header, rows)
