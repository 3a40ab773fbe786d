"""``teleop track``: the whole pipeline over a source, one JSON row per frame."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def track(
    source: Annotated[str, typer.Argument(help="Recording, RGB-D folder or sensor, such as session.mcap or openni2:")],
    output: Annotated[Path, typer.Option("--output", "-o", help="JSON-lines file to write, one row per frame.")],
    no_filter: Annotated[bool, typer.Option("--no-filter", help="Every frame by itself.")] = False,
    config: Annotated[Path | None, typer.Option("--config", help="TOML file with settings, as serve takes it.")] = None,
) -> None:
    """Track a person through SOURCE and write joints, angles, hands, zone, mode and robot command per frame."""
    from rich.console import Console

    from server.cli.track_run import load_config, run_track

    settings = load_config(config, no_filter)
    console = Console(stderr=True)
    summary = run_track(source, output, settings, console)
    typer.echo(summary.line())
