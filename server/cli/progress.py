"""A progress bar over frames on standard error, shown only on a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from teleop.frames import DepthFrame


@contextmanager
def frame_progress(title: str, total: int | None) -> Iterator[Callable[[DepthFrame], None]]:
    """Yields a function to call after each frame; ``total`` None shows a count without an end."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(title, total=total)

        def advance(_frame: DepthFrame) -> None:
            progress.advance(task)

        yield advance


@contextmanager
def named_progress() -> Iterator[Callable[[str, float], None]]:
    """Yields a function to call with the name of a stage and its share done; every stage has a bar of its own."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, disable=not console.is_terminal) as bars:
        tasks: dict[str, int] = {}

        def show(name: str, share: float) -> None:
            if name not in tasks:
                tasks[name] = bars.add_task(name, total=1.0)
            bars.update(bars.task_ids[tasks[name]], completed=share)

        yield show


@contextmanager
def archive_progress(console: Console) -> Iterator[Callable[[int, int, int], None]]:
    """Yields a function to call with the recordings finished, the recordings in all, and the frames so far."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("tracking")

        def show(finished: int, total: int, frames: int) -> None:
            progress.update(task, completed=finished, total=total, description=f"tracking, {frames} frames")

        yield show
