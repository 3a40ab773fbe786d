"""The figures that must be shown, what is asked for and what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from teleop.evaluation.section import table


@dataclass(frozen=True, slots=True)
class Target:
    """One line: key of the figure, words, unit, least and aim; factor: from the figure to the unit shown."""

    key: str
    words: str
    unit: str
    least: float
    aim: float
    factor: float = 1.0
    higher_is_better: bool = False

    def verdict(self, value: float) -> str:
        """aim, least or missed."""
        sign = -1.0 if self.higher_is_better else 1.0
        if sign * value <= sign * self.aim:
            return "aim"
        return "least" if sign * value <= sign * self.least else "missed"


TARGETS: Final = (
    Target("speed.median_ms", "depth frame to skeleton, 640x480, in a room, median", "ms", 5.0, 2.5),
    Target("speed.p99_ms", "the same, p99", "ms", 10.0, 10.0),
    Target("free.within_10cm", "joints within 10 cm, all 20, visible: operators in rooms", "%", 95, 98, 100, True),
    Target("sampled_room.within_10cm", "the same: extreme poses in rooms", "%", 95, 98, 100, True),
    Target("sampled_cut_out.within_10cm", "the same: extreme poses, cut out", "%", 95, 98, 100, True),
    Target("free.median_mm", "median joint error: operators in rooms", "mm", 25, 15),
    Target("sampled_room.median_mm", "the same: extreme poses in rooms", "mm", 25, 15),
    Target("motion.elbow_mean_deg", "elbow, free arm motion, filtered, mean", "deg", 4.0, 2.5),
    Target("motion.elbow_p95_deg", "the same, p95", "deg", 10.0, 6.0),
    Target("testers.forward_largest_deg", "ten testers, shoulder forward, largest error of the mean", "deg", 5.8, 3.0),
    Target("testers.sideways_largest_deg", "ten testers, shoulder sideways", "deg", 5.8, 3.0),
    Target("testers.elbow_forward_largest_deg", "ten testers, elbow, forearm towards the sensor", "deg", 1.9, 1.5),
    Target("testers.elbow_across_largest_deg", "ten testers, elbow, forearm across the view", "deg", 1.9, 1.5),
    Target("bins.right", "right 15-degree step, single frames", "%", 97, 99.5, 100, True),
    Target("legs.T1_mean_deg", "T1, mean error", "deg", 1.5, 0.7),
    Target("legs.right_task", "right task at 3 and 22 deg, single frames", "%", 99.5, 99.9, 100, True),
    Target("real.subject_3", "real Kinect, trusted upper-body joints within 10 cm, subject 3", "%", 90, 95, 100, True),
    Target("nobody.rate", "rooms without a person: persons seen", "%", 0.0, 0.0, 100),
    Target("memory.640x480_mb", "largest memory of teleop track, 640x480", "MB", 400, 250),
)


def target_table(figures: dict[str, float]) -> str:
    """The lines whose figure was measured."""
    rows = [
        [
            t.words,
            f"{t.factor * figures[t.key]:.4g} {t.unit}",
            f"{t.least:g}",
            f"{t.aim:g}",
            t.verdict(t.factor * figures[t.key]),
        ]
        for t in TARGETS
        if t.key in figures
    ]
    return table(("figure", "measured", "at least", "aim", "reached"), rows)
