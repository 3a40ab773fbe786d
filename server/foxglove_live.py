"""``teleop serve --foxglove``: what a recording holds, live, over Foxglove's own websocket on this machine only.

The same topics and schemas as in a recording; stamped with this machine's clock, because a replay that loops would
turn the viewer's time back. A slow viewer sees fewer frames and never holds the robot up.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

from foxglove import Context, start_server
from foxglove.websocket import ChannelView, Client, ServerListener

from server.engine.core import Moment
from server.engine.recording import inputs_row
from server.errors import ServerError
from teleop.intent_types import Event
from teleop.recording.channels import Channels, root_link
from teleop.track_row import track_row

HOST = "127.0.0.1"
"""The protocol knows no login."""
_REPEAT_S = 1.0
"""Camera infos come again after this; the robot's description when somebody subscribes."""
_BACKLOG = 64
_EVENTS = 200


class FoxgloveLive(threading.Thread):
    """Takes moments as they come, sends the newest to who looks on."""

    def __init__(self, urdf: str, port: int, jpeg_quality: int) -> None:
        """Open the websocket; port 0 takes a free one. Raises ServerError."""
        super().__init__(name="foxglove", daemon=True)
        self._context = Context()
        self._channels = Channels(self._context, urdf, root_link(urdf), jpeg_quality)
        self._ready = threading.Condition()
        self._slot: Moment | None = None
        self._events: deque[Event] = deque(maxlen=_EVENTS)
        self._newcomer = True
        self._stopping = False
        self._described_s = 0.0
        try:
            self._server = start_server(
                name="greenhouse-teleop",
                host=HOST,
                port=port,
                context=self._context,
                server_listener=_Newcomers(self._welcome),
                message_backlog_size=_BACKLOG,
            )
        except (RuntimeError, OSError) as error:
            raise ServerError(
                f"no Foxglove websocket on port {port}: {error}; choose another --foxglove-port"
            ) from None
        self.port = self._server.port

    def offer(self, moment: Moment) -> None:
        """Leave a moment, from the engine's thread; one not yet sent is replaced, its events are not."""
        with self._ready:
            self._events.extend(moment.events)
            self._slot = moment
            self._ready.notify()

    def stop(self) -> None:
        """Close the websocket and end the thread."""
        with self._ready:
            self._stopping = True
            self._ready.notify()
        if self.is_alive():
            self.join(5.0)
        self._server.stop()

    def run(self) -> None:
        """Send until stopped."""
        while True:
            with self._ready:
                self._ready.wait_for(lambda: self._slot is not None or self._stopping)
                if self._stopping or self._slot is None:
                    return
                moment, self._slot = self._slot, None
                events, newcomer = tuple(self._events), self._newcomer
                self._events.clear()
                self._newcomer = False
            self._send(moment, events, newcomer)

    def _send(self, moment: Moment, events: tuple[Event, ...], newcomer: bool) -> None:
        channels, t_ns = self._channels, time.time_ns()
        if newcomer:
            channels.log_description(t_ns)
        frame, output = moment.frame, moment.output
        if frame is not None and (newcomer or t_ns * 1e-9 - self._described_s >= _REPEAT_S):
            self._described_s = t_ns * 1e-9
            channels.log_depth_info(t_ns, frame.camera)
            channels.log_color_info(t_ns, frame)
        if moment.fresh and frame is not None and output is not None:
            if channels.depth.has_sinks():
                channels.log_depth(t_ns, frame)
            if channels.color.has_sinks():
                channels.log_color(t_ns, frame)
            channels.log_skeleton(t_ns, output.track.skeleton, frame.camera)
            channels.log_row(t_ns, track_row(output.track, output.intent, moment.command))
        channels.log_robot(t_ns, moment.robot)
        for event in events:
            channels.log_event(t_ns, event)
        channels.log_input(t_ns, inputs_row(moment, stored=False))

    def _welcome(self) -> None:
        with self._ready:
            self._newcomer = True


class _Newcomers(ServerListener):
    """Tells when somebody subscribes."""

    def __init__(self, welcome: Callable[[], None]) -> None:
        self._welcome = welcome

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Called by the websocket's thread."""
        del client, channel
        self._welcome()
