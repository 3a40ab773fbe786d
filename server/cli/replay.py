"""``teleop replay``: watch a recording in the console, or do it again and compare."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from teleop.recording.comparison import Comparison


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
    port: Annotated[int | None, typer.Option(help="TCP port of the console. [default: 8000]")] = None,
) -> None:
    """Replay a recording: in the console, or (--verify, --config) through the whole pipeline once more.

    On the software version, body model and processor that recorded it every bit must agree; on others the stated
    tolerances hold. Raw frames and recorded inputs go in, tracking rows, robot joints and chassis are compared.
    """
    if not verify and config is None:
        from server.cli.serve import serve

        serve(source=str(recording), port=port)
        return
    if verify and config is not None:
        raise typer.BadParameter("--verify repeats the recorded settings, --config changes them; choose one")
    import tomllib

    from server.cli.progress import frame_progress
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
        typer.echo("\n".join(lines(found, unlikeness, changed=change is not None)))
    if not ok:
        raise typer.Exit(1)


def lines(found: Comparison, unlikeness: list[str], *, changed: bool) -> list[str]:
    """The comparison for people."""
    if found.identical:
        return [f"{found.frames} frames: every tracking row and robot state agrees bit for bit"]
    text = [f"{found.differing} of {found.frames} frames differ"]
    if found.missing:
        text.append(f"{found.missing} frames could not be compared: the recording lacks them or their rows")
    if found.first is not None:
        first = found.first
        text.append(f"first at {first.t_ns * 1e-9:.3f} s: {first.where} was {first.before}, is now {first.after}")
    for name, group in sorted(found.groups.items()):
        largest = f", largest {group.largest:.3g} (tolerance {found.tolerance.of(name):g})" if group.largest else ""
        text.append(f"  {name}: {group.frames} frames{largest}, {group.beyond} beyond")
    if not changed:
        text.append(
            f"tolerances apply, the recording was made with another {', '.join(unlikeness)}: "
            + ("within" if found.within_tolerance else "beyond")
            if unlikeness
            else "same version, model and processor: every bit should agree"
        )
    return text
