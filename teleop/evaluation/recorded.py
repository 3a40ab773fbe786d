"""The real Kinect recordings: nearness to another tracker's trusted joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from teleop.evaluation.answers import Answers, run_tracker
from teleop.evaluation.cases import Case
from teleop.evaluation.metrics import figures_of, near_share
from teleop.evaluation.overall import joint_table
from teleop.evaluation.real import FRAMES, UPPER_BODY, load_real
from teleop.evaluation.section import Bench, Section, percent, table


def real_cases(every: int, advance: Callable[[], None] = lambda: None) -> Iterator[Case]:
    """Every n-th recorded frame; the group is the subject. Only joints that agree with the depth image count."""
    for r in load_real(every):
        yield Case(r.frame, r.joints_m, r.trusted, group=r.subject)
        advance()


def real_table(answers: Answers) -> tuple[str, dict[str, float]]:
    """Trusted upper-body joints within 10 cm, by subject and of all."""
    rows, figures = [], {}
    for subject in sorted(set(answers.group.tolist())):
        part = answers.of_group(subject)
        share = near_share(figures_of(part), UPPER_BODY)
        rows.append([f"subject {subject}", str(len(part)), percent(share)])
        figures[f"real.subject_{subject}"] = share
    figures["real.all"] = near_share(figures_of(answers), UPPER_BODY)
    rows.append(["all", str(len(answers)), percent(figures["real.all"])])
    return table(("", "frames", "trusted upper-body joints within 10 cm %"), rows), figures


def real_section(bench: Bench) -> list[Section]:
    """Single frames, thinned to about three times the frames of one setting. Raises DataError without the data set."""
    every = max(1, FRAMES // (3 * bench.frames))
    with bench.counting("real recordings", -(-FRAMES // every)) as advance:
        answers = run_tracker(bench.single, real_cases(every, advance), single=True)
    head, figures = real_table(answers)
    text = (
        f"One frame in {every}, each alone. The other tracker is Microsoft's; its joints are not the truth. Thresholds "
        "were tuned on subject 1 at most: subject 3 is the figure to quote.\n\n"
    )
    return [Section("Real Kinect v1", text + head + "\n\n" + joint_table(answers), figures)]
