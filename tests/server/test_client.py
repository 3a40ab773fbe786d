"""The Python client, blocking and asynchronous, against the real server."""

from __future__ import annotations

import asyncio
import inspect
import subprocess
import sys
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from live_server import TOKEN, running, write_walk

from server import wire
from server.access.roles import Role
from server.client import AsyncTeleopClient, Jpeg, TeleopClient, columns
from server.client.link import Link
from server.errors import Refused, ServerError


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with running(tmp_path_factory.mktemp("client")) as (url, _):
        with TeleopClient(url) as robot:
            robot.open("walk", loop=True)
            robot.release_lease()
        yield url


def test_both_clients_have_the_same_methods() -> None:
    def methods(kind: type) -> dict[str, list[str]]:
        found = inspect.getmembers(kind, inspect.isfunction)
        return {name: list(inspect.signature(f).parameters) for name, f in found if not name.startswith("_")}

    assert methods(TeleopClient) == methods(AsyncTeleopClient) and len(methods(TeleopClient)) > 30


def test_the_client_loads_no_robot_and_no_tracker() -> None:
    code = "import server.client, sys; print([m for m in ('pybullet', 'numba', 'cv2', 'fastapi') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


def test_states_become_columns(url: str) -> None:
    with TeleopClient(url) as robot:
        table = columns(islice((s for s in robot.states() if s.skeleton is not None), 5))
    assert {len(column) for column in table.values()} == {5}
    assert table["t"].dtype == np.float64 and table["engaged"].dtype == bool
    assert np.isfinite(table["theta3_right"]).any() and set(table["zone"]) <= {"work", "none", "forward", "back", "out"}


def test_a_notebook_shows_client_state_and_picture(url: str) -> None:
    with TeleopClient(url, name="<b>Anna</b>") as robot:
        assert "&lt;b&gt;Anna" in robot._repr_html_() and "in control" in robot._repr_html_()
        state, picture = robot.state(), robot.head_jpeg()
        assert "walk at" in state._repr_html_()
        assert isinstance(picture, Jpeg) and "base64,/9j/" in picture._repr_html_()
        assert repr(robot) == f"TeleopClient('{url}')" and "bytes" in repr(picture)


def test_one_commands_and_hands_over(url: str) -> None:
    with TeleopClient(url, name="Anna") as anna, TeleopClient(url, name="Ben") as ben:
        assert anna.request_lease().holds_lease
        anna.command(lift_m=0.1)
        with pytest.raises(Refused, match="Anna is in control") as refused:
            ben.command(lift_m=0.2)
        assert (refused.value.status, refused.value.code) == (423, "lease")
        asking = ben.request_lease().lease.requests
        anna.deny_lease(asking[0].id)
        asking = ben.request_lease().lease.requests
        assert not anna.grant_lease(asking[0].id).holds_lease and ben.access().holds_lease
        with TeleopClient(url, token=TOKEN[Role.SUPERVISOR], name="Eve") as eve:
            assert eve.take_lease().holds_lease
            eve.release_lease()


def test_a_wrong_token_is_refused_on_both_ways(url: str) -> None:
    with TeleopClient(url, token="wrong") as robot:
        with pytest.raises(Refused, match="not known here") as refused:
            robot.state()
        assert refused.value.status == 401
        with pytest.raises(Refused, match="not known here"):
            next(robot.states())


def test_recordings_and_any_route(url: str, tmp_path: Path) -> None:
    path = write_walk(tmp_path / "mine.mcap", 5)
    with TeleopClient(url) as robot:
        assert robot.upload(path).id == "mine"
        robot.download("mine", tmp_path / "back.mcap")
        assert (tmp_path / "back.mcap").read_bytes() == path.read_bytes()
        robot.delete_recording("mine")
        with pytest.raises(Refused, match="no recording 'mine'"):
            robot.download("mine", tmp_path / "again.mcap")
        assert robot.request("GET", "/health")["status"] in ("ok", "degraded")
        assert robot.health().source == "walk" and robot.jobs() == []
        with pytest.raises(Refused, match="no job"):
            robot.wait("none")


def test_the_same_awaited(url: str) -> None:
    async def use() -> None:
        async with AsyncTeleopClient(url, name="async") as robot:
            seen = 0
            async for state in robot.states():
                assert isinstance(state, wire.State)
                if (seen := seen + 1) == 3:
                    break
            assert (await robot.request_lease()).holds_lease
            assert (await robot.pause()).paused and not (await robot.play()).paused
            await robot.estop()
            async for message in robot.messages():
                if isinstance(message, wire.State) and message.robot.estop:
                    break
            await robot.estop_reset()
            await robot.release_lease()
            assert "<robot" in await robot.urdf()
        async with AsyncTeleopClient(url, token="wrong") as stranger:
            with pytest.raises(Refused, match="not known here"):
                await stranger.access()

    asyncio.run(use())


def test_a_stream_that_was_cut_off_goes_on_where_it_was() -> None:
    link = Link("http://robot/", token="t", name="Rósa")
    assert link.stream_url == "ws://robot/api/v1/stream?"
    assert link.headers["X-Teleop-Name"] == "R%C3%B3sa" and link.headers["Authorization"] == "Bearer t"
    link.boot, link.last_event = "first", 3
    link.read(wire.EventMessage(id=7, t=1.0, kind="a", reason="b").model_dump_json())
    assert link.stream_url.endswith("?boot=first&after=7")


def test_nobody_there_is_one_line() -> None:
    with TeleopClient("http://127.0.0.1:9") as robot:
        for ask in (robot.state, lambda: next(robot.states())):
            with pytest.raises(ServerError, match="teleop serve"):
                ask()
