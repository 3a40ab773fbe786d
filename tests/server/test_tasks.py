"""Assisted picks over the API and the client: the running server, its lease, its recording."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import httpx
import pytest
from fastapi.testclient import TestClient
from live_server import TOKEN, frames, prepared, running, tracker

from robot_sim.world import World
from server import wire
from server.access.roles import Role
from server.cli.replay_run import compare
from server.cli.replay_words import lines
from server.client import AsyncTeleopClient, TeleopClient
from server.engine.core import Core
from server.engine.engine import Engine
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived
from server.engine.recording import SessionRecorder, describe
from server.errors import Refused
from server.settings import Settings
from teleop.body.model import load_model
from teleop.inputs import PickAsk
from teleop.recording import McapSource, topics
from teleop.sources.base import SourceInfo
from teleop.sources.jpeg import through_jpeg

T = TypeVar("T")
NEAR = "cucumber_2_fruit_0"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Engine]]:
    with running(tmp_path_factory.mktemp("tasks")) as (url, engine):
        yield url, engine


@pytest.fixture
def robot(server: tuple[str, Engine]) -> Iterator[TeleopClient]:
    with TeleopClient(server[0]) as client:
        client.estop_reset()
        client.request("POST", "/run/reset")
        yield client
        for task in client.tasks():
            if task.ended is None:
                client.cancel(task.id)
        client.release_lease()


def until(what: str, ask: Callable[[], T | None], timeout_s: float = 60.0) -> T:
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        if (answer := ask()) is not None:
            return answer
        time.sleep(0.03)
    raise AssertionError(f"not in time: {what}")


def at_stage(robot: TeleopClient, task: wire.TaskState, stage: str) -> wire.TaskState:
    def look() -> wire.TaskState | None:
        now = robot.task(task.id)
        assert now.ended is None, now
        return now if now.stage == stage else None

    return until(stage, look)


def test_the_nearest_ripe_fruit_ends_in_the_box(robot: TeleopClient) -> None:
    task = robot.pick()
    assert (task.status, task.attended, task.ripe) == ("running", False, True)
    shares = [task.progress]
    while (now := robot.task(task.id)).ended is None:
        shares.append(now.progress)
    assert (now.status, now.reason, now.progress, now.stage) == ("succeeded", "assist.done", 1.0, "box")
    assert shares == sorted(shares) and len(set(shares)) > 5
    assert now.started is not None and now.created <= now.started < now.ended
    fruit = {f.name: f for f in robot.fruits()}[task.fruit]
    assert (fruit.status, fruit.damaged, fruit.ripe) == ("boxed", False, True)
    run = robot.request("GET", "/run")
    assert (run["picked"], run["cut"], run["dropped"], run["damaged"], run["arm_contacts"]) == (1, 1, 0, 0, 0)


def test_a_preview_is_told_waits_and_is_confirmed_once(robot: TeleopClient, server: tuple[str, Engine]) -> None:
    async def follow() -> list[wire.TaskPreview | wire.EventMessage]:
        told: list[wire.TaskPreview | wire.EventMessage] = []
        async with AsyncTeleopClient(server[0]) as watching:
            async for message in watching.messages():
                if isinstance(message, wire.TaskPreview | wire.EventMessage):
                    told.append(message)
                if isinstance(message, wire.State) and message.task is not None and message.task.stage == "approach":
                    return told
        return told

    task = robot.pick(NEAR, preview=True)
    assert (task.status, task.stage, task.confirmed) == ("preview", None, False)
    before = robot.state().robot.joints
    time.sleep(0.4)
    assert robot.state().robot.joints == pytest.approx(before, abs=0.01), "nothing moves"
    again = robot.pick(NEAR)
    assert again.id == task.id, "the same fruit is the same task"
    assert httpx.post(f"{server[0]}/api/v1/tasks/pick", json={"fruit": NEAR}).status_code == 200
    assert robot.confirm(task.id).status == "running"
    assert robot.confirm(task.id).status == "running", "twice does no harm"
    told = asyncio.run(follow())
    preview = next(m for m in told if isinstance(m, wire.TaskPreview) and m.to_fruit)
    fruit = next(f for f in robot.fruits() if f.name == NEAR)
    assert preview.fruit == NEAR and len(preview.to_box) > 5
    assert preview.to_fruit[-1] == pytest.approx(preview.to_box[0], abs=0.02)
    assert preview.to_fruit[-1][:2] == pytest.approx(fruit.xyz_m[:2], abs=0.03)
    assert "assist.preview" in [m.reason for m in told if isinstance(m, wire.EventMessage)]


def test_what_cannot_be_picked_says_what_to_do_and_doing_it_helps(robot: TeleopClient) -> None:
    task = robot.pick("cucumber_4_fruit_0")
    assert (task.status, task.reason) == ("refused", "pick.out_of_reach") and task.ended is not None
    assert task.forward_m is not None and f"drive {task.forward_m:.2f} m forward" in task.detail
    goal_m = robot.state().robot.base.x + task.forward_m
    while (left_m := goal_m - robot.state().robot.base.x) > 0.03:
        robot.command(drive_m_s=min(0.5, 0.1 + left_m), for_s=0.1)
        time.sleep(0.05)
    until("it stands", lambda: True if abs(robot.state().robot.drive_m_s) < 0.01 else None)
    assert robot.pick("cucumber_4_fruit_0").status == "running"


def test_names_that_do_not_exist_are_404_and_bodies_that_make_no_sense_422(robot: TeleopClient) -> None:
    with pytest.raises(Refused, match="GET /api/v1/fruits") as refused:
        robot.pick("melon")
    assert (refused.value.status, refused.value.code) == (404, "fruit")
    for call in (robot.task, robot.confirm, robot.cancel):
        with pytest.raises(Refused, match="no task 'nothing'"):
            call("nothing")
    with pytest.raises(Refused) as refused:
        robot.request("POST", "/tasks/pick", {"fruit": NEAR, "speed": 3})
    assert refused.value.status == 422


def test_cancelling_stops_the_robot_where_it_is_and_twice_does_no_harm(robot: TeleopClient) -> None:
    task = at_stage(robot, robot.pick(NEAR), "approach")
    ended = robot.cancel(task.id)
    assert (ended.status, ended.reason) == ("taken_over", "assist.cancelled")
    assert robot.cancel(task.id) == ended
    with pytest.raises(Refused, match="has ended") as refused:
        robot.confirm(task.id)
    assert refused.value.status == 409
    time.sleep(0.3)
    before = robot.state().robot.joints
    time.sleep(0.3)
    assert robot.state().robot.joints == pytest.approx(before, abs=1e-3)


def test_the_emergency_stop_and_a_command_of_ones_own_take_over(robot: TeleopClient) -> None:
    task = at_stage(robot, robot.pick(NEAR), "approach")
    robot.estop()
    stopped = until("it ended", lambda: now if (now := robot.task(task.id)).ended else None)
    assert (stopped.status, stopped.reason) == ("taken_over", "stop.estop")
    refused = robot.pick(NEAR)
    assert (refused.status, refused.reason) == ("refused", "stop.estop")
    robot.estop_reset()
    task = at_stage(robot, robot.pick(NEAR), "approach")
    robot.command(lift_m=0.3)
    stopped = until("it ended", lambda: now if (now := robot.task(task.id)).ended else None)
    assert (stopped.status, stopped.reason) == ("taken_over", "assist.request")


def test_another_fruit_is_refused_while_one_is_picked(robot: TeleopClient) -> None:
    task = robot.pick(NEAR)
    busy = robot.pick("cucumber_1_fruit_0")
    assert (busy.status, busy.reason) == ("refused", "refused.assist_busy") and NEAR in busy.detail
    assert [t.id for t in robot.tasks()][:2] == [busy.id, task.id] and robot.task(busy.id) == busy
    shown = robot.state().task
    assert shown is not None and shown.id == task.id


def test_a_pick_ends_with_the_lease_of_who_began_it(robot: TeleopClient) -> None:
    task = at_stage(robot, robot.pick(NEAR), "approach")
    robot.release_lease()
    ended = until("it ended", lambda: now if (now := robot.task(task.id)).ended else None)
    assert (ended.status, ended.reason) == ("taken_over", "assist.lease_lost")


def test_a_reset_of_the_robot_cuts_a_pick_off(robot: TeleopClient) -> None:
    task = at_stage(robot, robot.pick(NEAR), "approach")
    robot.request("POST", "/run/reset")
    ended = until("it ended", lambda: now if (now := robot.task(task.id)).ended else None)
    assert (ended.status, ended.reason) == ("cancelled", "assist.restarted")


def test_the_asynchronous_client_picks_too(robot: TeleopClient, server: tuple[str, Engine]) -> None:
    robot.release_lease()

    async def pick() -> wire.TaskState:
        async with AsyncTeleopClient(server[0]) as client:
            task = await client.pick(NEAR)
            ended = await client.ended(task.id)
            await client.release_lease()
            return ended

    assert asyncio.run(pick()).status == "succeeded"


def test_a_viewer_sees_tasks_and_begins_none(tmp_path: Path) -> None:
    elsewhere = {"base_url": "http://127.0.0.1:8000", "client": ("192.0.2.7", 50000)}
    with prepared(tmp_path) as (app, _), TestClient(app, **elsewhere) as api:  # type: ignore[arg-type]
        viewer = {"Authorization": f"Bearer {TOKEN[Role.VIEWER]}", "X-Teleop-Client": "v" * 16}
        assert api.get("/api/v1/tasks", headers=viewer).json() == []
        assert api.get("/api/v1/fruits", headers=viewer).status_code == 200
        assert api.post("/api/v1/tasks/pick", headers=viewer).status_code == 403
        assert api.post("/api/v1/tasks/pick").status_code == 401


def test_a_recorded_pick_replays_bit_for_bit(tmp_path: Path) -> None:
    path, settings = tmp_path / "pick.mcap", Settings()
    now_s = 10.0
    world, body = World(settings.robot), tracker(settings)
    info = SourceInfo("push:", "push", frames()[0].camera, live=True, has_color=True)
    described = describe(settings, body.model, world)
    recorder = SessionRecorder(path, info, world.urdf, lambda _: None, described, lossless=True)
    core = Core(body, world, settings, Ledger(10), lambda: now_s)
    core.forget(reset_robot=True)
    asks = {
        2: (PickAsk("a", fruit="cucumber_1_fruit_0", preview=True),),
        6: (PickAsk("a", "cancel"), PickAsk("b", fruit=NEAR, preview=True)),
        9: (PickAsk("b", "confirm"),),
    }
    stages = set()
    for i, frame in enumerate(frames()[:45]):
        now_s += 0.1
        core.pending.picks += asks.get(i, ())
        told = through_jpeg(frame)
        recorder.receive(told)
        moment = core.on_frame(Arrived(told, now_s - 0.004, 0.0), live=True, speed=1.0)
        recorder.write(moment)
        for _ in range(2 if i > 20 else 0):
            now_s += 0.0331
            recorder.write(core.on_silence(False, 1.0))
        task = moment.assist.task
        stages |= {str(task.stage)} if task is not None else set()
    recorder.close()
    reached = world.state()
    world.close()
    assert {"approach", "clamp", "cut"} <= stages and reached.fruits
    source = McapSource(path)
    rows = [row for _, row in source.rows(topics.INPUTS)]
    assert sum(len(row.get("picks", ())) for row in rows) == 4
    events = {row["reason"] for _, row in source.rows(topics.EVENTS)}
    assert {"assist.preview", "assist.approach", "assist.cut", "assist.cancelled"} <= events
    found = compare(source, load_model())
    source.close()
    assert found.identical and found.frames == 45, lines(found, [])
