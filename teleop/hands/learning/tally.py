"""Counts of answers and the shares they make."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Share:
    """Of so many hands: how many were decided, and how many of these were right."""

    hands: int
    decided: int
    right: int

    @property
    def decided_percent(self) -> float:
        """Decided of all, in percent; 0 without hands."""
        return 100.0 * self.decided / max(1, self.hands)

    @property
    def right_percent(self) -> float:
        """Right of decided, in percent; 0 when none was decided."""
        return 100.0 * self.right / max(1, self.decided)
