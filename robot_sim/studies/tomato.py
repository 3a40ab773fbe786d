"""The cherry-tomato study: workspace and its voids, the point-to-point motion, redundancy and misprints."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robot_sim.arms.config import TomatoArmConfig
from robot_sim.arms.tomato import tomato_arm, tomato_model
from robot_sim.arms.urdf_writer import write_urdf
from robot_sim.kinematics import TwinBaseArm
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.studies.config import TomatoStudyConfig
from robot_sim.studies.figures import joint_curves, save
from robot_sim.studies.motion_file import write_motion
from robot_sim.studies.report import Progress, Report, Table, new_folder, silent, table
from robot_sim.studies.tomato_figures import draw_tool_path, draw_workspace
from robot_sim.studies.workspace import (
    Voids,
    all_combinations,
    count_voids,
    fine_occupancy,
    joint_grid,
    occupancy,
)
from robot_sim.trajectories import find_breaches, quintic


@dataclass(frozen=True, slots=True)
class TomatoOutcome:
    """What tests and the command line read off: voids of the coarse and the fine grid, breaches, report path."""

    coarse: tuple[Voids, ...]
    fine: Voids
    breaches: tuple[str, ...]
    page: Path


def source_combinations(arm: TomatoArmConfig, study: TomatoStudyConfig) -> FloatArray:
    """All joint combinations of the source's sampling (N, 5), rad."""
    steps = (study.step1_deg, *(study.step_deg,) * 4)
    return all_combinations([joint_grid(-lim, lim, s) for lim, s in zip(arm.limit_deg, steps, strict=True)])


def _misprints(arm: TwinBaseArm, rng: np.random.Generator) -> Table:
    """Largest error of the printed and the repaired formulas against the product of the link transforms."""
    d2, a3, a4, d5, a6 = arm.lengths_m
    q = rng.uniform(arm.chain.lower, arm.chain.upper, (2000, 5))
    T = arm.chain.forward(q)
    t12, t34 = q[:, 0] + q[:, 1], q[:, 2] + q[:, 3]
    c12, s12, c34, s34 = np.cos(t12), np.sin(t12), np.cos(t34), np.sin(t34)
    c5, s5 = np.cos(q[:, 4]), np.sin(q[:, 4])
    along = a3 * np.cos(q[:, 2]) + a4 * c34 + d5 * s34
    px = c12 * along + a6 * (c12 * c34 * c5 + s12 * s5)
    py = s12 * along + a6 * (s12 * c34 * c5 - c12 * s5)
    py_printed = c12 * along + a6 * (s12 * c34 * c5 - c12 * s5)
    pz = d2 - d5 * c34 + a3 * np.sin(q[:, 2]) + a4 * s34 + a6 * s34 * c5
    folded = np.abs((t34 + np.pi) % (2 * np.pi) - np.pi)
    oz = np.clip(T[:, 2, 1], -1, 1)
    rows: list[tuple[str, float, float]] = [
        ("px [m]", float(np.abs(px - T[:, 0, 3]).max()), float(np.abs(px - T[:, 0, 3]).max())),
        ("py [m]", float(np.abs(py_printed - T[:, 1, 3]).max()), float(np.abs(py - T[:, 1, 3]).max())),
        ("pz [m]", float(np.abs(pz - T[:, 2, 3]).max()), float(np.abs(pz - T[:, 2, 3]).max())),
        (
            "|theta34| [rad]",
            float(np.abs(np.arccos(oz) - folded).max()),
            float(np.abs(np.arccos(-oz) - folded).max()),
        ),
    ]
    title = "Largest error against the product of the link transforms, 2,000 random poses"
    return table("formulas", title, ("formula (2)", "as printed", "repaired"), rows)


def _motion_table(arm: TwinBaseArm, study: TomatoStudyConfig) -> tuple[Table, tuple[str, ...], FloatArray]:
    q2 = np.radians(study.end_deg)
    trajectory = quintic(np.radians(study.start_deg), q2, study.duration_s)
    m = trajectory.sample(study.sample_s)
    breaches = tuple(
        f"{b.joint} breaks its {b.what}: {np.degrees(b.value):.1f} against {np.degrees(b.limit):.1f} deg"
        + ("/s" if b.what == "speed" else "")
        for b in find_breaches(trajectory, arm.chain, study.sample_s)
    )
    least = arm.inverse(arm.chain.forward(q2), q_ref=np.radians(study.start_deg)).q[0]
    rows = [
        (
            j.name,
            study.end_deg[i] - study.start_deg[i],
            float(np.degrees(np.abs(m.qd[:, i]).max())),
            float(np.degrees(np.abs(m.qdd[:, i]).max())),
            float(np.degrees(least[i])),
            bool(abs(study.end_deg[i]) <= np.degrees(j.upper) + 1e-9),
        )
        for i, j in enumerate(arm.chain.joints)
    ]
    header = (
        "joint",
        "change [deg]",
        "top speed [deg/s]",
        "top acc. [deg/s²]",
        "same tool pose, least motion [deg]",
        "in range",
    )
    return table("motion", "The motion q1 to q2, joint by joint", header, rows), breaches, least


def run_tomato_study(
    output: Path,
    *,
    arm_config: TomatoArmConfig | None = None,
    study: TomatoStudyConfig | None = None,
    seed: int = 0,
    quick: bool = False,
    progress: Progress = silent,
) -> TomatoOutcome:
    """Run the study and write report, CSV, plots and ``motion.mcap`` into output."""
    ac, sc = arm_config or TomatoArmConfig(), study or TomatoStudyConfig()
    folder = new_folder(output)
    arm = tomato_arm(ac)
    report = Report("Five-joint cherry-tomato arm", folder)
    progress("coarse workspace", 0, 4)
    q = source_combinations(ac, sc)
    points = arm.chain.forward(q)[:, :3, 3]
    coarse = tuple(count_voids(occupancy(points, v), v, len(points)) for v in (0.4, 0.3, 0.2, 0.15, 0.1, 0.05))
    progress("fine workspace", 1, 4)
    step, voxel = (sc.fine_step_deg * 2, sc.voxel_m * 2) if quick else (sc.fine_step_deg, sc.voxel_m)
    hit, origin, samples = fine_occupancy(arm.chain, ac.limit_deg, step, voxel)
    fine = count_voids(hit, voxel, samples)
    progress("plots", 2, 4)
    report.heading("Workspace")
    low, high = points.min(axis=0), points.max(axis=0)
    report.text(
        f"Every combination of the source's joint steps ({sc.step1_deg:.0f} deg for joint 1, {sc.step_deg:.0f} deg for "
        f"the others) gives {len(points):,} points. They span x {low[0]:.2f} to {high[0]:.2f} m, "
        f"y {low[1]:.2f} to {high[1]:.2f} m, z {low[2]:.2f} to {high[2]:.2f} m."
    )
    report.picture(save(draw_workspace(points, hit, origin, voxel), folder / "workspace.png"), "workspace")
    rows = [
        (name, v.voxel_m * 1e3, v.samples, v.occupied, v.enclosed, v.pockets, v.enclosed_m3 * 1e3)
        for name, v in [*(("source's steps", c) for c in coarse), (f"{step:g} deg steps", fine)]
    ]
    header = ("grid", "voxel [mm]", "samples", "occupied voxels", "enclosed empty voxels", "pockets", "void [litres]")
    report.table(
        table("voids", "Does the workspace have voids? Empty voxels that the outside cannot reach", header, rows)
    )
    verdict = (
        "has no void" if fine.enclosed == 0 else f"has {fine.pockets} voids of {fine.enclosed_m3 * 1e3:.2f} litres"
    )
    report.text(
        f"The source answers from its pictures: continuous, no cavity, no hole. On a grid fine enough to decide "
        f"({samples:,} samples, {voxel * 1e3:.0f} mm voxels) the workspace {verdict}. The source's own samples are too "
        f"sparse to show it: at 100 mm voxels they leave gaps of their own, as the table's rows tell."
    )
    report.heading("Formulas")
    report.table(_misprints(arm, np.random.default_rng(seed)))
    report.heading("Motion")
    motion_table, breaches, least = _motion_table(arm, sc)
    trajectory = quintic(np.radians(sc.start_deg), np.radians(sc.end_deg), sc.duration_s)
    m = trajectory.sample(sc.sample_s)
    names = tuple(j.name for j in arm.chain.joints)
    report.picture(save(joint_curves(m, names, "q1 to q2, quintic (jtraj)"), folder / "curves.png"), "joint curves")
    tool = arm.chain.forward(m.q)[:, :3, 3]
    report.picture(save(draw_tool_path(tool, arm.chain.frames(m.q[-1])[:, :3, 3]), folder / "path.png"), "tool path")
    report.table(motion_table)
    report.csv_only(
        table(
            "curves",
            "Samples of the motion",
            (
                "t [s]",
                *(f"{n} {u}" for u in ("[deg]", "[deg/s]", "[deg/s²]") for n in names),
                "x [m]",
                "y [m]",
                "z [m]",
            ),
            [
                (float(t), *(float(v) for v in np.degrees(np.concatenate([a, b, c]))), *(float(v) for v in p))
                for t, a, b, c, p in zip(m.t_s, m.q, m.qd, m.qdd, tool, strict=True)
            ],
        )
    )
    report.text(
        "As in the source, joint 2 turns most, joint 1 least, and all curves are continuous. "
        + (f"Reported, not hidden: {'; '.join(breaches)}. " if breaches else "")
        + "theta1 and theta2 turn about one axis and count only by their sum: the arm has four independent joints. The "
        f"same tool pose is reached inside all limits with theta1 = {np.degrees(least[0]):.1f} deg and "
        f"theta2 = {np.degrees(least[1]):.1f} deg; for theta1 + theta2 = {np.degrees(least[0] + least[1]):.0f} deg "
        f"theta1 may lie anywhere in {_range_deg(arm, float(least[0] + least[1]))} deg."
    )
    progress("motion", 3, 4)
    urdf = write_urdf(tomato_model(arm))
    (folder / "arm.urdf").write_text(urdf, encoding="utf-8")
    write_motion(folder / "motion.mcap", urdf, arm.chain, m.t_s, m.q, about={"study": "tomato"})
    progress("done", 4, 4)
    return TomatoOutcome(coarse, fine, breaches, report.write())


def _range_deg(arm: TwinBaseArm, t12_rad: float) -> str:
    low, high = np.degrees(arm.theta1_range(t12_rad))
    return f"{low:.0f}..{high:.0f}"
