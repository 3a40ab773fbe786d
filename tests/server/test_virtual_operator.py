"""The rendered operator driven over the API, seen by the tracker."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from live_server import running

from server import wire
from server.client import TeleopClient
from server.errors import Refused


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TeleopClient]:
    with running(tmp_path_factory.mktemp("virtual")) as (url, _), TeleopClient(url) as client:
        yield client


def until(client: TeleopClient, true: Callable[[wire.State], Any]) -> wire.State:
    end_s = time.monotonic() + 120.0
    while time.monotonic() < end_s:
        if true(state := client.state()):
            return state
        time.sleep(0.05)
    raise AssertionError(f"it never came true: {state}")


def test_no_one_is_driven_before_they_are_opened(client: TeleopClient) -> None:
    with pytest.raises(Refused, match="virtual:live") as refusal:
        client.drive_virtual(x_m=0.1)
    assert refusal.value.status == 409


def test_they_are_seen_where_they_are_told_to_go(client: TeleopClient) -> None:
    session = client.open("virtual:live,fps=15")
    assert (session.live, session.kind) == (True, "virtual")
    until(client, lambda s: s.spine_xz and abs(s.spine_xz[0]) < 0.1)
    told = client.drive_virtual(x_m=0.6, z_m=2.6, right={"side_deg": 60.0})
    assert (told.x_m, told.z_m, told.right.side_deg, told.right.hand) == (0.6, 2.6, 60.0, "relaxed")
    until(client, lambda s: s.spine_xz and abs(s.spine_xz[0] - 0.6) < 0.1 and abs(s.spine_xz[1] - 2.6) < 0.1)
    until(client, lambda s: (s.angles.theta1_right or 0.0) > 45.0)
    assert client.drive_virtual() == told, "nothing asks what they were told"
    client.close_session(session.id)


@pytest.mark.parametrize("change", [{"z_m": 9.0}, {"wings": 2}, {"right": {"side_deg": "up"}}])
def test_what_no_person_does_is_refused(client: TeleopClient, change: dict[str, Any]) -> None:
    with pytest.raises(Refused) as refusal:
        client.drive_virtual(**change)
    assert refusal.value.status == 422


def test_scripts_are_files_and_named_on_the_command_line_only(client: TeleopClient, tmp_path: Path) -> None:
    with pytest.raises(Refused) as refusal:
        client.open(f"virtual:script={tmp_path / 'acts.toml'}")
    assert refusal.value.status == 403
