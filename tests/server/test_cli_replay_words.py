"""Wrong usage of ``teleop replay`` is one line."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_process import one_error_line, teleop, write_recording


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--console",), "--console goes with --config"),
        (("--verify", "--config", "x.toml"), "choose one"),
    ],
)
def test_options_that_do_not_go_together(tmp_path: Path, options: tuple[str, ...], words: str) -> None:
    line = one_error_line(teleop("replay", write_recording(tmp_path / "a.mcap", 2), *options), code=2)
    assert words in line
