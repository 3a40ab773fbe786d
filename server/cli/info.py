"""``teleop info``: what a source holds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rich.table import Table

    from teleop.recording.summary import SourceSummary


def info(
    source: Annotated[str, typer.Argument(help="A recording, an RGB-D folder or a source URI.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")] = False,
    seconds: Annotated[
        float | None, typer.Option(min=0.1, help="Read only this many seconds (live sources: 2).")
    ] = None,
    repair: Annotated[
        bool, typer.Option("--repair", help="First make a recording that was cut off whole again, in place.")
    ] = False,
) -> None:
    """Tell what a source holds: camera, frames, rate, gaps, depth, colour, topics, metadata."""
    if repair:
        _repair(source)
    from server.cli.progress import frame_progress
    from teleop.recording.summary import summarise
    from teleop.sources import open_source

    opened = open_source(source)
    try:
        if seconds is None and opened.info.live:
            seconds = 2.0
        with frame_progress("reading", opened.info.frame_count) as advance:
            summary = summarise(opened, seconds=seconds, on_frame=advance)
    finally:
        opened.close()
    if as_json:
        import json
        from dataclasses import asdict

        typer.echo(json.dumps(asdict(summary), indent=1))
        return
    from rich.console import Console

    Console(soft_wrap=True).print(_table(summary))


def _repair(source: str) -> None:
    from pathlib import Path

    from teleop.recording.repair import repair

    saved = repair(Path(source))
    typer.echo(f"{source}: {saved} messages saved" if saved else f"{source} is whole", err=True)


def _table(s: SourceSummary) -> Table:
    """The summary as two columns."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    k = s.camera.depth
    lines = {
        "source": s.uri,
        "kind": s.kind + (", live" if s.live else ""),
        "camera": f"{k.width}x{k.height}, fx {k.fx:.2f} fy {k.fy:.2f} cx {k.cx:.2f} cy {k.cy:.2f} px, "
        + ("mirrored" if s.camera.mirrored else "not mirrored"),
        "frames": f"{s.frames} in {s.duration_s:.2f} s" + (f", {s.rate_hz:.1f} frames/s" if s.rate_hz else ""),
        "gaps": f"{s.gaps}, longest step {s.longest_gap_s:.3f} s",
        "depth": "no readings"
        if s.depth_min_mm is None
        else f"{s.depth_min_mm} .. {s.depth_max_mm} mm, median {s.depth_median_mm} mm, "
        f"{100 * s.valid_fraction:.1f} % of pixels read",
        "colour": f"{s.color_frames} frames" + _color_note(s) if s.color_frames else "none",
        "size": f"{s.size_bytes / 1e6:.2f} MB" if s.size_bytes is not None else "",
        "cut off": s.truncated or "",
    }
    for name, text in lines.items():
        if text:
            table.add_row(name, escape(text))
    for name, topic in s.topics.items():
        table.add_row("topic", escape(f"{name}  {topic.schema}  {topic.messages}"))
    for key, value in sorted(s.metadata.items()):
        table.add_row("metadata", escape(f"{key} = {value}"))
    return table


def _color_note(s: SourceSummary) -> str:
    k = s.camera.color
    return f", own camera {k.width}x{k.height}" if k is not None else ", registered to depth"
