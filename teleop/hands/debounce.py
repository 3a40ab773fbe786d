"""A hand's settled state from its frame-by-frame readings: evidence is summed until it is enough.

Page's test (Page, "Continuous inspection schemes", Biometrika 1954) on the log odds of single frames: sure frames
change the state after ``debounce_s``, doubtful ones take longer, frames for the old state count against the new.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from teleop.config.intent import HandConfig
from teleop.intent_types import Hand

SURE_LOGIT: Final = 2.19
"""Log odds of a frame that counts in full (90 %); one frame proves no more, neighbours are too much alike."""


@dataclass(frozen=True, slots=True)
class HandMemory:
    """settled: what counts. candidate: what may follow. candidate_s: its evidence, in seconds of sure frames.
    silent_s: time without an answer."""

    settled: Hand = Hand.UNKNOWN
    confidence: float = 0.0
    candidate: Hand = Hand.UNKNOWN
    candidate_s: float = 0.0
    silent_s: float = 0.0


def evidence(confidence: float) -> float:
    """What a frame counts, 0..1, by its probability 0.5..1."""
    if confidence >= 1.0:
        return 1.0
    return min(1.0, max(0.0, math.log(confidence / (1.0 - confidence)) / SURE_LOGIT)) if confidence > 0.5 else 0.0


def step_hand(memory: HandMemory, seen: Hand, confidence: float, dt_s: float, config: HandConfig) -> HandMemory:
    """One frame: a new state counts after ``debounce_s`` of evidence; no answer for ``unknown_s`` makes it unknown."""
    if seen is Hand.UNKNOWN:
        silent_s = memory.silent_s + dt_s
        if silent_s >= config.unknown_s:
            return HandMemory(silent_s=silent_s)
        return HandMemory(memory.settled, memory.confidence, memory.candidate, memory.candidate_s, silent_s)
    # no single frame is proof, however long the gap before it
    gained_s = min(dt_s, 0.5 * config.debounce_s) * evidence(confidence)
    if seen is memory.settled:
        return HandMemory(seen, confidence, memory.candidate, max(0.0, memory.candidate_s - gained_s))
    if memory.candidate is not seen:
        return HandMemory(memory.settled, memory.confidence, seen, 0.0)
    candidate_s = memory.candidate_s + gained_s
    if candidate_s >= config.debounce_s:
        return HandMemory(seen, confidence)
    return HandMemory(memory.settled, memory.confidence, seen, candidate_s)
