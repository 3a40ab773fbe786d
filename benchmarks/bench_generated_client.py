"""A client generated from the OpenAPI document by openapi-python-client, in an environment of its own, and used."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

from rich.console import Console

from benchmarks.bench_chain import server, session

GENERATOR = "openapi-python-client==0.29.1"
_USE = """
import sys
sys.path.insert(0, sys.argv[1])
from greenhouse_teleoperation_client import Client
from greenhouse_teleoperation_client.api.operation import read_health, read_state
from greenhouse_teleoperation_client.api.robot import command_robot
from greenhouse_teleoperation_client.models import Accepted, Health, Problem, RobotAsk, State
with Client(base_url=sys.argv[2]) as client:
    assert isinstance(read_health.sync(client=client), Health)
    state = read_state.sync(client=client)
    assert isinstance(state, State) and state.robot.base is not None
    assert isinstance(command_robot.sync(client=client, body=RobotAsk(lift_m=0.1)), Accepted)
    refused = command_robot.sync(client=client, body=RobotAsk(lift_m=0.9))
    assert isinstance(refused, Problem) and "legal" in refused.detail
print("used: health, state, a command, a refusal")
"""


def main() -> bool:
    """Print how many operations were generated; raises CalledProcessError when generator or client fail."""
    out = Console()
    with tempfile.TemporaryDirectory(prefix="teleop-client-") as name, server(session()) as (port, _):
        folder = Path(name)
        url = f"http://127.0.0.1:{port}"
        with urllib.request.urlopen(f"{url}/openapi.json") as reply:
            document = json.load(reply)
        (folder / "openapi.json").write_text(json.dumps(document))
        subprocess.run([sys.executable, "-m", "venv", folder / "env"], check=True)
        python = folder / "env" / "bin" / "python"
        subprocess.run([python, "-m", "pip", "install", "-q", "--disable-pip-version-check", GENERATOR], check=True)
        command = [python.with_name("openapi-python-client"), "generate", "--path", folder / "openapi.json"]
        made = subprocess.run(
            [*command, "--meta", "none", "--output-path", folder / "out" / "greenhouse_teleoperation_client"],
            check=True,
            capture_output=True,
            text=True,
            cwd=folder,
            env={"PATH": str(python.parent)},
        )
        warnings = [line for line in (made.stdout + made.stderr).splitlines() if "WARNING" in line or "Unable" in line]
        files = list((folder / "out").rglob("api/*/*.py"))
        out.print(f"{len([f for f in files if f.name != '__init__.py'])} operations, {len(warnings)} warnings")
        for line in warnings:
            out.print(line)
        subprocess.run([python, "-c", _USE, str(folder / "out"), url], check=True)
    return not warnings


if __name__ == "__main__":
    main()
