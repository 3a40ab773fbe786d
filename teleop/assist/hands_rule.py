"""What both hands say to an assisted pick. Pure; hands in their roles, debounced."""

from __future__ import annotations

from teleop.assist.task import Confirmation
from teleop.intent_types import Hand, Hands


def step_confirmation(before: Confirmation, hands: Hands) -> Confirmation:
    """One frame over a preview: the left hand's change from open to fist confirms, until it opens again."""
    if hands.left is Hand.OPEN:
        return Confirmation(was_open=True)
    if hands.left is Hand.FIST and before.was_open:
        return Confirmation(was_open=True, confirmed=True)
    return before


def both_closed(hands: Hands) -> bool:
    """What lets the robot move."""
    return hands.right is Hand.FIST and hands.left is Hand.FIST


def takes_over(hands: Hands) -> bool:
    """Both hands were closed when the pick began, so an open one has been opened since."""
    return Hand.OPEN in (hands.right, hands.left)
