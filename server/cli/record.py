"""``teleop record``: a source through the whole pipeline into an MCAP recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def record(
    source: Annotated[str, typer.Argument(help="Sensor, recording, RGB-D folder or virtual:.")],
    output: Annotated[Path, typer.Argument(help="The recording to write, NAME.mcap.")],
    seconds: Annotated[float | None, typer.Option(min=0.1, help="Stop after this many seconds.")] = None,
    color: Annotated[bool, typer.Option("--color/--no-color", help="Keep colour, or leave it out (privacy).")] = True,
    engage: Annotated[
        bool, typer.Option("--engage", help="Engage whoever is seen, as if the button were pressed.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a recording that exists.")] = False,
    operator: Annotated[str | None, typer.Option(help="Profile of who drives; see 'teleop operators'.")] = None,
    config: Annotated[Path | None, typer.Option(metavar="FILE", help="TOML file with settings.")] = None,
) -> None:
    """Record depth, colour, tracking, commands and the simulated robot; ends with the source, the time or Ctrl-C.

    'teleop replay OUT.mcap --verify' does it again and compares every bit.
    """
    from server.cli.progress import frame_progress
    from server.settings import load_settings, with_operator
    from teleop.errors import RecordingError
    from teleop.recording.convert import refuse_overwrite
    from teleop.sources.reconnect import open_lasting

    if output.suffix.lower() != ".mcap":
        raise typer.BadParameter(f"a recording is named NAME.mcap, not {output.name}; other formats: teleop convert")
    settings = load_settings(config)
    if operator is not None:
        settings = with_operator(settings, operator)
    opened = open_lasting(source, settings.sensor.retry_s)
    count = 0
    try:
        refuse_overwrite(output, opened, force)
        from server.quiet import quiet_output

        with quiet_output():
            from server.cli.record_run import RecordOptions, record_session  # loading PyBullet prints

        output.unlink(missing_ok=True)
        with frame_progress("recording", opened.info.frame_count) as advance:

            def on_frame(frame: object) -> None:
                nonlocal count
                count += 1
                advance(frame)  # type: ignore[arg-type]

            try:
                options = RecordOptions(seconds, color, engage)
                record_session(opened, output, settings, options, on_frame, lambda text: typer.echo(text, err=True))
            except KeyboardInterrupt:
                typer.echo("stopped", err=True)  # what was recorded until then is complete
    finally:
        opened.close()
    if count == 0:
        raise RecordingError(f"{source} gave no frames; nothing was recorded")
    typer.echo(f"{count} frames recorded to {output}")
