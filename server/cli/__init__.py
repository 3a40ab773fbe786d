"""The ``teleop`` command line: one module per command.

A command module imports only light things at its top, so that ``--help`` is quick; the heavy ones come inside.
Exit codes: 0 ok, 1 failed, 2 wrong usage. Errors a user can cause are one line on standard error.
"""

from __future__ import annotations

import sys
from typing import Any

import typer

from server.cli.convert import convert
from server.cli.doctor import doctor
from server.cli.evaluate import evaluate
from server.cli.export import export
from server.cli.info import info
from server.cli.operators import operators_app
from server.cli.push import push
from server.cli.record import record
from server.cli.replay import replay
from server.cli.serve import serve
from server.cli.study import study_app
from server.cli.study_hands import hands
from server.cli.study_operators import angle_errors, task_times
from server.cli.track import track
from server.cli.train import train
from server.cli.train_hands import train_hands

_UsageError: Any = typer.BadParameter.__mro__[1]
"""The base of all wrong usage; typer exports only its most common case."""

app = typer.Typer(
    name="teleop",
    help="Drive a three-arm greenhouse robot with your body in front of a depth camera.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (serve, track, record, replay, push, convert, export, info, doctor, train, train_hands, evaluate):
    app.command()(command)
study_app.command()(hands)
study_app.command("task-times")(task_times)
study_app.command("angle-errors")(angle_errors)
app.add_typer(study_app, name="study")
app.add_typer(operators_app, name="operators")


def main() -> None:
    """Entry point of the console script."""
    from robot_sim.errors import RobotError
    from teleop.errors import TeleopError

    try:
        sys.exit(app(standalone_mode=False))
    except (TeleopError, RobotError) as error:
        print(f"teleop: {error}", file=sys.stderr)
        sys.exit(1)
    except _UsageError as error:
        command = error.ctx.command_path if error.ctx else "teleop"
        if message := error.format_message().rstrip("."):  # empty: the help is already on the screen
            print(f"teleop: {message}; see {command} --help", file=sys.stderr)
        sys.exit(2)
    except (KeyboardInterrupt, typer.Abort):
        print("teleop: interrupted", file=sys.stderr)
        sys.exit(130)
