"""``teleop evaluate``: figures of the body tracker on people it never saw."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

NAMES = "people, motion, testers, steps, robustness, nobody, real, speed, memory"


def evaluate(
    report: Annotated[
        Path, typer.Option("--report", "--output", "-o", help="Folder for evaluation.md, figures.json and the plots.")
    ] = Path("evaluation"),
    model: Annotated[Path | None, typer.Option(help="Body model; default the shipped one.")] = None,
    frames: Annotated[
        int, typer.Option(min=10, max=100_000, help="Frames of a setting; the rest in proportion.")
    ] = 100,
    seed: Annotated[int, typer.Option(min=0, max=10_000, help="Another seed: other people, poses and rooms.")] = 0,
    only: Annotated[str, typer.Option(help=f"Sections, separated by commas: {NAMES}.")] = "all",
    plots: Annotated[bool, typer.Option("--plots/--no-plots", help="Draw the plots (needs the extra train).")] = True,
    kept: Annotated[
        Path | None, typer.Option(help="Folder where rendered frames are kept; default the user's cache.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, max=256, help="Processes that render; default all cores.")
    ] = None,
) -> None:
    """Parts, joints, precision, angles, ten testers, robustness, speed: on rendered people and real recordings.

    The first run renders its frames and keeps them; later runs read them.
    """
    import os

    from rich.console import Console
    from rich.progress import Progress

    from server.settings import load_settings
    from teleop.evaluation.store import FrameStore, default_folder
    from teleop.evaluation.suite import SECTIONS, evaluate_model

    names = list(SECTIONS) if only == "all" else [name.strip() for name in only.split(",") if name.strip()]
    if unknown := [name for name in names if name not in SECTIONS]:
        raise typer.BadParameter(f"--only does not know {', '.join(unknown)}; legal is {NAMES}")
    if plots:
        _need_matplotlib()
    store = FrameStore(kept or default_folder(), workers or os.cpu_count() or 1)
    with Progress(console=Console(stderr=True)) as bars:
        tasks: dict[str, int] = {}

        def progress(name: str, share: float) -> None:
            if name not in tasks:
                tasks[name] = bars.add_task(name, total=1.0)
            bars.update(bars.task_ids[tasks[name]], completed=share)

        result = evaluate_model(model, names, frames, store, progress, load_settings(None).teleop, seed)
    asked = f"teleop evaluate --frames {frames} --seed {seed}" + ("" if only == "all" else f" --only {only}")
    head = f"Made by `{asked}`; frames are drawn from their numbers: a second run gives the same figures but for times."
    path = result.write(report, head, plots=plots)
    typer.echo(path.read_text())
    typer.echo(f"written to {path}")


def _need_matplotlib() -> None:
    """Raises BadParameter before an hour of work, not after it."""
    from importlib.util import find_spec

    if find_spec("matplotlib") is None:
        raise typer.BadParameter("plots need matplotlib: pip install 'greenhouse-teleop[train]', or use --no-plots")
