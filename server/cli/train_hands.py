"""``teleop train-hands``: make the hand model from seeds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def train_hands(
    output: Annotated[Path, typer.Option(help="Model file; HANDS.md is written beside it.")] = Path("hands.npz"),
    people: Annotated[int, typer.Option(min=50, max=100_000, help="Rendered people, two hands each.")] = 20_000,
    validation: Annotated[int, typer.Option(min=20, max=10_000, help="Other rendered people to calibrate on.")] = 1000,
    epochs: Annotated[int, typer.Option(min=1, max=500, help="Passes over the hands.")] = 48,
    seed: Annotated[int, typer.Option(min=0, help="Seed of every draw.")] = 7,
) -> None:
    """Render hands, train three small networks (depth and colour, depth, colour), calibrate, write model and card."""
    from server.cli.progress import named_progress
    from teleop.hands.learning.recipe import HandRecipe
    from teleop.hands.learning.recipe import train_hands as run

    with named_progress() as progress:
        figures = run(HandRecipe(people, validation, epochs, seed), output, progress)
    right = ", ".join(f"{sight} {100 * share:.1f} %" for sight, share in figures.right.items())
    typer.echo(f"{output}: {figures.hands} hands; right on unseen rendered hands: {right}; card in HANDS.md")
