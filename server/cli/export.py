"""``teleop export``: a recording as a table, a film, a dump for fakenect, or a LeRobot dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

KINDS = (
    "NAME.csv: joints, angles, commands; NAME.mp4: film with the skeleton; NAME.fakenect: dump for fakenect; "
    "NAME.lerobot: folder in LeRobot's dataset format."
)


def export(
    source: Annotated[str, typer.Argument(help="A recording, an RGB-D folder or a source URI.")],
    output: Annotated[Path, typer.Argument(help=KINDS)],
    force: Annotated[bool, typer.Option("--force", help="Replace an output that exists.")] = False,
    rate_hz: Annotated[float, typer.Option(min=1.0, max=120.0, help="Pictures per second of a film.")] = 30.0,
    task: Annotated[
        str, typer.Option(help="What is done, in words, for a LeRobot dataset.")
    ] = "pick and spray in the greenhouse by gestures",
    config: Annotated[
        Path | None, typer.Option("--config", help="TOML file with [body] and [intent], where tracking is done now.")
    ] = None,
) -> None:
    """Export for other programs. Recorded tracking rows are used where there are any, else the frames are tracked now.

    RGB-D folders and recordings: teleop convert.
    """
    if output.suffix.lower() not in (".csv", ".mp4", ".fakenect", ".lerobot"):
        raise typer.BadParameter(f"cannot tell what {output.name} is to be; {KINDS}", param_hint="OUTPUT")
    from contextlib import closing

    from server.cli.export_run import export_to
    from server.cli.progress import frame_progress
    from server.cli.track_run import load_config
    from teleop.sources import open_source

    with closing(open_source(source)) as opened, frame_progress("exporting", opened.info.frame_count) as advance:
        settings = load_config(config, no_filter=False)
        count = export_to(output, opened, settings, advance, force=force, rate_hz=rate_hz, task=task)
    typer.echo(f"{count} frames written to {output}")
