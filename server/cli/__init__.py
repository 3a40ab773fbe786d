"""The ``teleop`` command line: one module per command.

A command module imports only light things at its top, so that ``--help`` is quick; the heavy ones come inside.
Exit codes: 0 ok, 1 failed, 2 wrong usage. Errors a user can cause are one line on standard error.
"""

from __future__ import annotations

import sys

import typer

from server.cli.convert import convert
from server.cli.doctor import doctor
from server.cli.evaluate import evaluate
from server.cli.info import info
from server.cli.serve import serve
from server.cli.study import study_app
from server.cli.track import track
from server.cli.train import train

app = typer.Typer(
    name="teleop",
    help="Drive a three-arm greenhouse robot with your body in front of a depth camera.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (serve, track, info, convert, doctor, train, evaluate):
    app.command()(command)
app.add_typer(study_app, name="study")


def main() -> None:
    """Entry point of the console script."""
    from robot_sim.errors import RobotError
    from teleop.errors import TeleopError

    try:
        app()
    except (TeleopError, RobotError) as error:
        print(f"teleop: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print("teleop: interrupted", file=sys.stderr)
        sys.exit(130)
