"""What long jobs do with a recording: export it, track it anew, do it again and compare. Run in a job's process."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

from server.job_process import Report
from server.quiet import quiet_output
from teleop.config import TeleopConfig
from teleop.frames import DepthFrame
from teleop.recording import McapSource
from teleop.sources.base import Source


def export(path: Path, output: Path, config: TeleopConfig, report: Report) -> Mapping[str, Any]:
    """Into the file or folder that ``output`` names; a folder is packed as NAME.zip. Raises TeleopError."""
    from server.cli.export_run import export_to

    with closing(McapSource(path)) as source:
        count = export_to(output, source, config, _counted(source, report))
    if output.is_dir():
        packed = shutil.make_archive(str(output), "zip", output.parent, output.name)
        shutil.rmtree(output)
        output = Path(packed)
    return {"frames": count, "file": output.name, "bytes": output.stat().st_size}


def track(path: Path, output: Path, config: TeleopConfig, report: Report) -> Mapping[str, Any]:
    """Rows of ``teleop track`` into a JSON-lines file, the operator taken as engaged. Raises TeleopError."""
    from server.cli.track_run import rows, whole_rows
    from teleop.body.model import load_model
    from teleop.body.tracker import BodyTracker
    from teleop.pipeline import Pipeline

    times_ms: list[float] = []
    persons = 0
    with closing(McapSource(path)) as source, whole_rows(output) as file:
        advance = _counted(source, report)
        pipeline = Pipeline(BodyTracker(load_model(), config.body), config)
        for row in rows(source, pipeline, times_ms):
            file.write(json.dumps(row, allow_nan=False, separators=(",", ":")) + "\n")
            persons += any(row["joints"].values())  # type: ignore[attr-defined]
            advance(None)
    return {"frames": len(times_ms), "persons": persons, "file": output.name, "bytes": output.stat().st_size}


def again(path: Path, change: Mapping[str, Any] | None, report: Report) -> Mapping[str, Any]:
    """The session once more, as recorded or with other settings, held against what was recorded. Raises TeleopError."""
    from server.cli.replay_words import lines, whatif_lines
    from teleop.body.model import load_model

    with quiet_output():
        from server.cli.replay_run import compare, unlike  # loading PyBullet prints

    with closing(McapSource(path)) as source:
        model = load_model()
        unlikeness = unlike(source, model)
        found = compare(source, model, change, _counted(source, report))
    return {
        "frames": found.frames,
        "differing": found.differing,
        "identical": found.identical,
        "ok": change is not None or found.identical or (bool(unlikeness) and found.within_tolerance),
        "unlike": unlikeness,
        "lines": lines(found, unlikeness) if change is None else whatif_lines(found),
    }


def _counted(source: Source, report: Report) -> Callable[[DepthFrame | None], None]:
    total, count = source.info.frame_count or 1, 0

    def advance(_frame: DepthFrame | None) -> None:
        nonlocal count
        count += 1
        report(min(1.0, count / total))

    return advance
