"""``teleop push``: the frames of a source on this machine become the source of a server on another one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def push(
    source: Annotated[str, typer.Argument(help="Sensor, recording, RGB-D folder or virtual:.")],
    to: Annotated[str, typer.Option("--to", help="ws:// or wss://HOST:PORT/api/v1/push of the server.")],
    seconds: Annotated[float | None, typer.Option(min=0.1, help="Stop after this many seconds.")] = None,
    color: Annotated[bool, typer.Option("--color/--no-color", help="Send colour, or leave it out (privacy).")] = True,
    loop: Annotated[bool, typer.Option("--loop", help="Begin a recorded source again at its end.")] = False,
    token: Annotated[
        str | None,
        typer.Option(envvar="TELEOP_TOKEN", show_envvar=True, help="Of an operator; needed from another machine."),
    ] = None,
    ca: Annotated[Path | None, typer.Option("--ca", help="Certificate (PEM) behind a wss:// server's own.")] = None,
    window: Annotated[int, typer.Option(min=1, max=100, help="Frames on the way at most; more are left out.")] = 8,
) -> None:
    """Send frames as they come; recordings go at their own pace. Reconnects when the connection is lost."""
    from server.cli.progress import frame_progress
    from server.cli.push_run import RETRY_S, PushOptions, push_frames
    from teleop.sources.reconnect import open_lasting

    opened = open_lasting(source, RETRY_S)
    try:
        total = None if loop else opened.info.frame_count
        with frame_progress("pushing", total) as advance:
            sent = push_frames(opened, to, PushOptions(seconds, color, loop, window, token=token, ca=ca), advance)
    finally:
        opened.close()
    typer.echo(f"{sent.sent} frames sent, {sent.dropped} left out, {sent.connections} connections")
