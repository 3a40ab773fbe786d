"""A hand's settled state from its frame-by-frame readings."""

from __future__ import annotations

from dataclasses import dataclass

from teleop.config.intent import HandConfig
from teleop.intent_types import Hand


@dataclass(frozen=True, slots=True)
class HandMemory:
    """settled: what counts. candidate: what may follow, seen for candidate_s. silent_s: time without an answer."""

    settled: Hand = Hand.UNKNOWN
    confidence: float = 0.0
    candidate: Hand = Hand.UNKNOWN
    candidate_s: float = 0.0
    silent_s: float = 0.0


def step_hand(memory: HandMemory, seen: Hand, confidence: float, dt_s: float, config: HandConfig) -> HandMemory:
    """One frame: a new state counts after ``debounce_s``; no answer for ``unknown_s`` makes it unknown."""
    if seen is Hand.UNKNOWN:
        silent_s = memory.silent_s + dt_s
        if silent_s >= config.unknown_s:
            return HandMemory(silent_s=silent_s)
        return HandMemory(memory.settled, memory.confidence, memory.candidate, memory.candidate_s, silent_s)
    if seen is memory.settled:
        return HandMemory(seen, confidence)
    candidate_s = memory.candidate_s + dt_s if memory.candidate is seen else 0.0
    if candidate_s >= config.debounce_s:
        return HandMemory(seen, confidence)
    return HandMemory(memory.settled, memory.confidence, seen, candidate_s)
