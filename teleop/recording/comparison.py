"""Two runs over the same frames, held against each other: what differs, by how much, in how many frames."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from pydantic import Field

from teleop.config.base import Section


class Tolerance(Section):
    """How far a replay may be off when it does not run on the very same version, model and processor."""

    t: float = Field(default=1e-6, ge=0.0, description="time of the frame [s]; rounding only")
    confidence: float = Field(default=0.1, ge=0.0, description="confidence of a joint, 0..1")
    joints: float = Field(default=0.02, ge=0.0, description="joint positions [m]; a third of the tracker's own error")
    angles: float = Field(default=3.0, ge=0.0, description="continuous arm angles [deg]; a fifth of one step of 15")
    command: float = Field(default=5.0, ge=0.0, description="angles told to the robot [deg]; a third of one step")
    robot: float = Field(default=0.1, ge=0.0, description="robot joints [rad or m]; the 5 deg of a command")
    base: float = Field(default=0.02, ge=0.0, description="chassis position [m] and half-angle sine")
    frames: float = Field(default=0.02, ge=0.0, le=1.0, description="share of frames that may differ by more")

    def of(self, group: str) -> float:
        """The tolerance of a group of values; zero for those that have none."""
        return float(getattr(self, group, 0.0)) if group != "frames" else 0.0


NOTICEABLE: Final = Tolerance(confidence=0.01, joints=0.002, angles=0.1, command=0.1, robot=0.002, base=0.002)
"""Differences from which a person would want to hear that other settings make them."""


@dataclass(slots=True)
class Group:
    """One kind of value. beyond: frames in which one differs by more than its tolerance or is another word."""

    largest: float = 0.0
    frames: int = 0
    beyond: int = 0


@dataclass(frozen=True, slots=True)
class Difference:
    """One value of one frame."""

    t_ns: int
    where: str
    before: Any
    after: Any


@dataclass(slots=True)
class Leaf:
    """One value over all frames. first: where it begins to differ. largest: of a number."""

    first: Difference
    frames: int = 0
    largest: float = 0.0


@dataclass(slots=True)
class Comparison:
    """Filled frame by frame. missing: frames that could not be compared because one side lacks them.
    between: steps without a frame that were compared as well.

    leaves: by dotted path, such as ``angles.T1``. start_ns: time of the first frame. blind: differences of numbers
    that do not count; None: every bit counts.
    """

    tolerance: Tolerance = field(default_factory=Tolerance)
    blind: Tolerance | None = None
    frames: int = 0
    differing: int = 0
    missing: int = 0
    between: int = 0
    first: Difference | None = None
    groups: dict[str, Group] = field(default_factory=dict)
    leaves: dict[str, Leaf] = field(default_factory=dict)
    start_ns: int | None = None

    def add(self, t_ns: int, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
        """Compare one frame: JSON objects of numbers, words and nulls, nested at will; numbers bit for bit."""
        self.frames += 1
        self._compare(t_ns, before, after)

    def add_between(self, t_ns: int, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
        """Compare a step without a frame in the same way."""
        self.between += 1
        self._compare(t_ns, before, after)

    def _compare(self, t_ns: int, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
        self.start_ns = t_ns if self.start_ns is None else self.start_ns
        old, new = dict(_leaves(before)), dict(_leaves(after))
        touched: dict[str, bool] = {}
        for where in sorted(old.keys() | new.keys()):
            a, b = old.get(where), new.get(where)
            if a == b:
                continue
            name = where.partition(".")[0]
            gap = abs(a - b) if isinstance(a, int | float) and isinstance(b, int | float) else math.inf
            if self.blind is not None and gap <= self.blind.of(name):
                continue
            difference = Difference(t_ns, where, a, b)
            self.first = self.first or difference
            leaf = self.leaves.setdefault(where, Leaf(difference))
            leaf.frames += 1
            group = self.groups.setdefault(name, Group())
            if gap < math.inf:
                group.largest = max(group.largest, gap)
                leaf.largest = max(leaf.largest, gap)
            far = gap > self.tolerance.of(name)
            touched[name] = touched.get(name, False) or far
        self.differing += bool(touched)
        for name, far in touched.items():
            self.groups[name].frames += 1
            self.groups[name].beyond += far

    @property
    def identical(self) -> bool:
        """Every bit of every frame, and there were some."""
        return self.frames > 0 and self.differing == 0 and self.missing == 0

    @property
    def within_tolerance(self) -> bool:
        """Few enough frames of every kind of value are beyond its tolerance."""
        most = self.tolerance.frames * self.frames
        return self.frames > 0 and self.missing <= most and all(g.beyond <= most for g in self.groups.values())


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted path and value of every leaf. A list of words is one leaf: its order and length count."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(inner, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list | tuple) and all(_is_number(v) for v in value) and value:
        for i, inner in enumerate(value):
            yield from _leaves(inner, f"{path}.{i}")
    else:
        yield path, list(value) if isinstance(value, tuple) else value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
