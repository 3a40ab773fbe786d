"""Plans of assisted picks: what is refused says what to do; what is planned is free, by PyBullet's own geometry."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from robot_sim.actuators import JOINTS
from robot_sim.collision import CollisionWorld
from robot_sim.config import GreenhouseConfig, RobotConfig
from robot_sim.greenhouse import greenhouse
from robot_sim.limiter import home_setpoints
from robot_sim.pick.grasp import grasps, grip_point_m
from robot_sim.pick.motions import Leg
from robot_sim.pick.plan import PickPlan, Scenery, plan_pick, where_fruits_are
from robot_sim.pick.refusal import Refusal
from robot_sim.pick.surroundings import hard, scene_around
from robot_sim.pick.targets import nearest_ripe
from robot_sim.plants import Fruit
from robot_sim.reasons import RobotReason
from robot_sim.stance import stance_of
from robot_sim.state import RobotState
from robot_sim.urdf import robot_urdf

CONFIG = RobotConfig()
HOUSE = greenhouse(CONFIG.greenhouse, 0)
SCENERY = Scenery(hard(HOUSE.primitives), HOUSE.fruits)
LEFT_ROW = [f for f in HOUSE.fruits if f.crop == "cucumber"]
IN_REACH = [
    "cucumber_1_fruit_0",
    "cucumber_1_fruit_1",
    "cucumber_2_fruit_0",
    "cucumber_2_fruit_1",
    "cucumber_3_fruit_1",
]


def standing(x_m: float = 0.0, yaw_rad: float = 0.0, config: RobotConfig = CONFIG, **joints: float) -> RobotState:
    home = dict(zip(JOINTS, home_setpoints(config).position, strict=True)) | joints
    return RobotState(
        sim_time_s=0.0, base_x_m=x_m, base_y_m=0.0, base_yaw_rad=yaw_rad, drive_m_s=0.0, turn_rad_s=0.0,
        joint_rad=home, target_rad=home, gripper_open=True, cutter_closed=False, spray_on=False,
        liquid="water", estop=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def plans() -> dict[str, PickPlan]:
    found = {name: plan_pick(name, SCENERY, standing(), CONFIG) for name in IN_REACH}
    assert all(isinstance(plan, PickPlan) for plan in found.values()), found
    return found  # type: ignore[return-value]


def test_motions_follow_each_other_without_a_jump(plans: dict[str, PickPlan]) -> None:
    order = (Leg.REACH, Leg.CLOSE_IN, Leg.RETREAT, Leg.LOWER)
    for plan in plans.values():
        at = np.zeros(6)
        for leg in order:
            motion = plan.motions[leg]
            assert motion.at(0.0).q[0] == pytest.approx(at, abs=1e-9)
            at = motion.at(motion.duration_s).q[0]
            m = motion.sample(0.01)
            arm = CONFIG.arm
            for k, axis in enumerate([arm.c1, arm.c2, arm.elbow] * 2):
                assert axis.lower - 1e-9 <= m.q[:, k].min() and m.q[:, k].max() <= axis.upper + 1e-9
                assert np.abs(m.qd[:, k]).max() <= CONFIG.pick.speed_share * axis.speed * 1.001


def test_no_posture_of_a_plan_touches_anything_in_pybullet(plans: dict[str, PickPlan]) -> None:
    """The planner's own geometry is capsules and balls; this is the robot's URDF against the crop."""
    links = ["right_forearm", "right_tool", "right_upper_arm", "left_forearm", "left_box", "left_tool"]
    for name in ("cucumber_2_fruit_0", "cucumber_2_fruit_1"):
        plan = plans[name]
        places = where_fruits_are(SCENERY, standing())
        scene = scene_around(plan.stance, SCENERY.standing, places, HOUSE.fruits, name, CONFIG)
        T = plan.stance.T_world_disc(CONFIG)
        with CollisionWorld(robot_urdf(CONFIG)) as world:
            # the robot's base stays at the origin: the greenhouse is laid round it
            world.set_joints({"lift": plan.stance.lift_m, "gripper_left": 0.06, "gripper_right": 0.06})
            base = world.link_pose("disc_link")
            for k, solid in enumerate(scene.solids):
                world.add_solid(f"solid_{k}", replace(solid, T=base @ solid.T))
            assert base[:3, :3] == pytest.approx(T[:3, :3], abs=1e-5)
            for leg in (Leg.REACH, Leg.CLOSE_IN, Leg.RETREAT, Leg.LOWER):
                for q in plan.motions[leg].sample(0.1).q:
                    names = [f"{arm}_{a}" for arm in ("right", "left") for a in ("c1", "c2", "elbow")]
                    world.set_joints(dict(zip(names, q.tolist(), strict=True)))
                    near = [c for c in world.contacts(0.0) if c.link in links]
                    assert near == [], (name, leg, near)
                    pairs = [(a, b) for a in links[:2] for b in links[3:]]
                    assert world.self_contacts(pairs, 0.0) == [], (name, leg)


def test_the_peduncle_is_between_the_blades_at_every_grasp() -> None:
    for fruit in LEFT_ROW:
        grip = grip_point_m(fruit, fruit.xyz_m, CONFIG)
        assert grip[2] == pytest.approx(fruit.xyz_m[2] + fruit.top_m - CONFIG.pick.grip_under_top_m)
        for grasp in list(grasps(stance_of(standing(fruit.xyz_m[0])), grip, 0.3, CONFIG))[:5]:
            assert abs(grasp.drive_m) <= 0.3 + 1e-9
            assert CONFIG.body.lift.lower <= grasp.stance.lift_m <= CONFIG.body.lift.upper
            assert np.linalg.norm(grasp.approach) == pytest.approx(1.0) and grasp.approach[2] == 0.0


def test_a_fruit_far_along_the_row_says_how_far_to_drive_and_that_helps() -> None:
    found = plan_pick("cucumber_5_fruit_0", SCENERY, standing(), CONFIG)
    assert isinstance(found, Refusal) and found.reason is RobotReason.PICK_OUT_OF_REACH
    assert found.forward_m is not None and found.forward_m > CONFIG.pick.correction_m
    assert f"drive {found.forward_m:.2f} m forward" in found.detail
    assert isinstance(plan_pick("cucumber_5_fruit_0", SCENERY, standing(found.forward_m), CONFIG), PickPlan)


def test_a_short_drive_is_part_of_the_plan_and_a_slanting_robot_does_not_drive_by_itself() -> None:
    plan = plan_pick("cucumber_3_fruit_0", SCENERY, standing(), CONFIG)
    assert isinstance(plan, PickPlan) and 0.0 < plan.drive_m <= CONFIG.pick.correction_m
    slanting = plan_pick("cucumber_3_fruit_0", SCENERY, standing(yaw_rad=0.3), CONFIG)
    assert isinstance(slanting, Refusal) and "turn the robot along the row" in slanting.detail


@pytest.mark.parametrize(
    ("name", "state", "reason", "says"),
    [
        ("cucumber_9", standing(), RobotReason.PICK_NO_FRUIT, "no fruit 'cucumber_9'"),
        ("cucumber_2_fruit_0", standing(yaw_rad=math.pi), RobotReason.PICK_BEHIND, "180 deg"),
        (
            "cucumber_2_fruit_0",
            replace(standing(), fruits={"cucumber_2_fruit_0": "boxed"}),
            RobotReason.PICK_NOT_HANGING,
            "does not hang",
        ),
        ("tomato_2_fruit_0", standing(disc=math.pi), RobotReason.UNKNOWN_TOOL, "robot.tool.gripper = 'soft'"),
    ],
)
def test_what_cannot_be_picked_says_why(name: str, state: RobotState, reason: RobotReason, says: str) -> None:
    found = plan_pick(name, SCENERY, state, CONFIG)
    assert isinstance(found, Refusal) and found.reason is reason and says in found.detail


def test_a_fruit_that_swings_is_looked_for_where_it_is() -> None:
    at = (0.30, 0.57, 1.2)
    moved = replace(standing(), moved={"cucumber_2_fruit_0": (*at, 0.0, 0.0, 0.0, 1.0)})
    assert where_fruits_are(SCENERY, moved)["cucumber_2_fruit_0"] == at
    assert "cucumber_2_fruit_0" not in where_fruits_are(
        SCENERY, replace(standing(), fruits={"cucumber_2_fruit_0": "dropped+damaged"})
    )


def test_the_nearest_ripe_fruit_is_chosen_and_unripe_ones_are_left() -> None:
    name, found = nearest_ripe(SCENERY, standing(), CONFIG)
    assert isinstance(found, PickPlan) and name == "cucumber_2_fruit_1"
    unripe = Scenery(SCENERY.standing, tuple(replace(f, ripe=False) for f in HOUSE.fruits))
    _, none = nearest_ripe(unripe, standing(), CONFIG)
    assert isinstance(none, Refusal) and none.reason is RobotReason.PICK_NO_FRUIT


def test_a_box_without_room_is_a_reason_of_its_own() -> None:
    def hanging(k: int, x: float) -> Fruit:
        grown = LEFT_ROW[0]
        parts = tuple(replace(p, name=f"f{k}{p.name}", xyz_m=(x, 0.40, 1.0)) for p in grown.parts)
        return replace(grown, name=f"curtain_{k}", xyz_m=(x, 0.40, 1.0), parts=parts)

    curtain = tuple(hanging(k, -0.5 + 0.05 * k) for k in range(21))
    crowded = Scenery(SCENERY.standing, (*HOUSE.fruits, *curtain))
    found = plan_pick("cucumber_2_fruit_0", crowded, standing(), CONFIG)
    assert isinstance(found, Refusal) and found.reason in (RobotReason.PICK_NO_BOX, RobotReason.PICK_NO_PATH)


def test_arms_stretched_among_the_crop_are_drawn_back_before_the_robot_moves() -> None:
    stretched = standing(right_c1=math.radians(70), right_elbow=math.radians(10))
    plan = plan_pick("cucumber_1_fruit_1", SCENERY, stretched, CONFIG)
    assert isinstance(plan, PickPlan) and plan.drive_m != 0.0 and Leg.TUCK in plan.motions


def test_another_greenhouse_with_tomatoes_wants_the_soft_gripper() -> None:
    config = RobotConfig(
        greenhouse=GreenhouseConfig(left_crop="tomato", right_crop="cucumber"),
        tool=CONFIG.tool.model_copy(update={"gripper": "soft"}),
    )
    house = greenhouse(config.greenhouse, 0)
    scenery = Scenery(hard(house.primitives), house.fruits)
    name, found = nearest_ripe(scenery, standing(config=config), config)
    assert name.startswith("tomato") and isinstance(found, PickPlan)
