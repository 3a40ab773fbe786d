"""What the robot is told: the 15-degree step of a shoulder angle, and the task from the legs; single frames."""

from __future__ import annotations

from teleop.evaluation.angle_figures import angle_figure, angle_pairs, right_bins, right_task
from teleop.evaluation.section import Bench, Section, percent, table
from teleop.evaluation.stills import BATCH, Stills

CLEAR_DEG = 2.0
"""Angles nearer to an edge between two steps are not judged."""
TASK_LEVELS = (3.0, 22.0)


def steps_section(bench: Bench) -> list[Section]:
    """Arms raised 0-93 degrees in either plane, forearms anywhere; legs 0-35 degrees apart and at the two levels."""
    intent, batches = bench.config.intent, -(-2 * bench.frames // BATCH)
    pairs = angle_pairs(bench.run("15-degree steps", Stills("bins"), batches), intent.angles)
    shares = {
        least: right_bins(pairs, intent.mapping, CLEAR_DEG, least) for least in (0.7, intent.angles.min_projection)
    }
    rows = [[f"{least:g}", str(n), percent(share)] for least, (share, n) in shares.items()]
    bins = Section(
        "Shoulder angles in 15-degree steps",
        f"Single frames in rooms, arms raised by any angle in either plane, angles at least {CLEAR_DEG:g} degrees off "
        "an edge between two steps; no answer counts as wrong. An angle is judged when the upper arm's projection on "
        "its plane is at least this part of its length:\n\n" + table(("projection", "n", "right step %"), rows),
        {"bins.right": shares[0.7][0], "bins.right_any_projection": shares[intent.angles.min_projection][0]},
    )
    half = max(1, batches // 2)
    spread = angle_pairs(
        bench.run("legs, any angle", Stills("legs", levels=tuple(range(0, 36, 5))), half), intent.angles
    )
    two = angle_pairs(bench.run("legs, 3 and 22 degrees", Stills("legs", levels=TASK_LEVELS), half), intent.angles)
    f = angle_figure(*spread.of("T1"))
    task, n = right_task(two, intent.task)
    legs = Section(
        "Legs: T1 and the task",
        table(
            ("figure", "n", "measured"),
            [
                ["T1 error, 0-35 deg, mean / p95 deg", str(f.n), f"{f.mean:.2f} / {f.p95:.2f}"],
                ["T1 error, bias deg", str(f.n), f"{f.bias:+.2f}"],
                ["right task at 3 and 22 deg, single frames, %", str(n), percent(task)],
            ],
        ),
        {"legs.T1_mean_deg": f.mean, "legs.T1_p95_deg": f.p95, "legs.right_task": task},
    )
    return [bins, legs]
