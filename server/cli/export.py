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
    from server.cli.progress import frame_progress
    from teleop.errors import RecordingError
    from teleop.recording.convert import convert, refuse_overwrite
    from teleop.recording.resumable import remove
    from teleop.sources import open_source

    kind = output.suffix.lower()
    if kind not in (".csv", ".mp4", ".fakenect", ".lerobot"):
        raise typer.BadParameter(f"cannot tell what {output.name} is to be; {KINDS}", param_hint="OUTPUT")
    opened = open_source(source)
    partial = output.with_name(f"{output.stem}.partial{output.suffix}")
    try:
        if opened.info.live:
            raise RecordingError(f"{source} is live and has no end; record it first with 'teleop record'")
        with frame_progress("exporting", opened.info.frame_count) as advance:
            if kind == ".fakenect":
                count = convert(opened, output, force=force, on_frame=advance)
            else:
                refuse_overwrite(output, opened, force)
                from server.cli.export_run import tracked, write_csv, write_lerobot, write_video
                from server.cli.track_run import load_config

                pairs = tracked(opened, load_config(config, no_filter=False))
                if kind == ".csv":
                    count = write_csv(partial, pairs, advance)
                elif kind == ".lerobot":
                    remove(partial)
                    count = write_lerobot(partial, opened, pairs, task, advance)
                else:
                    count = write_video(partial, pairs, rate_hz, advance)
                if count == 0:
                    raise RecordingError(f"{source} has no frames with tracking rows; nothing was written")
                if force or output.is_dir():
                    remove(output)
                partial.replace(output)
    finally:
        opened.close()
        remove(partial)
    typer.echo(f"{count} frames written to {output}")
