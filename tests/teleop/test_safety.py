"""Frame checks and watchdog: pure functions of stamps and receive times."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from stick_figure import CAMERA

from teleop.config.intent import SafetyConfig
from teleop.frames import DepthFrame
from teleop.reasons import Reason
from teleop.safety import PictureState, StreamState, step_picture, step_stream, watchdog

CONFIG = SafetyConfig()
MS = 1_000_000


def run(stamps_ms: list[int], receive_ms: list[int] | None = None) -> list[StreamState]:
    stream, out = StreamState(), []
    for i, t in enumerate(stamps_ms):
        stream = step_stream(stream, t * MS, None if receive_ms is None else receive_ms[i] * MS, CONFIG)
        out.append(stream)
    return out


def test_ordinary_frames() -> None:
    out = run([0, 33, 67])
    assert [s.refused for s in out] == [None] * 3
    assert [s.restarted for s in out] == [True, False, False]
    assert out[2].dt_s == pytest.approx(0.034)


@pytest.mark.parametrize("drift_ppm", [50, -50])
def test_clocks_that_drift_apart_for_hours_do_not_make_frames_stale(drift_ppm: int) -> None:
    stream, refused = StreamState(), set()
    for second in range(5 * 3600):
        t_ns = second * 1000 * MS
        receive_ns = t_ns + second * drift_ppm * 1000 + 30 * MS + (second % 7) * MS
        stream = step_stream(stream, t_ns, receive_ns, CONFIG.model_copy(update={"restart_s": 3.0}))
        refused.add(stream.refused)
    assert refused == {None} and not stream.restarted
    late = step_stream(stream, stream.last_t_ns + 33 * MS, receive_ns + 700 * MS, CONFIG)  # type: ignore[operator]
    assert late.refused is Reason.FRAME_STALE, "a late frame is still found out"


def test_duplicate_and_reordered_frames_are_refused_and_time_goes_on() -> None:
    out = run([0, 33, 33, 10, 67])
    assert [s.refused for s in out] == [None, None, Reason.FRAME_DUPLICATE, Reason.FRAME_REORDERED, None]
    assert [s.dt_s for s in out[2:4]] == [0.0, 0.0]
    assert out[4].dt_s == pytest.approx(0.034)


def test_a_gap_or_a_loop_starts_anew() -> None:
    out = run([0, 33, 5000, 0, 33])
    assert [s.restarted for s in out] == [True, False, True, True, False]
    assert all(s.dt_s == 0.0 for s in out if s.restarted)


def test_late_and_future_frames_of_a_live_source() -> None:
    out = run([0, 33, 67, 100, 133], [5000, 5033, 5067 + 700, 5100, 5133])
    assert [s.refused for s in out] == [None, None, Reason.FRAME_STALE, None, None]
    out = run([0, 33, 67 + 900, 100], [5000, 5033, 5067, 5100])
    assert [s.refused for s in out] == [None, None, Reason.FRAME_FUTURE, None]


def test_a_clock_that_was_set_is_believed_after_a_while_as_a_new_stream() -> None:
    stamps = [i * 33 for i in range(10)] + [i * 33 + 700 for i in range(10, 60)]
    out = run(stamps, [5000 + i * 33 for i in range(60)])
    assert out[15].refused is Reason.FRAME_FUTURE
    assert sum(s.restarted for s in out) == 2
    assert out[-1].refused is None


@given(st.lists(st.integers(-2000, 4000), max_size=60))
def test_time_never_runs_backwards_but_for_a_new_stream(steps_ms: list[int]) -> None:
    stamps = np.cumsum(steps_ms).tolist()
    last = None
    for state in run(stamps):
        if last is not None and not state.restarted:
            assert state.last_t_ns >= last.last_t_ns
        assert 0.0 <= state.dt_s < CONFIG.restart_s
        assert not (state.refused and state.restarted)
        last = state


def frame(depth: np.ndarray) -> DepthFrame:
    return DepthFrame(0, depth.astype(np.uint16), CAMERA)


def judged(depths: list[np.ndarray], dt_s: float = 0.05) -> list[Reason | None]:
    state, out = PictureState(), []
    for depth in depths:
        state = step_picture(state, frame(depth), dt_s, CONFIG)
        out.append(state.refused)
    return out


def test_blank_and_saturated_pictures() -> None:
    one_reading = np.zeros((120, 160))
    one_reading[60, 80] = 2000
    pictures = [np.zeros((120, 160)), np.full((120, 160), 65535), one_reading]
    assert judged(pictures) == [Reason.FRAME_BLANK, Reason.FRAME_SATURATED, None]


def test_a_picture_that_stays_the_very_same_is_frozen_and_a_moved_one_is_not() -> None:
    picture = np.random.default_rng(1).integers(2000, 3000, (120, 160))
    moved = picture.copy()
    moved[60, 80] += 1
    reasons = judged([picture] * 10 + [moved] + [picture] * 3)
    frozen = [i for i, reason in enumerate(reasons) if reason is Reason.FRAME_FROZEN]
    assert frozen == list(range(4, 10)), "after 0.2 s, and it ends with the first other picture"


@pytest.mark.parametrize(
    ("silent_ms", "reason"),
    [
        (0, None),
        (199, None),
        (200, "hold.no_frame"),
        (499, "hold.no_frame"),
        (500, "stop.no_frame"),
        (10_000, "stop.no_frame"),
    ],
)
def test_watchdog(silent_ms: int, reason: str | None) -> None:
    command = watchdog(1_000 * MS, (1_000 + silent_ms) * MS, CONFIG)
    assert (None if command is None else command.reasons) == (None if reason is None else (reason,))
    if command is not None:
        assert command.drive_m_s == command.turn_rad_s == 0.0
        assert not command.spray_on


def test_no_frame_ever_is_a_stop() -> None:
    command = watchdog(None, 0, CONFIG)
    assert command is not None and command.reasons == ("stop.no_frame",)


def test_watchdog_times_must_be_in_order() -> None:
    with pytest.raises(ValidationError, match="no_frame_stop_s must be at least"):
        SafetyConfig(no_frame_hold_s=1.0, no_frame_stop_s=0.5)
