"""Makes the bundled recording: ``python -m teleop.people.demo_recording --output recordings/greenhouse_demo.mcap``.

A rendered MakeHuman person acts the demonstration; the truth goes beside it as ``.truth.jsonl``.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import track

from teleop.config.recording import RecordingConfig
from teleop.errors import TeleopError
from teleop.people.performance import Performance
from teleop.people.story import greenhouse_story
from teleop.people.truth import truth_row
from teleop.recording import McapWriter
from teleop.sources.virtual_options import parse_options


def make(output: Path, seed: int, size: str, fps: int, jpeg_quality: int) -> None:
    """Write the recording and its truth. Raises RecordingError, DataError or SourceError."""
    options = parse_options(f"makehuman,seed={seed},size={size},fps={fps}")
    motion, chapters = greenhouse_story(seed)
    performance = Performance(options.stage(), motion, float(fps))
    metadata = {"story": "greenhouse", "seed": str(seed), "person": "MakeHuman base mesh (CC0), rendered"}
    writer = McapWriter(
        output,
        performance.camera,
        source_uri=options.uri,
        metadata=metadata,
        config=RecordingConfig(jpeg_quality=jpeg_quality, compression_level=19),
    )
    truth = output.with_suffix(".truth.jsonl")
    with writer, truth.open("w", encoding="utf-8") as rows:
        for number in track(range(performance.frame_count), "Rendering", disable=not sys.stderr.isatty()):
            take = performance.take(number)
            writer.write_frame(take.frame)
            rows.write(json.dumps(truth_row(take, chapters, performance.view), separators=(",", ":")) + "\n")


def main(
    output: Annotated[Path, typer.Option(help="The .mcap to write; must not exist yet.")],
    seed: Annotated[int, typer.Option(help="Of sway, folds, plants and noise.")] = 1,
    size: Annotated[str, typer.Option(help="Image size, WxH.")] = "320x240",
    fps: Annotated[int, typer.Option(help="Frames per second.")] = 20,
    jpeg_quality: Annotated[int, typer.Option(min=1, max=100, help="Of the colour images.")] = 85,
) -> None:
    """Render the bundled recording."""
    try:
        make(output, seed, size, fps, jpeg_quality)
    except TeleopError as error:
        typer.echo(f"error: {error}", err=True)
        raise typer.Exit(1) from error


if __name__ == "__main__":
    typer.run(main)
