"""``teleop evaluate``: figures of the body tracker on people it never saw."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def evaluate(
    output: Annotated[Path, typer.Option(help="Folder for evaluation.md.")] = Path("evaluation"),
    model: Annotated[Path | None, typer.Option(help="Body model; default the shipped one.")] = None,
    frames: Annotated[int, typer.Option(min=10, max=100_000, help="Rendered frames per setting.")] = 300,
    every: Annotated[int, typer.Option(min=1, max=1000, help="Use every n-th real frame; the filter sees gaps.")] = 1,
    rooms: Annotated[bool, typer.Option("--rooms/--no-rooms", help="Also people in furnished rooms.")] = True,
) -> None:
    """Joint errors, average precision, angle errors and times, on rendered people and on real recordings."""
    from rich.console import Console
    from rich.progress import Progress

    from teleop.training.suite import run_suite

    with Progress(console=Console(stderr=True)) as bars:
        tasks: dict[str, int] = {}

        def progress(name: str, share: float) -> None:
            if name not in tasks:
                tasks[name] = bars.add_task(name, total=1.0)
            bars.update(bars.task_ids[tasks[name]], completed=share)

        text = run_suite(model, frames, every, rooms, progress)
    output.mkdir(parents=True, exist_ok=True)
    path = output / "evaluation.md"
    path.write_text(text)
    typer.echo(text)
    typer.echo(f"written to {path}")
