"""``teleop serve``: the engine, the API and the console."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on. [default: 127.0.0.1]")] = None,
    port: Annotated[int | None, typer.Option(help="TCP port. [default: 8000]")] = None,
    source: Annotated[str | None, typer.Option(help="Recording, RGB-D folder or sensor URI to start with.")] = None,
    robot: Annotated[
        str | None, typer.Option(help="pybullet: or serial:PORT, a servo controller. [default: pybullet:]")
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(help="Run to play: pick_one, spray_square_metre, ..., or a TOML file of your own.")
    ] = None,
    loop: Annotated[bool | None, typer.Option("--loop/--no-loop", help="Start a recording again at its end.")] = None,
    record: Annotated[bool | None, typer.Option("--record/--no-record", help="Record the session.")] = None,
    foxglove: Annotated[
        bool | None, typer.Option("--foxglove/--no-foxglove", help="Open Foxglove's websocket, on this machine only.")
    ] = None,
    foxglove_port: Annotated[int | None, typer.Option(help="Its TCP port. [default: 8765]")] = None,
    tls_cert: Annotated[Path | None, typer.Option(help="PEM certificate chain: serve https.", metavar="FILE")] = None,
    tls_key: Annotated[Path | None, typer.Option(help="PEM private key of the certificate.", metavar="FILE")] = None,
    new_tokens: Annotated[
        bool, typer.Option("--new-tokens", help="Make new tokens for the three roles; the old ones and logins end.")
    ] = False,
    operator: Annotated[str | None, typer.Option(help="Profile of who drives; see 'teleop operators'.")] = None,
    log_format: Annotated[str | None, typer.Option(help="text, or json: one object a line. [default: text]")] = None,
    config: Annotated[Path | None, typer.Option(help="TOML file with settings.", metavar="FILE")] = None,
) -> None:
    """Serve the operator console and the API, and move the robot."""
    from rich.console import Console

    from server.logs import set_up_logs
    from server.runner import check_tls, listen
    from server.runner import serve as run
    from server.settings import Settings, load_settings, with_operator

    flags: dict[str, object] = {"host": host, "port": port, "source": source, "loop": loop, "record": record}
    flags |= {"tls_cert": tls_cert, "tls_key": tls_key, "log_format": log_format, "drives": robot}
    flags |= {"scenario": scenario}

    flags |= {"foxglove": foxglove, "foxglove_port": foxglove_port}

    def read() -> Settings:
        settings = load_settings(config, flags)
        return settings if operator is None else with_operator(settings, operator)

    settings = read()
    set_up_logs(settings.log_format)
    out = Console(highlight=False)
    errors = Console(stderr=True, highlight=False)
    check_tls(settings)
    if settings.is_public and settings.tls_cert is None:
        errors.print(
            f"[bold]warning:[/bold] {settings.host} can be reached from other computers, and tokens, pictures and "
            "commands travel in the clear; use --tls-cert and --tls-key, or a network that you trust",
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
            scheme = "http" if settings.tls_cert is None else "https"
            out.print(f"{scheme}://{host}:{settings.port}  {playing}  (Ctrl-C stops)", soft_wrap=True)
            if settings.foxglove:
                out.print(f"Foxglove: open a connection to ws://localhost:{settings.foxglove_port}", soft_wrap=True)

        def show(tokens: Mapping[str, str]) -> None:
            out.print("tokens, shown this once; clients on this machine need none to operate:")
            for role, token in tokens.items():
                out.print(f"  {role:<10} {token}", soft_wrap=True)

        run(read, listener, tell, show, new_tokens=new_tokens)
    out.print("stopped")
