"""``teleop track``: the whole pipeline over a source, one JSON row per frame."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def track(
    source: Annotated[
        str,
        typer.Argument(
            help="Recording, RGB-D folder or sensor, such as session.mcap or openni2:; or a folder of them."
        ),
    ],
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="JSON-lines file, one row per frame; for a folder of recordings a folder."),
    ],
    workers: Annotated[
        int | None, typer.Option(min=1, max=256, help="Folder: recordings at a time. [default: one per core]")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Folder: work on a Dask cluster, such as tcp://host:8786.")
    ] = None,
    no_filter: Annotated[bool, typer.Option("--no-filter", help="Every frame by itself.")] = False,
    config: Annotated[Path | None, typer.Option("--config", help="TOML file with settings, as serve takes it.")] = None,
    operator: Annotated[str | None, typer.Option(help="Profile of who drives; see 'teleop operators'.")] = None,
) -> None:
    """Track a person through SOURCE and write joints, angles, hands, zone, mode and robot command per frame.

    A folder of recordings is worked through on all cores or on a cluster, whose workers must see the same folders; a
    second run does what is not done yet. Exit code 1 when a recording failed.
    """
    from rich.console import Console

    from server.cli.progress import archive_progress
    from server.cli.track_run import load_config, run_track
    from teleop.recording.archive import is_archive

    settings = load_config(config, no_filter, operator)
    console = Console(stderr=True)
    if is_archive(Path(source)):
        from server.cli.track_archive import track_archive
        from server.cli.track_run import refuse_source_as_output
        from teleop.parallel import open_pool
        from teleop.software import library_digest

        if output.exists() and not output.is_dir():
            raise typer.BadParameter(f"{source} is a folder of recordings, so --output must be one, not {output}")
        refuse_source_as_output(source, output)
        with open_pool(workers, scheduler, library_digest) as pool, archive_progress(console) as on_done:
            archive = track_archive(Path(source), output, settings, pool, on_done)
        for line in archive.failed:
            typer.echo(f"teleop: {line}", err=True)
        typer.echo(archive.line())
        if archive.failed:
            raise typer.Exit(1)
        return
    if scheduler is not None or workers is not None:
        raise typer.BadParameter(f"--workers and --scheduler are for a folder of recordings, {source} is one source")
    summary = run_track(source, output, settings, console)
    typer.echo(summary.line())
