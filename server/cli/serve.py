"""``teleop serve``: the engine, the API and the console."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on. [default: 127.0.0.1]")] = None,
    port: Annotated[int | None, typer.Option(help="TCP port. [default: 8000]")] = None,
    source: Annotated[str | None, typer.Option(help="Recording, RGB-D folder or sensor URI to start with.")] = None,
    loop: Annotated[bool | None, typer.Option("--loop/--no-loop", help="Start a recording again at its end.")] = None,
    record: Annotated[bool | None, typer.Option("--record/--no-record", help="Record the session.")] = None,
    config: Annotated[Path | None, typer.Option(help="TOML file with settings.", metavar="FILE")] = None,
) -> None:
    """Serve the operator console and the API, and move the robot."""
    from rich.console import Console

    from server.runner import listen
    from server.runner import serve as run
    from server.settings import load_settings

    flags = {"host": host, "port": port, "source": source, "loop": loop, "record": record}
    settings = load_settings(config, flags)
    out = Console(highlight=False)
    errors = Console(stderr=True, highlight=False)
    if settings.is_public:
        errors.print(
            f"[bold]warning:[/bold] {settings.host} can be reached from other computers, and there is no "
            "authentication yet: anybody in the network can drive the robot",
            soft_wrap=True,
        )
    listener = listen(settings)
    with listener, out.status("starting") as status:

        def tell(step: str) -> None:
            if step:
                status.update(step)
                return
            status.stop()
            host = f"[{settings.host}]" if ":" in settings.host else settings.host
            playing = f"source {settings.source}" if settings.source else "no source yet"
            out.print(f"http://{host}:{settings.port}  {playing}  (Ctrl-C stops)", soft_wrap=True)

        run(settings, listener, tell)
    out.print("stopped")
