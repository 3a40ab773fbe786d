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
def archive_progress(console: Console) -> Iterator[Callable[[int, int, int], None]]:
    """Yields a function to call with the recordings finished, the recordings in all, and the frames so far."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("tracking")

        def show(finished: int, total: int, frames: int) -> None:
            progress.update(task, completed=finished, total=total, description=f"tracking, {frames} frames")

        yield show
