"""``teleop study task-times`` and ``angle-errors``: rendered operators through the whole chain."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from server.cli.study import progress_bar

Operators = Annotated[int, typer.Option(min=1, max=10, help="How many of the ten operators of 165-190 cm.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the operators' errors and of the starts.")]
Size = Annotated[str, typer.Option(help="Sensor, pixels: 640x480 as the source's, 320x240 is four times as quick.")]
Workers = Annotated[int | None, typer.Option(min=1, help="Processes; one per core by default.")]


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{2,4})x(\d{2,4})", text)
    size = (int(match[1]), int(match[2])) if match else (0, 0)
    if not (160 <= size[0] <= 1280 and 120 <= size[1] <= 960):
        raise typer.BadParameter(
            f"'{text}': give WIDTHxHEIGHT from 160x120 to 1280x960, such as 640x480", param_hint="--size"
        )
    return size


def task_times(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for report, tables, plot, traces.")] = Path(
        "out/study_task_times"
    ),
    operators: Operators = 10,
    seed: Seed = 0,
    size: Size = "640x480",
    limit: Annotated[float, typer.Option(min=1.0, max=120.0, help="Seconds after which a trial has failed.")] = 20.0,
    workers: Workers = None,
) -> None:
    """Pick a cucumber, spray a square metre, pick with the robot's help: how long ten rendered operators take.

    The first two are the source's table 2. Images in, robot motion out; the operator sees only what the console shows,
    late. About a minute and a half for each operator.
    """
    from teleop.studies.task_times import SOURCE_S, WORDS, run_task_study

    pixels = _size(size)
    with progress_bar() as show:
        r = run_task_study(output, operators, seed, pixels, limit, workers, show)
    for f in r.figures:
        typer.echo(
            f"{WORDS[f.task]}: {f.succeeded} of {f.tried} succeed, mean {f.mean_s:.2f} s, "
            f"deviation {f.spread_s:.2f} s, longest {f.longest_s:.2f} s (source's mean {SOURCE_S[f.task]:.2f} s)"
        )
    for t in r.trials:
        if not t.success:
            typer.echo(f"tester {t.tester + 1}, {WORDS[t.task]}: {t.why}")
    typer.echo(str(r.page))


def angle_errors(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for report, tables, plot.")] = Path(
        "out/study_angle_errors"
    ),
    operators: Operators = 10,
    seed: Seed = 0,
    size: Size = "640x480",
    quick: Annotated[bool, typer.Option("--quick", help="Every third level only.")] = False,
    workers: Workers = None,
) -> None:
    """The person's true angle, the captured one, the one sent, the one the robot reached (source's figure 12)."""
    from teleop.studies.angle_errors import SOURCE_DEG, SOURCE_REACHED_DEG, WORDS, run_angle_study

    pixels = _size(size)
    with progress_bar() as show:
        r = run_angle_study(output, operators, seed, pixels, 3 if quick else 1, workers, progress=show)
    for c in r.curves:
        step = "" if c.movement.startswith("elbow") else f"; sent in the true step {c.same_step:.1%}"
        typer.echo(
            f"{WORDS[c.movement]}: captured less true at most {c.largest:.2f} deg (source {SOURCE_DEG[c.movement]:.2f})"
            f"{step}"
        )
    typer.echo(f"sent against reached, at rest: at most {r.reached_deg:.2f} deg (source {SOURCE_REACHED_DEG:.2f})")
    typer.echo(str(r.page))
