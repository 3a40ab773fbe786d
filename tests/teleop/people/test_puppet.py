"""The driven operator gets where they are told to be, as a person would, and is the same for the same wishes."""

from __future__ import annotations

import itertools
from math import hypot

import numpy as np
import pytest

from teleop.people.motion import Moment
from teleop.people.puppet import Puppet
from teleop.people.wishes import ArmChange, ArmWish, Wish, WishChange

DT_S = 1.0 / 30.0


def acted(wish: Wish, seconds: float, puppet: Puppet | None = None) -> list[Moment]:
    puppet = puppet or Puppet()
    return [puppet.step(wish, DT_S) for _ in range(round(seconds / DT_S))]


def test_they_walk_to_a_place_no_faster_than_a_person() -> None:
    moments = acted(Wish(x_m=0.6, z_m=1.7), 3.0)
    assert (moments[-1].x_m, moments[-1].z_m) == pytest.approx((0.6, 1.7), abs=0.02)
    steps = [hypot(b.x_m - a.x_m, b.z_m - a.z_m) for a, b in itertools.pairwise(moments)]
    assert max(steps) < 0.9 * DT_S


def test_limbs_reach_the_angles_they_are_told() -> None:
    last = acted(Wish(apart_deg=24.0, right=ArmWish(side_deg=60.0, elbow_deg=120.0, hand="fist")), 2.0)[-1]
    upper, fore = last.pose.arms[0].upper, last.pose.arms[0].fore
    assert np.degrees(np.arctan2(upper[0], -upper[1])) == pytest.approx(60.0, abs=2.0)
    assert 180.0 - np.degrees(np.arccos(upper @ fore)) == pytest.approx(120.0, abs=2.0)
    assert last.curl[0] == pytest.approx(1.0, abs=0.01)
    thighs = [leg.thigh for leg in last.pose.legs]
    assert np.degrees(np.arccos(thighs[0] @ thighs[1])) == pytest.approx(24.0, abs=1.0)


@pytest.mark.parametrize("gesture", ["engage", "stop"])
def test_a_gesture_takes_both_arms_and_gives_them_back(gesture: str) -> None:
    puppet = Puppet()
    held = acted(Wish(gesture=gesture), 2.0, puppet)[-1]  # type: ignore[arg-type]
    assert all(arm.fore[1] > 0.4 for arm in held.pose.arms), "both forearms point up"
    back = acted(Wish(), 2.0, puppet)[-1]
    assert all(arm.upper[1] < -0.95 for arm in back.pose.arms)


def test_the_same_wishes_give_the_same_motion() -> None:
    wish = Wish(x_m=-0.4, turn_deg=20.0, left=ArmWish(side_deg=45.0))
    once, twice = (acted(wish, 1.0)[-1] for _ in range(2))
    assert (once.pose.arms[1].upper == twice.pose.arms[1].upper).all()
    assert (once.x_m, once.z_m) == (twice.x_m, twice.z_m)


def test_a_change_leaves_the_rest_as_it_was() -> None:
    wish = WishChange(z_m=2.0, right=ArmChange(side_deg=30.0)).of(Wish(x_m=0.3, right=ArmWish(hand="fist")))
    assert wish == Wish(x_m=0.3, z_m=2.0, right=ArmWish(side_deg=30.0, hand="fist"))
