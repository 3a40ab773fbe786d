"""A recorded session in the console: the recorded robot beside the running one, single steps, jumps into its middle."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from live_server import frames, tracker

from robot_sim.world import World
from server.cli.record_run import RecordOptions, record_session
from server.engine import snapshot
from server.engine.core import Core, Moment
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived, Mailbox
from server.engine.playback import Playback
from server.engine.reader import Reader
from server.settings import Settings, bundled_recordings
from teleop.intent_types import Mode
from teleop.modes import IN_CONTROL
from teleop.reasons import Reason
from teleop.recording import McapSource
from teleop.recording.convert import convert
from teleop.sources import open_source

PICKING_S = 21.0
ENTERED_S = 1.5


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds in which the operator is engaged and picks."""
    folder = tmp_path_factory.mktemp("controls")
    demo = open_source(str(bundled_recordings() / "greenhouse_demo.mcap"))
    convert(demo, folder / "picking.mcap", from_s=PICKING_S, seconds=3.0)
    demo.close()
    path = folder / "session.mcap"
    source = open_source(str(folder / "picking.mcap"))
    record_session(source, path, Settings(), RecordOptions(engage=True))
    source.close()
    return path


class Player:
    """Reader and playback over a recording, one frame at a time."""

    def __init__(self, path: Path) -> None:
        source = McapSource(path)
        self.playback = Playback(False, source.info.duration_s)
        self.mailbox = Mailbox()
        self.reader = Reader(source, self.playback, self.mailbox)

    def next(self) -> Arrived:
        arrived = self.mailbox.take(20.0)
        assert arrived is not None
        return arrived


@pytest.fixture
def player(recording: Path) -> Iterator[Player]:
    player = Player(recording)
    yield player
    player.reader.stop()


def test_single_steps(player: Player) -> None:
    player.playback.step()  # before the first frame
    player.reader.start()
    first = player.next()
    assert player.playback.state.paused
    player.playback.step()
    second = player.next()
    player.playback.step()
    third = player.next()
    assert [a.frame.seq for a in (first, second, third)] == [0, 1, 2]
    assert player.mailbox.take(0.2) is None
    player.playback.play()
    assert player.next().frame.seq == 3 and not player.playback.state.paused


def test_the_recorded_robot_comes_with_each_frame(player: Player, recording: Path) -> None:
    player.playback.set_speed(8.0)
    player.playback.seek(ENTERED_S)
    player.reader.start()
    ghost = snapshot.ghost_state(player.next().recorded)
    source = McapSource(recording)
    states = source.file.topics["/joint_states"]
    number = int(np.searchsorted(states.t_ns, states.t_ns[0] + ENTERED_S * 1e9))
    recorded = source.file.message("/joint_states", number).joints
    source.close()
    assert ghost is not None
    assert ghost.joints == {joint.name: round(joint.position, 4) for joint in recorded}
    assert snapshot.ghost_state(None) is None


def test_a_session_entered_in_its_middle_eases_the_robot_in(player: Player) -> None:
    """Nobody repeats the engage gesture: who was in control stays so, and the arms start from where they are."""
    settings = Settings()
    now_s = 50.0
    world = World(settings.robot)
    core = Core(tracker(settings), world, settings, Ledger(2), lambda: now_s)
    rest = dict(world.state().joint_rad)
    player.playback.seek(ENTERED_S)
    player.reader.start()
    moments: list[Moment] = []
    done = threading.Event()
    while not done.is_set():
        arrived = player.next()
        moments.append(core.on_frame(arrived, live=False, speed=1.0))
        now_s += 0.05
        if len(moments) == 25:
            done.set()
    world.close()
    modes = [m.output.intent.mode for m in moments if m.output is not None]
    assert Mode.SEEN not in modes[10:] and set(modes[10:]) <= IN_CONTROL
    assert any(Reason.EASE_IN in m.command.reasons for m in moments)
    arms = [n for n in rest if n.endswith(("c1", "c2", "elbow"))] or list(rest)
    path = np.array([[rest[n] for n in arms]] + [[m.robot.joint_rad[n] for n in arms] for m in moments])
    assert np.abs(path[1] - path[0]).max() < 0.05  # it does not jump to the recorded pose
    fastest = np.deg2rad(settings.teleop.intent.mapping.step_deg / settings.teleop.intent.mapping.ease_step_s)
    ease = [i for i, m in enumerate(moments) if Reason.EASE_IN in m.command.reasons]
    steps = np.abs(np.diff(path, axis=0))[ease]
    assert 0.0 < steps.max() <= 2.0 * max(fastest, 1.0) * 0.05
    assert np.abs(path[-1] - path[0]).max() > 0.05  # and it does get there


def test_a_recording_without_a_session_has_no_ghost(tmp_path: Path) -> None:
    from live_server import write_walk

    player = Player(write_walk(tmp_path / "walk.mcap", 5))
    player.playback.seek(0.05)
    player.reader.start()
    arrived = player.next()
    player.reader.stop()
    assert arrived.recorded is None and not arrived.in_control and len(frames()) > 5
