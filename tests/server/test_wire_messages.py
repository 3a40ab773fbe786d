"""The wire: bytes, JSON, and the console's generated twin."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_sim.commands import Liquid
from robot_sim.state import RobotState
from server import wire
from server.engine.snapshot import finite, robot_state, skeleton_state
from server.images_wire import ImageKind, ImagePacket
from server.wire_types import DEFAULT_PATH, typescript
from teleop.frames import Camera
from teleop.skeleton import Skeleton


def test_the_header_is_these_sixteen_bytes() -> None:
    packet = ImagePacket(ImageKind.COLOR, 320, 240, 0x01020304, b"\xff\xd8")
    assert packet.to_bytes() == bytes.fromhex("4754 02 00 4001 f000 04030201 00000000 ffd8".replace(" ", ""))


@given(st.sampled_from(ImageKind), st.integers(0, 65535), st.integers(0, 65535), st.integers(0, 2**32 - 1), st.binary())
def test_a_packet_survives_the_way(kind: ImageKind, width: int, height: int, seq: int, jpeg: bytes) -> None:
    packet = ImagePacket(kind, width, height, seq, jpeg)
    assert ImagePacket.from_bytes(packet.to_bytes()) == packet


@pytest.mark.parametrize("data", [b"", b"GT", b"XX" + bytes(20), b"GT\x09" + bytes(20)])
def test_foreign_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(ValueError):
        ImagePacket.from_bytes(data)


def test_the_console_has_the_types_of_this_server() -> None:
    if not DEFAULT_PATH.exists():
        pytest.skip("the console's source is not part of this installation")
    assert DEFAULT_PATH.read_text() == typescript(), "run: python -m server.wire_types"


def test_the_generator_writes_unions_arrays_and_maps() -> None:
    text = typescript()
    for line in (
        'export type Hand = "open" | "fist" | "unknown";',
        "  joints: { [key: string]: Vec3 | null };",
        "  bones: [number, number][];",
        "  skeleton: SkeletonState | null;",
        "export type ClientMessage = Painted | View;",
    ):
        assert line in text


def test_an_unknown_joint_is_null_and_json_holds_no_nan() -> None:
    joints = np.full((20, 3), np.nan)
    joints[0] = (0.1, 0.2, 2.0)
    joints[1] = (0.0, 0.0, 0.0)
    state = skeleton_state(Skeleton(0, joints, np.full(20, np.nan)), Camera())
    assert state is not None
    assert state.joints["head"] == (0.1, 0.2, 2.0) and state.joints["spine"] is None
    assert state.pixels["shoulder_center"] is None
    assert "NaN" not in state.model_dump_json() and "Infinity" not in state.model_dump_json()
    assert finite(float("inf")) is None


def test_the_generator_writes_where_it_is_told(tmp_path: Path) -> None:
    from server.wire_types import main

    main([str(tmp_path / "wire.ts")])
    assert "interface State" in (tmp_path / "wire.ts").read_text()


def test_a_client_message_of_another_kind_is_refused() -> None:
    with pytest.raises(ValueError):
        wire.View.model_validate({"type": "view", "image": "x-ray"})


def test_fruit_on_the_wire_is_what_the_robot_reports() -> None:
    state = RobotState(
        sim_time_s=1.0,
        base_x_m=0.0,
        base_y_m=0.0,
        base_yaw_rad=0.0,
        drive_m_s=0.0,
        turn_rad_s=0.0,
        joint_rad={},
        target_rad={},
        gripper_open=True,
        cutter_closed=False,
        spray_on=False,
        liquid=Liquid.WATER,
        estop=False,
        tank_l={"water": 3.98765},
        fruits={"plant_0_fruit_1": "dropped+damaged"},
        moved={"plant_0_fruit_1_body": (0.123456, 0.0, 0.05, 0.0, 0.0, 0.70710678, 0.70710678)},
    )
    robot = wire.RobotWire.model_validate_json(robot_state(state).model_dump_json())
    assert robot.tank_l == {"water": 3.988} and robot.fruits == {"plant_0_fruit_1": "dropped+damaged"}
    assert robot.moved == {"plant_0_fruit_1_body": (0.1235, 0.0, 0.05, 0.0, 0.0, 0.7071, 0.7071)}
