"""Arms stay apart: capsule distances against PyBullet's, and a limiter that brakes in time."""

import numpy as np
import pybullet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_sim.actuators import JOINT_INDEX, axes
from robot_sim.braking import brakes_clear, braking_margins_m
from robot_sim.capsules import arm_model
from robot_sim.clearance import PAIRS, arms_rad, breaches, least_margins_m, margins_m
from robot_sim.commands import ARM_NAMES, ArmTarget, RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.limiter import home_setpoints, limit
from robot_sim.urdf import robot_urdf

CONFIG = RobotConfig()
DOWN = ArmTarget(0, 0, 180)
CHAINS = {
    "right": ("right_upper_arm", "right_forearm", "right_tool", "gripper_left_link", "gripper_right_link"),
    "left": ("left_upper_arm", "left_forearm", "left_tool", "left_box"),
    "rear": ("rear_upper_arm", "rear_forearm", "rear_tool"),
}


def margins(right: ArmTarget = DOWN, left: ArmTarget = DOWN, rear: ArmTarget = DOWN) -> np.ndarray:
    return margins_m(arms_rad({"right": right, "left": left, "rear": rear}), CONFIG)


def test_distances_agree_with_pybullet(tmp_path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(robot_urdf(CONFIG))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(path), physicsClientId=client)
        infos = [pybullet.getJointInfo(body, i, client) for i in range(pybullet.getNumJoints(body, client))]
        joint, link = {i[1].decode(): i[0] for i in infos}, {i[12].decode(): i[0] for i in infos}
        for name in ("gripper_left", "gripper_right"):
            pybullet.resetJointState(body, joint[name], CONFIG.tool.jaw.upper, physicsClientId=client)
        rng = np.random.default_rng(4)
        for _ in range(25):
            targets = {arm: ArmTarget(*rng.uniform((-20, -20, 60), (110, 90, 180))) for arm in ARM_NAMES}
            q = arms_rad(targets)
            names = (f"{arm}_{axis}" for arm in ARM_NAMES for axis in ("c1", "c2", "elbow"))
            for name, angle in zip(names, q, strict=True):
                pybullet.resetJointState(body, joint[name], angle, physicsClientId=client)
            pybullet.performCollisionDetection(client)
            for pair, ours in zip(PAIRS[:3], margins_m(q, CONFIG)[:3], strict=True):
                chains = [CHAINS[ARM_NAMES[i]] for i in pair]
                theirs = min(
                    (
                        point[8]
                        for a in chains[0]
                        for b in chains[1]
                        for point in pybullet.getClosestPoints(
                            body, body, 2.0, link[a], link[b], physicsClientId=client
                        )
                    ),
                )
                if theirs > 0:
                    # capsules stand out of flat faces and round off corners
                    assert theirs - 0.04 <= ours <= theirs + 0.02
    finally:
        pybullet.disconnect(client)


def test_the_standard_pick_and_hanging_arms_keep_clear() -> None:
    for right in (ArmTarget(45, 0, 125), ArmTarget(45, 0, 135), ArmTarget(60, 0, 150)):
        for left in (ArmTarget(15, 0, 120), ArmTarget(30, 0, 135), ArmTarget(45, 0, 165)):
            assert breaches(margins(), margins(right, left), CONFIG) == ()
    assert (margins() > 0.02).all()


def test_moving_apart_is_never_refused() -> None:
    touching = margins(ArmTarget(45, 0, 145), ArmTarget(45, 0, 150))
    assert breaches(margins(), touching, CONFIG) == ((0, 1),)
    assert breaches(touching, touching + 0.001, CONFIG) == ()


@pytest.mark.parametrize(
    ("target", "reason"),
    [(ArmTarget(100, 0, 180), "hold.workspace"), (ArmTarget(0, -25, 100), "hold.body_distance")],
)
def test_trunk_and_workspace_are_kept(target: ArmTarget, reason: str) -> None:
    config = CONFIG.model_copy(
        update={"clearance": CONFIG.clearance.model_copy(update={"reach_m": 0.6, "body_gap_m": 0.1})}
    )
    setpoints, seen = home_setpoints(config), set()
    for _ in range(400):
        setpoints, reasons = limit(setpoints, RobotCommand(0, right_arm=target), 1 / 240, config)
        seen |= set(reasons)
    assert reason in seen


TARGETS = st.builds(ArmTarget, st.floats(-40, 130), st.floats(-40, 110), st.floats(30, 180))
MOVES = st.tuples(
    st.one_of(st.none(), TARGETS), st.one_of(st.none(), TARGETS), st.one_of(st.none(), TARGETS), st.integers(1, 60)
)


@given(st.lists(MOVES, min_size=1, max_size=4))
@settings(max_examples=60)
def test_no_sequence_of_targets_brings_arms_too_near(moves: list[tuple]) -> None:
    setpoints, dt_s = home_setpoints(CONFIG), 1 / 120
    arms = [JOINT_INDEX[f"{arm}_{axis}"] for arm in ARM_NAMES for axis in ("c1", "c2", "elbow")]
    least = np.array([CONFIG.clearance.arm_gap_m] * 3 + [CONFIG.clearance.body_gap_m] * 3 + [0.0] * 3)
    for right, left, rear, ticks in moves:
        for _ in range(ticks):
            setpoints, _ = limit(
                setpoints, RobotCommand(0, right_arm=right, left_arm=left, rear_arm=rear), dt_s, CONFIG
            )
            # between two looks at the braking way a gap may be a little smaller
            assert (margins_m([setpoints.position[i] for i in arms], CONFIG) >= least - 0.0005).all()
            for axis, q, speed in zip(axes(CONFIG), setpoints.position, setpoints.velocity, strict=True):
                assert axis.limits.lower - 1e-9 <= q <= axis.limits.upper + 1e-9
                assert abs(speed) <= axis.limits.speed + 1e-9


@settings(max_examples=300, deadline=None)
@given(st.lists(st.floats(-1.0, 1.0), min_size=18, max_size=18))
def test_the_quick_look_at_braking_arms_answers_as_the_whole_one(values: list[float]) -> None:
    arms = [axes(CONFIG)[JOINT_INDEX[f"{arm}_{axis}"]].limits for arm in ARM_NAMES for axis in ("c1", "c2", "elbow")]
    q = np.array([a.lower + 0.5 * (v + 1.0) * (a.upper - a.lower) for a, v in zip(arms, values[:9], strict=True)])
    v = np.array([a.speed * share for a, share in zip(arms, values[9:], strict=True)])
    keeps = bool((braking_margins_m(q, v, CONFIG) >= least_margins_m(CONFIG)).all())
    assert brakes_clear(q, v, CONFIG) == keeps


def test_no_point_of_an_arm_is_further_from_a_joint_than_its_lever() -> None:
    model = arm_model(CONFIG)
    straight = CONFIG.arm.upper_m + CONFIG.arm.forearm_m
    assert (model.lever_m[:, 0] == model.lever_m[:, 1]).all()
    assert (model.lever_m[:, 0] > straight).all() and (model.lever_m[:, 2] < model.lever_m[:, 0]).all()
