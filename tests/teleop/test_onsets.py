"""A reason is told when it begins."""

from teleop.intent_types import Event
from teleop.onsets import Onsets, step_onsets


def test_a_reason_is_told_once_while_it_lasts_or_flickers_and_again_after_a_pause() -> None:
    onsets, told = Onsets(), []
    for i in range(60):
        codes = ["hold.gesture", "hold.arm_locked"] if i < 10 or i in (12, 14) or i >= 50 else []
        events, onsets = step_onsets(onsets, codes, (), i, i / 30)
        told += [(e.t_ns, e.kind, e.reason) for e in events]
    assert told == [(0, "hold", "hold.gesture"), (50, "hold", "hold.gesture")]


def test_a_late_step_makes_nothing_begin_anew() -> None:
    onsets, told = Onsets(), []
    for i, now_s in enumerate((0.0, 0.1, 3.0, 3.1)):
        events, onsets = step_onsets(onsets, ["stop.no_frame"] if i < 3 else [], (), i, now_s)
        told += [e.t_ns for e in events]
    assert told == [0]


def test_what_another_event_tells_is_not_told_twice() -> None:
    refused = Event(5, "refused", "refused.request_estop")
    events, onsets = step_onsets(Onsets(), ["refused.request_estop", "mode.resumed"], (refused,), 5, 0.0)
    assert events == ()
    assert step_onsets(onsets, ["refused.request_estop"], (), 6, 0.1)[0] == ()
