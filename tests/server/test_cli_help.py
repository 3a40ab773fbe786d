"""Every command that is promised answers --help; wrong usage is one line and exit code 2."""

import subprocess
import sys

import pytest

PROMISED = ("serve", "track", "record", "replay", "convert", "export", "info", "train", "evaluate", "study", "doctor")


def teleop(*arguments: str) -> subprocess.CompletedProcess[str]:
    code = "from server.cli import main; main()"
    return subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize("command", PROMISED)
def test_help(command: str) -> None:
    run = teleop(command, "--help")
    assert run.returncode == 0, run.stderr
    assert "Usage" in run.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("fly",), "No such command 'fly'"),
        (("info",), "Missing argument 'source'"),
        (("serve", "--port", "high"), "--port"),
        (("track", "x.mcap", "--output", "y", "--sepia"), "--sepia"),
    ],
)
def test_wrong_usage(arguments: tuple[str, ...], words: str) -> None:
    run = teleop(*arguments)
    assert run.returncode == 2
    assert words in run.stderr
    assert "--help" in run.stderr
    assert len(run.stderr.strip().splitlines()) == 1
