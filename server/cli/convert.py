"""``teleop convert``: any source to an MCAP recording, an RGB-D folder or a fakenect dump."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def convert(
    source: Annotated[str, typer.Argument(help="A recording, an RGB-D folder or a source URI.")],
    output: Annotated[
        Path,
        typer.Argument(
            help="NAME.mcap: a recording; NAME.fakenect: a dump for fakenect; any other name: an RGB-D folder."
        ),
    ],
    force: Annotated[bool, typer.Option("--force", help="Replace an output that exists.")] = False,
    color: Annotated[bool, typer.Option("--color/--no-color", help="Keep colour, or leave it out.")] = True,
    from_s: Annotated[float, typer.Option("--from", min=0.0, help="Start this many seconds in.")] = 0.0,
    seconds: Annotated[float | None, typer.Option(min=0.001, help="Take this many seconds only.")] = None,
) -> None:
    """Convert depth and colour between recordings, RGB-D folders and sensors' own formats; depth stays bit-equal."""
    from server.cli.progress import frame_progress
    from teleop.recording.convert import convert as convert_frames
    from teleop.sources import open_source

    opened = open_source(source)
    try:
        with frame_progress("converting", opened.info.frame_count) as advance:
            count = convert_frames(
                opened, output, force=force, color=color, from_s=from_s, seconds=seconds, on_frame=advance
            )
    finally:
        opened.close()
    typer.echo(f"{count} frames written to {output}")
