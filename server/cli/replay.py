"""``teleop replay``: watch a recording in the console, or do it again and compare."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def replay(
    recording: Annotated[Path, typer.Argument(help="A recording made by 'teleop record' or 'teleop serve --record'.")],
    verify: Annotated[
        bool, typer.Option("--verify", help="Do it again without a console; exit code 1 when the answers differ.")
    ] = False,
    config: Annotated[
        Path | None,
        typer.Option("--config", metavar="FILE", help="Do it again with these settings laid over the recorded ones."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the comparison as one JSON object.")] = False,
    console: Annotated[
        bool,
        typer.Option(
            "--console", help="With --config: in the console under FILE's settings, the recorded robot as a ghost."
        ),
    ] = False,
    port: Annotated[int | None, typer.Option(help="TCP port of the console. [default: 8000]")] = None,
) -> None:
    """Replay a recording: in the console, or (--verify, --config) through the whole pipeline once more.

    On the software version, body model and processor that recorded it every bit must agree; on others the stated
    tolerances hold. Raw frames and recorded inputs go in, tracking rows, robot joints and chassis are compared.
    """
    if console and config is None:
        raise typer.BadParameter("--console goes with --config; a plain replay opens the console anyway")
    if not verify and (config is None or console):
        from server.cli.serve import serve

        serve(source=str(recording), port=port, config=config)
        return
    if verify and config is not None:
        raise typer.BadParameter("--verify repeats the recorded settings, --config changes them; choose one")
    import tomllib

    from server.cli.progress import frame_progress
    from server.cli.replay_words import lines, whatif_lines
    from server.errors import SettingsError
    from server.quiet import quiet_output
    from teleop.body.model import load_model
    from teleop.recording import McapSource

    with quiet_output():
        from server.cli.replay_run import compare, unlike  # loading PyBullet prints

    change = None
    if config is not None:
        try:
            change = tomllib.loads(config.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise SettingsError(f"cannot read the settings {config}: {error}") from None
    source = McapSource(recording)
    try:
        model = load_model()
        unlikeness = unlike(source, model)
        with frame_progress("replaying", source.info.frame_count) as advance:
            found = compare(source, model, change, advance)
    finally:
        source.close()
    ok = change is not None or found.identical or (bool(unlikeness) and found.within_tolerance)
    if as_json:
        import json
        from dataclasses import asdict

        content = asdict(found) | {"tolerance": found.tolerance.model_dump(), "unlike": unlikeness}
        typer.echo(json.dumps(content | {"identical": found.identical, "ok": ok}, indent=1))
    else:
        told = lines(found, unlikeness) if change is None else whatif_lines(found)
        typer.echo("\n".join(told))
    if not ok:
        raise typer.Exit(1)
