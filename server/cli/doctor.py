"""``teleop doctor``: what works here, what is missing for each kind of source, and how to get it."""

from __future__ import annotations

from typing import Annotated

import typer


def doctor(
    host: Annotated[str, typer.Option(help="Address the server would listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port the server would listen on.")] = 8000,
    source: Annotated[
        str | None, typer.Option(metavar="URI", help="Try this source, too: open it and read frames for three seconds.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON list instead of a table.")] = False,
) -> None:
    """Check this machine; exit code 0 when the basics work, sensors or not."""
    from server.cli.check import Status
    from server.cli.checks import basics, sensors
    from server.cli.service_checks import service

    checks = basics(host, port) + service() + sensors()
    if source is not None:
        from server.cli.try_source import try_source

        checks.append(try_source(source))
    if as_json:
        import json
        from dataclasses import asdict

        typer.echo(json.dumps([asdict(check) for check in checks], indent=1))
    else:
        from rich.console import Console
        from rich.markup import escape
        from rich.table import Table

        style = {Status.OK: "green", Status.MISSING: "yellow", Status.FAILED: "bold red"}
        table = Table("check", "status", "found", "next step")
        for c in checks:
            row = (escape(c.name), f"[{style[c.status]}]{c.status}[/]", escape(c.found), escape(c.next_step))
            table.add_row(*row)
        Console().print(table)
    if any(check.status is Status.FAILED for check in checks):
        raise typer.Exit(1)
