"""Servo set-points: the 15-degree steps, their edges, easing in, and the two mappings."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stick_figure import Arm, Person, raised, skeleton, without

from robot_sim.arm_angles import upper_arm_direction
from robot_sim.commands import ArmTarget
from teleop.config.intent import AngleConfig, MappingConfig
from teleop.mapping import ArmMemory, Measured, eased_from, measure, nearest_step, step_arm
from teleop.reasons import Reason

CONFIG, ANGLES = MappingConfig(), AngleConfig()
DT_S = 1 / 30


def settle(
    wanted: Measured, memory: ArmMemory = ArmMemory(), frames: int = 300, config: MappingConfig = CONFIG
) -> ArmMemory:
    for _ in range(frames):
        memory, _ = step_arm(memory, wanted, DT_S, config)
    return memory


@pytest.mark.parametrize(
    ("angle", "step"),
    [
        (0, 0),
        (7.4, 0),
        (7.6, 15),
        (22.4, 15),
        (22.6, 30),
        (37.6, 45),
        (52.6, 60),
        (67.6, 75),
        (82.4, 75),
        (82.6, 90),
        (90, 90),
        (120, 90),
        (-20, 0),
    ],
)
def test_steps_of_the_source(angle: float, step: float) -> None:
    assert nearest_step(angle, CONFIG) == step


@pytest.mark.parametrize("angle", range(0, 91, 5))
def test_a_held_angle_reaches_its_step(angle: int) -> None:
    target = settle(Measured(float(angle), float(angle), 135.4)).target
    assert target == ArmTarget(nearest_step(angle, CONFIG), nearest_step(angle, CONFIG), 135.0)


@pytest.mark.parametrize("side", ["right", "left"])
def test_frontal_angle_drives_c2_and_sagittal_angle_c1(side: str) -> None:
    out = settle(measure(skeleton(Person(**{side: raised(outward_deg=60)})), side, CONFIG, ANGLES)).target
    assert (out.c1_deg, out.c2_deg, out.elbow_deg) == (0.0, 60.0, 180.0)
    forward = settle(measure(skeleton(Person(**{side: raised(forward_deg=60)})), side, CONFIG, ANGLES)).target
    assert (forward.c1_deg, forward.c2_deg) == (60.0, 0.0)


def test_arm_at_the_sensor_holds_c2_where_it_was() -> None:
    memory = settle(measure(skeleton(Person(right=raised(outward_deg=45))), "right", CONFIG, ANGLES))
    wanted = measure(skeleton(Person(right=raised(forward_deg=90))), "right", CONFIG, ANGLES)
    assert Reason.SHORT_PROJECTION in wanted.reasons
    target = settle(wanted, memory).target
    assert (target.c1_deg, target.c2_deg) == (90.0, 45.0)


def test_arm_across_the_body_is_zero_not_outward() -> None:
    across = Arm((0.0, -0.5, -0.86), (0.0, -0.5, -0.86))
    wanted = measure(skeleton(Person(right=across)), "right", CONFIG, ANGLES)
    assert settle(wanted).target.c2_deg == 0.0
    assert Reason.SHOULDER_RANGE in step_arm(ArmMemory(), wanted, DT_S, CONFIG)[1]


def test_unknown_and_doubtful_arms_hold() -> None:
    memory = settle(Measured(45.0, 30.0, 120.0))
    body = skeleton(Person(right=raised(outward_deg=90)))
    body.confidence[:] = 0.05
    for wanted in (
        measure(body, "right", CONFIG, ANGLES),
        measure(without(skeleton(Person()), "elbow_right"), "right", CONFIG, ANGLES),
    ):
        assert wanted.reasons
        assert settle(wanted, memory).target == memory.target


@pytest.mark.parametrize("edge", [7.5, 22.5, 52.5, 82.5])
def test_arm_on_a_bin_edge_for_a_minute_never_flips(edge: float) -> None:
    rng = np.random.default_rng(5)
    person = Person(right=raised(outward_deg=edge))
    memory = settle(measure(skeleton(person), "right", CONFIG, ANGLES))
    seen = set()
    for _ in range(1800):
        wanted = measure(skeleton(person, rng=rng), "right", CONFIG, ANGLES)
        memory, _ = step_arm(memory, wanted, DT_S, CONFIG)
        seen.add(memory.target.c2_deg)
    assert len(seen) == 1


def test_oblique_arm_on_both_edges_does_not_flip() -> None:
    # projections shortened to a half double the noise of the angles; the evidence is weighted down
    rng = np.random.default_rng(6)
    d = (0.75, 0.433 * np.tan(np.radians(52.5)), -0.433)
    person = Person(right=Arm(d, d))
    memory = settle(measure(skeleton(person), "right", CONFIG, ANGLES))
    changes = 0
    for _ in range(1800):
        after, _ = step_arm(memory, measure(skeleton(person, rng=rng), "right", CONFIG, ANGLES), DT_S, CONFIG)
        changes += (after.target.c1_deg, after.target.c2_deg) != (memory.target.c1_deg, memory.target.c2_deg)
        memory = after
    assert changes <= 1


def test_delay_of_a_clear_change() -> None:
    memory = settle(Measured(0.0, 0.0, 180.0))
    for wanted, limit_s in ((30.0, 0.4), (60.0, 0.15), (90.0, 0.15)):
        state, frames = memory, 0
        while state.target.c1_deg != wanted:
            state, _ = step_arm(state, Measured(wanted, 0.0, 180.0), DT_S, CONFIG)
            frames += 1
        assert frames * DT_S <= limit_s


def test_easing_in_steps_slowly_from_where_the_robot_is() -> None:
    memory, wanted = eased_from(ArmTarget(0.0, 0.0, 180.0)), Measured(90.0, 90.0, 90.0)
    steps = [0.0]
    last = memory.target
    t = 0.0
    while memory.easing:
        memory, reasons = step_arm(memory, wanted, DT_S, CONFIG)
        t += DT_S
        assert Reason.EASE_IN in reasons
        assert abs(memory.target.c1_deg - last.c1_deg) <= CONFIG.step_deg
        assert abs(memory.target.elbow_deg - last.elbow_deg) <= CONFIG.ease_elbow_deg_s * DT_S + 1.0
        if memory.target.c1_deg != last.c1_deg:
            steps.append(t)
        last = memory.target
    assert last == ArmTarget(90.0, 90.0, 90.0)
    assert min(np.diff(steps)[1:]) >= CONFIG.ease_step_s - DT_S


@given(st.floats(0, 90), st.floats(0, 74))
@settings(max_examples=50)
def test_direction_mapping_points_the_robot_arm_as_the_operators(c1: float, c2: float) -> None:
    config = MappingConfig(mapping="direction")
    d = upper_arm_direction(c1, c2)
    wanted = measure(skeleton(Person(right=Arm(d, d))), "right", config, ANGLES)
    target = settle(wanted, config=config).target
    reached = np.array(upper_arm_direction(target.c1_deg, target.c2_deg))
    error_deg = np.degrees(np.arccos(np.clip(reached @ np.array(d), -1, 1)))
    # nearer to straight out the projection is too short and C1 holds
    assert error_deg <= 2 * config.direction_deadband_deg + 1.0


ANY_ANGLE = st.one_of(st.none(), st.floats(-180, 270))


@given(
    st.lists(st.tuples(ANY_ANGLE, ANY_ANGLE, ANY_ANGLE, st.floats(0, 1)), max_size=60),
    st.sampled_from(["paper", "direction"]),
)
def test_set_points_never_leave_their_range(wishes: list[tuple], mapping: str) -> None:
    config, memory = MappingConfig(mapping=mapping), ArmMemory()
    for c1, c2, elbow, dt_s in wishes:
        memory, _ = step_arm(memory, Measured(c1, c2, elbow), dt_s, config)
        target = memory.target
        assert 0 <= target.c1_deg <= 90 and 0 <= target.c2_deg <= 90 and 90 <= target.elbow_deg <= 180
        assert target.elbow_deg == round(target.elbow_deg)
        if mapping == "paper":
            assert target.c1_deg % 15 == 0 and target.c2_deg % 15 == 0


def test_easing_in_begins_where_the_arm_stands_and_goes_to_a_step_first() -> None:
    config = MappingConfig()
    memory, sent = eased_from(ArmTarget(37.0, 110.0, 100.0)), [ArmTarget(37.0, 110.0, 100.0)]
    for _ in range(120):
        memory, _ = step_arm(memory, Measured(0.0, 30.0, 180.0), 1 / 30, config)
        sent.append(memory.target)
    speed = config.step_deg / config.ease_step_s / 30
    assert sent[0] == ArmTarget(37.0, 110.0, 100.0) and sent[-1] == ArmTarget(0.0, 30.0, 180.0)
    assert abs(sent[1].c1_deg - 37.0) <= speed + 1 and abs(sent[1].c2_deg - 110.0) <= speed + 1
    assert {30.0, 15.0} <= {target.c1_deg for target in sent}
    assert max(abs(a.elbow_deg - b.elbow_deg) for a, b in pairwise(sent)) <= config.ease_elbow_deg_s / 30 + 1
    assert not memory.easing
