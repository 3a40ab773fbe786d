"""``teleop train``: make the body model from seeds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def train(
    output: Annotated[Path, typer.Option(help="Model file; CARD.md is written beside it.")] = Path("body.npz"),
    frames: Annotated[int, typer.Option(min=200, max=10_000_000, help="Rendered frames.")] = 160_000,
    forest_frames: Annotated[
        int, typer.Option(min=200, max=10_000_000, help="The first of them, from which the forest is grown.")
    ] = 24_000,
    steps: Annotated[
        float, typer.Option(min=0.0001, max=100, help="Share of the networks' training steps, for a quick trial.")
    ] = 1.0,
    trees: Annotated[int, typer.Option(min=1, max=16, help="Trees of the forest.")] = 3,
    candidates: Annotated[int, typer.Option(min=10, max=10000, help="Features tried at a node.")] = 150,
    seed: Annotated[int, typer.Option(min=0, help="Seed of every draw.")] = 2011,
    work: Annotated[
        Path, typer.Option(help="Folder of rendered frames and finished stages; a second run goes on from it.")
    ] = Path("training-frames"),
    workers: Annotated[
        int | None, typer.Option(min=1, max=256, help="Processes that render; default all cores.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Render on a Dask cluster instead, such as tcp://host:8786.")
    ] = None,
) -> None:
    """Render people, train the networks, grow the forest, fit on validation frames; write model and card."""
    from rich.console import Console
    from rich.progress import Progress

    from teleop.training.build import BuildSpec
    from teleop.training.recipe import Recipe, shortened, train_model
    from teleop.training.trainer import TreeSpec

    recipe = shortened(
        Recipe(
            frames=frames,
            forest_frames=min(forest_frames, frames),
            seed=seed,
            workers=workers,
            scheduler=scheduler,
            build=BuildSpec(trees=trees, tree=TreeSpec(candidates=candidates)),
        ),
        steps,
    )
    with Progress(console=Console(stderr=True)) as bars:
        tasks: dict[str, int] = {}

        def progress(name: str, share: float) -> None:
            if name not in tasks:
                tasks[name] = bars.add_task(name, total=1.0)
            bars.update(bars.task_ids[tasks[name]], completed=share)

        model = train_model(recipe, work, output, progress)
    typer.echo(
        f"{output}: {len(model.roots)} trees, {100 * model.meta['joints_within_10cm']:.1f} % of the visible joints "
        f"within 10 cm on unseen validation frames; card in {output.with_name('CARD.md')}"
    )
