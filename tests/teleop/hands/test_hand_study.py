"""The hand study: its counts and tables, the rendered hands behind it, photographs cut by a box."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teleop.config.intent import HandConfig
from teleop.errors import DataError
from teleop.hands.learning.cases import JOINTS, RULES, Case
from teleop.hands.learning.photos import rendered_photo, webcam_photos
from teleop.hands.learning.sessions import SessionFigures
from teleop.hands.learning.study import HandStudy, draw, report, write_csv
from teleop.hands.learning.tables import between_table, confusion_table, groups_table, share
from teleop.hands.learning.tally import Share
from teleop.hands.photo import photo_patch, read_photo
from teleop.hands.reader import read_hands
from teleop.intent_types import Hand
from teleop.people.hand_shots import hand_shots
from teleop.skeleton import Skeleton

CONFIG = HandConfig()


def case(truth: Hand, answer: Hand, tone: float = 120.0, logit: float | None = 2.0) -> Case:
    answers = {(joints, rule): answer if rule == RULES[0] else Hand.FIST for joints in JOINTS for rule in RULES}
    return Case(truth, answers, logit, None, tone, 0.9, 2.3, 0.8, 0.2, False, False)


CASES = [
    *[case(Hand.OPEN, Hand.OPEN, tone=200.0)] * 6,
    *[case(Hand.FIST, Hand.FIST, logit=-2.0)] * 5,
    case(Hand.OPEN, Hand.FIST, logit=-1.5),
    case(Hand.FIST, Hand.UNKNOWN, logit=None),
]


def test_shares_are_counts() -> None:
    ours, source = share(CASES, JOINTS[0], RULES[0]), share(CASES, JOINTS[0], RULES[2])
    assert (ours.hands, ours.decided, ours.right) == (13, 12, 11)
    assert (source.hands, source.decided, source.right) == (13, 13, 6)
    assert ours.right_percent == pytest.approx(1100 / 12)
    assert Share(0, 0, 0).right_percent == 0.0


def test_tables_name_what_was_counted() -> None:
    assert "| open | 6 | 1 | 0 |" in confusion_table(CASES, JOINTS[0])
    assert "| fist | 0 | 5 | 1 |" in confusion_table(CASES, JOINTS[0])
    table = groups_table(CASES, JOINTS[0])
    assert "| skin: light | 6 | 100.0 % of 100.0 %" in table
    assert "skin: dark" not in table, "nobody was"
    half = [replace(CASES[0], curl=0.2), replace(CASES[-1], curl=0.4)]
    assert "| 14-30 % | 1 | 100.0 % | 0.0 % | 0.0 % |" in between_table(half, JOINTS[0])
    assert "| 30-50 % | 1 | 0.0 % | 0.0 % | 100.0 % |" in between_table(half, JOINTS[0])


def test_the_report_and_its_files(tmp_path: Path) -> None:
    session = SessionFigures(100, 80, (90, 88), (80, 80), (0.1, 0.2), 2, 0)
    text = report(HandStudy(CASES, Share(119, 119, 115), session, gloved=CASES[:6], between=CASES), CONFIG)
    assert "6 hands: 100.0 % right of the 100.0 % decided" in text
    assert "11.0" not in text.split("\n")[2] and "**91.7 % right of the 92.3 % decided**" in text
    assert "96.6 % right of all 119" in text and "after the debounce | 100.0 % | 100.0 %" in text
    write_csv(tmp_path / "hands.csv", CASES)
    assert len((tmp_path / "hands.csv").read_text().splitlines()) == 14
    draw(tmp_path / "hands.png", CASES)
    assert (tmp_path / "hands.png").read_bytes().startswith(b"\x89PNG")


def test_rendered_hands_show_what_they_say() -> None:
    """Windows and whole images of the same person: same hands; most are read right."""
    decided = right = 0
    try:
        for seed in range(12):
            windows = {shot.side: shot for shot in hand_shots(seed, "test")}
            for shot in hand_shots(seed, "test", whole=True):
                small = windows.get(shot.side)
                if small is None:
                    continue
                assert small.curl == shot.curl and np.array_equal(small.joints_m, shot.joints_m)
                gloved = [g for g in hand_shots(seed, "test", gloves=1.0, between=1.0) if g.side == shot.side]
                assert all(g.gloved and 0.14 <= g.curl <= 0.86 for g in gloved) and not shot.gloved
                assert -1.0 <= shot.palm_cos <= 1.0 and 0.55 <= shot.light <= 1.15
                body = Skeleton(0, small.joints_m, np.ones(20))
                answer = getattr(read_hands(small.frame, body, CONFIG), shot.side)
                decided += answer is not Hand.UNKNOWN
                right += answer is (Hand.OPEN if shot.curl < 0.5 else Hand.FIST)
    except DataError as error:
        pytest.skip(str(error))
    assert decided >= 8 and right / decided > 0.8


def test_photographs_are_cut_by_their_box() -> None:
    rng = np.random.default_rng(0)
    for size in ((30, 60), (60, 30), (200, 190)):
        patch = photo_patch(rng.integers(0, 255, (*size, 3)).astype(np.uint8), CONFIG)
        assert patch.shape == (40, 40, 2) and np.isfinite(patch).all()
    try:
        photos = webcam_photos()
        shots = list(hand_shots(3, "train"))
    except DataError as error:
        pytest.skip(str(error))
    assert sum(p.is_open for p in photos) == 48 and len(photos) == 119
    answers = [(read_photo(p.box_rgb, CONFIG)[0], p.is_open) for p in photos[::4]]
    decided = [(hand is Hand.OPEN) == is_open for hand, is_open in answers if hand is not Hand.UNKNOWN]
    assert len(decided) > 20 and np.mean(decided) > 0.9
    for shot in shots:
        photo = rendered_photo(shot)
        assert photo is None or photo.is_open == (shot.curl < 0.5)
