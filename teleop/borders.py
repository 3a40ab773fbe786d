"""Crossing a border under noise: Page's cumulative-sum test (Biometrika 41, 1954).

A threshold with a fixed delay is either slow or flips. Page's test adds up how far, and for how long, a value lies
beyond the border plus a margin, and decides when the sum is large: a clear change in few frames, noise at the border
never. With white noise of deviation sigma at n frames/s, the chance of a flip per frame is about
exp(-2 margin h n / sigma^2), h the evidence asked for.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Border:
    """Parameters of one border; units of the value, and value times seconds for the evidence."""

    margin: float
    evidence: float
    clip: float


def accumulate(total: float, beyond: float, dt_s: float, border: Border, weight: float = 1.0) -> float:
    """The evidence after one frame of ``dt_s`` seconds, which the caller caps: a gap in time is no evidence.

    total: evidence so far. beyond: how far the value lies across the border, negative on the near side.
    weight: how much the value counts, 1 at its best; proportional to the inverse of its variance.
    """
    counted = min(border.clip, max(-border.clip, beyond - border.margin))
    return max(0.0, total + counted * weight * dt_s)


@dataclass(frozen=True, slots=True)
class Switch:
    """Above or below one threshold, None while undecided; with the evidence for a change."""

    above: bool | None = None
    up: float = 0.0
    down: float = 0.0


def step_switch(switch: Switch, value: float | None, threshold: float, dt_s: float, border: Border) -> Switch:
    """One frame of a two-sided decision; an unknown value changes nothing.

    While undecided the margin is not asked for, so that a value on the border is decided too, once.
    """
    if value is None:
        return switch
    used = border if switch.above is not None else Border(0.0, border.evidence, border.clip)
    up = 0.0 if switch.above else accumulate(switch.up, value - threshold, dt_s, used)
    down = 0.0 if switch.above is False else accumulate(switch.down, threshold - value, dt_s, used)
    if up > border.evidence:
        return Switch(True)
    if down > border.evidence:
        return Switch(False)
    return Switch(switch.above, up, down)
