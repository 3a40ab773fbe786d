"""Which frames are used, and what happens when none come: pure functions of stamps and receive times."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace
from typing import Final

from robot_sim.commands import RobotCommand, stop_command
from teleop.config.intent import SafetyConfig
from teleop.frames import DepthFrame
from teleop.reasons import Reason


@dataclass(frozen=True, slots=True)
class StreamState:
    """What is known of the stream of frames after one of them.

    last_t_ns: stamp of the last used frame. dt_s: time since the one before it, 0 for a refused frame.
    lag_ns: smallest receive time minus stamp so far, the usual way from sensor to here; it grows slowly, because
    the two clocks drift apart.
    refused: why this frame was not used. restarted: the stream starts anew at this frame.
    refused_since_ns: receive time of the first of a run of refused frames.
    """

    last_t_ns: int | None = None
    dt_s: float = 0.0
    lag_ns: int | None = None
    refused: Reason | None = None
    restarted: bool = False
    refused_since_ns: int | None = None


def _refusal(stream: StreamState, t_ns: int, receive_t_ns: int | None, config: SafetyConfig) -> Reason | None:
    if stream.last_t_ns is None:
        return None
    if t_ns == stream.last_t_ns:
        return Reason.FRAME_DUPLICATE
    if stream.last_t_ns - config.restart_s * 1e9 < t_ns < stream.last_t_ns:
        return Reason.FRAME_REORDERED
    if receive_t_ns is not None and stream.lag_ns is not None:
        later_s = (receive_t_ns - t_ns - stream.lag_ns) * 1e-9
        if later_s > config.stale_s:
            return Reason.FRAME_STALE
        if later_s < -config.future_s:
            return Reason.FRAME_FUTURE
    return None


def step_stream(stream: StreamState, t_ns: int, receive_t_ns: int | None, config: SafetyConfig) -> StreamState:
    """Judge one frame by its stamp and, for live sources, by when it was received (both ns, any epoch).

    Refused: the stamp of the frame before, an older one, one later or earlier than the usual way allows. A stamp far
    back, a long gap, or nothing but refused frames for ``restart_s`` starts the stream anew.
    """
    reason = _refusal(stream, t_ns, receive_t_ns, config)
    if reason is not None:
        since = stream.refused_since_ns if stream.refused_since_ns is not None else receive_t_ns
        stuck = since is not None and receive_t_ns is not None and receive_t_ns - since >= config.restart_s * 1e9
        if not stuck or reason is Reason.FRAME_DUPLICATE:
            return replace(stream, dt_s=0.0, refused=reason, restarted=False, refused_since_ns=since)
        stream = StreamState()
    lag_ns = None if receive_t_ns is None else receive_t_ns - t_ns
    if stream.last_t_ns is None:
        return StreamState(t_ns, 0.0, lag_ns, restarted=True)
    dt_s = (t_ns - stream.last_t_ns) * 1e-9
    if dt_s < 0 or dt_s >= config.restart_s:
        return StreamState(t_ns, 0.0, lag_ns, restarted=True)
    if lag_ns is not None and stream.lag_ns is not None:
        lag_ns = min(lag_ns, stream.lag_ns + round(dt_s * config.clock_drift_ppm * 1e3))
    return StreamState(t_ns, dt_s, lag_ns)


@dataclass(frozen=True, slots=True)
class PictureState:
    """What is known of the pictures. refused: why the last one shows nothing. digest: of its depth. same_s: for how
    long it has not changed by a single reading."""

    refused: Reason | None = None
    digest: int | None = None
    same_s: float = 0.0


_EVERY: Final = 4
"""Rows and columns whose readings are compared; noise changes some of them in every picture."""


def step_picture(state: PictureState, frame: DepthFrame, dt_s: float, config: SafetyConfig) -> PictureState:
    """Judge one picture: no reading at all, the same reading everywhere, or the very picture of the frames before."""
    low, high = int(frame.depth_mm.min()), int(frame.depth_mm.max())
    if low == high:
        return PictureState(Reason.FRAME_BLANK if high == 0 else Reason.FRAME_SATURATED)
    digest = zlib.crc32(frame.depth_mm[::_EVERY, ::_EVERY].tobytes())
    if digest != state.digest:
        return PictureState(None, digest)
    same_s = state.same_s + dt_s
    return PictureState(Reason.FRAME_FROZEN if same_s >= config.frozen_s else None, digest, same_s)


def watchdog(last_receive_ns: int | None, now_ns: int, config: SafetyConfig) -> RobotCommand | None:
    """The command that replaces the pipeline's when frames stay away; None while they come.

    Times are receive times of one monotonic clock in ns. From ``no_frame_hold_s`` on the robot holds (which stops
    chassis and spray), from ``no_frame_stop_s`` on it is stopped; without any frame yet it is stopped.
    """
    if last_receive_ns is None:
        return stop_command(now_ns, Reason.NO_FRAME_STOP)
    silent_s = (now_ns - last_receive_ns) * 1e-9
    if silent_s >= config.no_frame_stop_s:
        return stop_command(now_ns, Reason.NO_FRAME_STOP)
    if silent_s >= config.no_frame_hold_s:
        return stop_command(now_ns, Reason.NO_FRAME_HOLD)
    return None
