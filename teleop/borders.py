"""Crossing a border under noise: Page's cumulative-sum test (Biometrika 41, 1954).

A threshold with a fixed delay is either slow or flips. Page's test adds up how far, and for how long, a value lies
beyond the border plus a margin, and decides when the sum is large: a clear change in few frames, noise at the border
never. With white noise of deviation sigma at n frames/s, the chance of a flip per frame is about
exp(-2 margin h n / sigma^2), h the evidence asked for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

_RISES = 10.0
"""So much quicker the measured noise grows than it shrinks."""


@dataclass(frozen=True, slots=True)
class Border:
    """Parameters of one border; units of the value, and value times seconds for the evidence.

    noise: standard deviation of the value for which the evidence is asked; 0: whatever the noise. quiet: least share of
    the evidence, asked of a value that hardly trembles. memory_s: the noise is a mean over about so long.
    """

    margin: float
    evidence: float
    clip: float
    noise: float = 0.0
    quiet: float = 1.0
    memory_s: float = 0.5


def accumulate(total: float, beyond: float, dt_s: float, border: Border, weight: float = 1.0) -> float:
    """The evidence after one frame of ``dt_s`` seconds, which the caller caps: a gap in time is no evidence.

    total: evidence so far. beyond: how far the value lies across the border, negative on the near side.
    weight: how much the value counts, 1 at its best; proportional to the inverse of its variance.
    """
    counted = min(border.clip, max(-border.clip, beyond - border.margin))
    return max(0.0, total + counted * weight * dt_s)


@dataclass(frozen=True, slots=True)
class Switch:
    """Above or below one threshold, None while undecided; with the evidence for a change.

    last: the value before. variance: of the value's noise, from its changes; None until two values are known.
    """

    above: bool | None = None
    up: float = 0.0
    down: float = 0.0
    last: float | None = None
    variance: float | None = None


def noise_variance(
    variance: float | None, last: float | None, value: float, dt_s: float, border: Border
) -> float | None:
    """Variance of a value's noise after one more: half the mean square of its changes.

    It begins with that of ``noise`` and is never more. A value that moves counts as a noisy one.
    """
    if last is None or border.noise <= 0.0:
        return variance
    before = border.noise**2 if variance is None else variance
    seen = min(0.5 * (value - last) ** 2, border.noise**2)
    # noise that begins is believed at once, that it has gone only after a while
    share = 1.0 - math.exp(-dt_s * (_RISES if seen > before else 1.0) / border.memory_s)
    return before + share * (seen - before)


def needed(variance: float | None, border: Border) -> float:
    """Evidence that decides: in a sequential test between two means it is proportional to the variance (Wald 1945)."""
    if variance is None or border.noise <= 0.0:
        return border.evidence
    return border.evidence * min(1.0, max(border.quiet, variance / border.noise**2))


def step_switch(switch: Switch, value: float | None, threshold: float, dt_s: float, border: Border) -> Switch:
    """One frame of a two-sided decision; an unknown value changes nothing.

    While undecided the margin is not asked for, so that a value on the border is decided too, once.
    """
    if value is None:
        return switch
    used = border if switch.above is not None else replace(border, margin=0.0)
    up = 0.0 if switch.above else accumulate(switch.up, value - threshold, dt_s, used)
    down = 0.0 if switch.above is False else accumulate(switch.down, threshold - value, dt_s, used)
    variance = noise_variance(switch.variance, switch.last, value, dt_s, border)
    enough = needed(variance, border)
    if up > enough:
        return Switch(True, last=value, variance=variance)
    if down > enough:
        return Switch(False, last=value, variance=variance)
    return Switch(switch.above, up, down, value, variance)
