"""Settled hand states."""

from hypothesis import given
from hypothesis import strategies as st

from teleop.config.intent import HandConfig
from teleop.hands.debounce import HandMemory, evidence, step_hand
from teleop.intent_types import Hand

CONFIG = HandConfig()
DT_S = 1 / 30


def run(seen: list[Hand]) -> list[Hand]:
    memory, out = HandMemory(), []
    for hand in seen:
        memory = step_hand(memory, hand, 0.9, DT_S, CONFIG)
        out.append(memory.settled)
    return out


def test_a_new_state_counts_after_the_debounce() -> None:
    out = run([Hand.OPEN] * 20 + [Hand.FIST] * 20)
    assert out[0] is Hand.UNKNOWN and out[19] is Hand.OPEN
    delay_s = (out.index(Hand.FIST) - 20) * DT_S
    assert CONFIG.debounce_s - DT_S <= delay_s <= CONFIG.debounce_s + DT_S


def test_single_wrong_frames_are_ignored() -> None:
    out = run([Hand.OPEN] * 10 + ([Hand.FIST] + [Hand.OPEN] * 3) * 10)
    assert Hand.FIST not in out


def test_doubtful_frames_take_longer_and_contrary_ones_count() -> None:
    def frames_to_fist(confidence: float, contrary: int) -> int:
        memory = HandMemory(Hand.OPEN, 1.0)
        for i in range(100):
            hand = Hand.OPEN if contrary and i % contrary == contrary - 1 else Hand.FIST
            memory = step_hand(memory, hand, confidence, DT_S, CONFIG)
            if memory.settled is Hand.FIST:
                return i + 1
        return 100

    assert frames_to_fist(0.99, 0) < frames_to_fist(0.7, 0) < 20
    assert frames_to_fist(0.99, 0) < frames_to_fist(0.99, 3) < 20
    assert frames_to_fist(0.99, 2) == 100, "as much for the one as for the other: nothing changes"
    assert evidence(0.5) == 0.0 and evidence(1.0) == evidence(0.95) == 1.0


def test_silence_becomes_unknown() -> None:
    out = run([Hand.OPEN] * 10 + [Hand.UNKNOWN] * 30)
    unknown_s = (out.index(Hand.UNKNOWN, 10) - 9) * DT_S
    assert abs(unknown_s - CONFIG.unknown_s) <= DT_S


@given(st.lists(st.sampled_from(Hand), max_size=60))
def test_settled_states_were_seen_twice_or_more(seen: list[Hand]) -> None:
    for i, settled in enumerate(run(seen)):
        if settled is not Hand.UNKNOWN:
            assert sum(hand is settled for hand in seen[: i + 1]) >= 2
