"""Free arm motion at 30 frames/s: the elbow's inner angle through the filter and from single frames."""

from __future__ import annotations

from teleop.evaluation.angle_figures import angle_figure, angle_pairs
from teleop.evaluation.metrics import figures_of, near_share
from teleop.evaluation.motions import FreeMotion
from teleop.evaluation.section import Bench, Section, percent, table

FRAMES = 60


def motion_section(bench: Bench) -> list[Section]:
    """As many people as make about three times the frames of one setting, two seconds each; also at 10 frames/s."""
    people = max(2, round(3 * bench.frames / FRAMES))
    runs = (
        ("filtered, 30 frames/s", FreeMotion(FRAMES), False, "motion"),
        ("single frames", FreeMotion(FRAMES), True, "motion_single"),
        ("filtered, 10 frames/s", FreeMotion(FRAMES // 3, fps=10.0), False, "motion_10fps"),
    )
    rows: list[list[str]] = []
    figures: dict[str, float] = {}
    for words, frames, single, key in runs:
        answers = bench.run(f"free arm motion, {words}", frames, people, single=single)
        pairs = angle_pairs(answers, bench.config.intent.angles)
        elbow, near = angle_figure(*pairs.of("theta3")), near_share(figures_of(answers))
        upper = [angle_figure(*pairs.of(name)) for name in ("theta1", "theta2")]
        rows.append(
            [words, str(elbow.n), percent(elbow.answered), *(f"{v:.2f}" for v in (elbow.mean, elbow.median, elbow.p95)),
             *(f"{u.mean:.2f} / {u.p95:.2f}" for u in upper), percent(near)]
        )  # fmt: skip
        figures |= {f"{key}.elbow_mean_deg": elbow.mean, f"{key}.elbow_p95_deg": elbow.p95, f"{key}.within_10cm": near}
    head = (
        "",
        "elbows",
        "answered %",
        "elbow mean deg",
        "median",
        "p95",
        "theta1 mean / p95",
        "theta2",
        "joints within 10 cm %",
    )
    text = (
        f"{people} unseen people in rooms, both arms moving all the time from reach to reach ({FRAMES / 30:g} s each); "
        "elbow: inner angle theta3 where shoulder, elbow and wrist are seen.\n\n" + table(head, rows)
    )
    return [Section("Free arm motion", text, figures)]
