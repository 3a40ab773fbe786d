"""``teleop study hands``: our hand rule against the source's on the same frames."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def hands(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for hands.md, hands.csv, hands.png.")] = Path(
        "out/study_hands"
    ),
    people: Annotated[int, typer.Option(min=5, max=100_000, help="Rendered people, two hands each.")] = 1200,
    tracker: Annotated[bool, typer.Option("--tracker/--no-tracker", help="Also with the tracker's own joints.")] = True,
    session: Annotated[bool, typer.Option("--session/--no-session", help="Also over the bundled recording.")] = True,
    webcam: Annotated[
        bool, typer.Option("--webcam/--no-webcam", help="Also on real photographs; trains a network per recording.")
    ] = True,
) -> None:
    """Hands of rendered people never seen: right and decided by skin, light, distance, orientation and wall."""
    from server.cli.progress import named_progress
    from teleop.body.model import load_model
    from teleop.body.tracker import BodyTracker
    from teleop.config import BodyConfig, TeleopConfig
    from teleop.hands.learning.cases import single_frame_tracker_config
    from teleop.hands.learning.photos import webcam_share
    from teleop.hands.learning.sessions import session_figures
    from teleop.hands.learning.study import run_study
    from teleop.pipeline import Pipeline

    config = TeleopConfig()
    with named_progress() as progress:
        still = moving = None
        if tracker:
            still = BodyTracker(load_model(), single_frame_tracker_config())
        if session:
            moving = Pipeline(BodyTracker(load_model(), BodyConfig()), config)
        text = run_study(
            output,
            people,
            still,
            webcam_share(progress) if webcam else None,
            None if moving is None else session_figures(moving),
            config.intent.hands,
            progress,
        )
    typer.echo(text)
    typer.echo(f"written to {output}")
