"""Forward kinematics, Jacobians and inverse solutions against roboticstoolbox-python on random arms and poses."""

from __future__ import annotations

import warnings
from types import ModuleType

import numpy as np
import pytest

from robot_sim.kinematics import DhRow, Joint, modified_dh, standard_dh


@pytest.fixture(scope="module")
def rtb() -> ModuleType:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("roboticstoolbox", reason="roboticstoolbox-python (extra dev) is not installed")


@pytest.mark.parametrize("kind", ["standard", "modified"])
@pytest.mark.parametrize("seed", range(6))
def test_forward_and_jacobians_equal_the_toolbox(rtb: ModuleType, kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 9))
    table = rng.uniform(-1.5, 1.5, (n, 4))
    slides = rng.random(n) < 0.25
    rows = [
        DhRow(al, a, d, th, Joint("", "prismatic" if s else "revolute"))
        for (al, a, d, th), s in zip(table, slides, strict=True)
    ]
    revolute, prismatic = (
        (rtb.RevoluteMDH, rtb.PrismaticMDH) if kind == "modified" else (rtb.RevoluteDH, rtb.PrismaticDH)
    )
    links = [
        prismatic(theta=th, a=a, alpha=al, offset=d) if s else revolute(d=d, a=a, alpha=al, offset=th)
        for (al, a, d, th), s in zip(table, slides, strict=True)
    ]
    theirs = rtb.DHRobot(links, name="random")
    ours = (modified_dh if kind == "modified" else standard_dh)("random", rows)
    q = rng.uniform(-3, 3, (40, n))
    np.testing.assert_allclose(ours.forward(q), np.array([theirs.fkine(v).A for v in q]), atol=1e-9)
    np.testing.assert_allclose(ours.jacobian(q), np.array([theirs.jacob0(v) for v in q]), atol=1e-9)
    np.testing.assert_allclose(ours.jacobian_tool(q), np.array([theirs.jacobe(v) for v in q]), atol=1e-9)


def test_the_toolbox_solution_is_among_our_branches(rtb: ModuleType) -> None:
    from robot_sim.arms.rb03 import grape_arm

    arm = grape_arm()
    g = arm
    h = np.pi / 2
    rows = [(0, 0, 0), (-h, g.a1_m, 0), (0, g.a2_m, 0), (-h, g.a3_m, g.d4_m), (h, 0, 0), (-h, 0, 0)]
    theirs = rtb.DHRobot(
        [rtb.RevoluteMDH(alpha=al, a=a, d=d, qlim=[-np.pi, np.pi]) for al, a, d in rows], tool=arm.T_last_tool
    )
    rng = np.random.default_rng(5)
    compared = 0
    for q in rng.uniform(-1.2, 1.2, (12, 6)):
        T = arm.chain.forward(q)
        theirs_solution = theirs.ikine_LM(T, tol=1e-20, q0=q + 0.05, seed=1)
        if not theirs_solution.success:
            continue
        batch = arm.inverse_batch(T)
        branches = batch.q[0][batch.reached[0]]
        off = np.abs((branches - theirs_solution.q + np.pi) % (2 * np.pi) - np.pi).max(axis=1)
        assert off.min() < 1e-6
        compared += 1
    assert compared >= 10
