"""Pace of a replay, by a clock of our own."""

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from server.engine.playback import Pace, Playback, Turn
from server.errors import Refused


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def made(loop: bool = False) -> tuple[Playback, Clock]:
    clock = Clock()
    return Playback(loop, 10.0, clock), clock


@given(st.floats(0, 1e4), st.floats(0, 100), st.floats(0.1, 8), st.floats(0, 100))
def test_a_frame_is_due_when_the_recording_has_run_so_far(wall: float, start: float, speed: float, more: float) -> None:
    assert Pace(wall, start, speed).due_s(start + more) == pytest.approx(wall + more / speed)


def test_frames_that_are_due_are_delivered_and_move_the_position() -> None:
    playback, clock = made()
    clock.now += 2.0
    assert playback.turn(2.0) is Turn.DELIVER
    assert playback.state.position_s == 2.0


def test_twice_the_speed_makes_frames_due_in_half_the_time() -> None:
    playback, clock = made()
    playback.set_speed(2.0)
    clock.now += 1.5
    assert playback.turn(3.0) is Turn.DELIVER


def test_a_seek_sends_the_reader_there_and_shows_the_frame_even_while_paused() -> None:
    playback, _ = made()
    playback.pause()
    playback.seek(7.0)
    assert playback.turn(0.1) is Turn.SEEK
    assert playback.start_at() == 7.0
    assert playback.turn(7.0) is Turn.DELIVER
    assert playback.state.paused and playback.state.position_s == 7.0


def test_a_paused_replay_waits_until_it_is_stopped() -> None:
    playback, clock = made()
    playback.pause()
    clock.now += 100.0
    turns: list[Turn] = []
    reader = threading.Thread(target=lambda: turns.append(playback.turn(0.0)))
    reader.start()
    reader.join(0.1)
    assert reader.is_alive() and not turns
    playback.stop()
    reader.join(5)
    assert turns == [Turn.STOP]


def test_the_end_loops_or_waits_and_play_begins_again() -> None:
    looping, _ = made(loop=True)
    assert looping.end() is Turn.SEEK and looping.start_at() == 0.0
    once, _ = made()
    turns: list[Turn] = []
    reader = threading.Thread(target=lambda: turns.append(once.end()))
    reader.start()
    reader.join(0.05)
    assert once.state.ended and not turns
    once.play()
    reader.join(5)
    assert turns == [Turn.SEEK] and once.start_at() == 0.0 and not once.state.ended


def test_a_loop_switched_on_while_playing_counts_at_the_end() -> None:
    playback, _ = made()
    playback.set_loop(True)
    assert playback.state.loop and playback.end() is Turn.SEEK
    playback.start_at()
    playback.set_loop(False)
    turns: list[Turn] = []
    reader = threading.Thread(target=lambda: turns.append(playback.end()))
    reader.start()
    reader.join(0.05)
    assert playback.state.ended and not turns
    playback.stop()
    reader.join(5)
    assert turns == [Turn.STOP]


def test_falling_behind_does_not_make_the_replay_race() -> None:
    playback, clock = made()
    clock.now += 5.0
    assert playback.turn(0.5) is Turn.DELIVER
    clock.now += 0.5
    assert playback.turn(1.0) is Turn.DELIVER
    waiting = threading.Thread(target=playback.turn, args=(2.0,))
    waiting.start()
    waiting.join(0.05)
    assert waiting.is_alive()
    playback.stop()
    waiting.join(5)


@pytest.mark.parametrize("position_s", [-0.1, 10.5, float("nan")])
def test_a_seek_outside_the_recording_names_its_length(position_s: float) -> None:
    with pytest.raises(Refused, match="0 <= position_s <= 10"):
        made()[0].seek(position_s)


@pytest.mark.parametrize("speed", [0.0, -1.0, 9.0, float("nan")])
def test_a_speed_out_of_range_is_refused(speed: float) -> None:
    with pytest.raises(Refused, match=r"0\.1 <= speed <= 8"):
        made()[0].set_speed(speed)
