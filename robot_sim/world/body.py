"""The robot as one PyBullet body: loading, motors, readings, and putting it back where it was."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt
import pybullet

from robot_sim.actuators import JOINT_INDEX, JOINTS, WHEELS, axes
from robot_sim.config import RobotConfig
from robot_sim.limiter import Setpoints
from robot_sim.urdf import robot_urdf
from robot_sim.urdf_parts_chassis import OUTER_WHEELS
from robot_sim.world.client import Client

F64 = npt.NDArray[np.float64]
PINION_N, PINION_SHARE = 200.0, 0.2
"""What the gripper's pinion bears, well above the jaws' motors, and the share of an error it removes in a tick."""
ALL_JOINTS: tuple[str, ...] = (*JOINTS, *WHEELS)


@dataclass(frozen=True, slots=True)
class Motion:
    """A free body in the world: position [m], quaternion (x, y, z, w), velocity [m/s], spin [rad/s]."""

    xyz_m: tuple[float, ...]
    quaternion: tuple[float, ...]
    velocity_m_s: tuple[float, ...]
    spin_rad_s: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class LinkPose:
    """A link in the world: xyz_m (3,), R (3, 3)."""

    xyz_m: F64
    R: F64

    def local(self, point_m: F64) -> F64:
        """A world point (3,) in the link's axes [m]."""
        return np.asarray(self.R.T @ (point_m - self.xyz_m))

    def world(self, point_m: npt.ArrayLike) -> F64:
        """A point (3,) of the link's axes in the world [m]."""
        return np.asarray(self.xyz_m + self.R @ np.asarray(point_m))


def motion(client: Client, body: int) -> Motion:
    """How a body lies and moves."""
    xyz, quaternion = client.getBasePositionAndOrientation(body)
    velocity, spin = client.getBaseVelocity(body)
    return Motion(tuple(xyz), tuple(quaternion), tuple(velocity), tuple(spin))


def put(client: Client, body: int, m: Motion) -> None:
    """Lay a body down as it was."""
    client.resetBasePositionAndOrientation(body, m.xyz_m, m.quaternion)
    client.resetBaseVelocity(body, m.velocity_m_s, m.spin_rad_s)


class RobotBody:
    """The loaded URDF; link and joint numbers by name."""

    def __init__(self, client: Client, config: RobotConfig) -> None:
        self._client = client
        with TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            path.write_text(robot_urdf(config))
            flags = pybullet.URDF_USE_INERTIA_FROM_FILE | pybullet.URDF_USE_MATERIAL_COLORS_FROM_MTL
            self.id: int = client.loadURDF(str(path), [0.0, 0.0, 0.0], flags=flags)
        infos = [client.getJointInfo(self.id, i) for i in range(client.getNumJoints(self.id))]
        joints = {info[1].decode(): info[0] for info in infos}
        self.links: dict[str, int] = {info[12].decode(): info[0] for info in infos}
        self._joints = [joints[name] for name in ALL_JOINTS]
        self._servos, self._wheels = self._joints[: len(JOINTS)], self._joints[len(JOINTS) :]
        self._efforts = [axis.limits.effort for axis in axes(config)]
        self._gains = [config.position_gain] * len(JOINTS)
        self._ones = [1.0] * len(JOINTS)
        self._radius = config.chassis.wheel_radius_m
        self._driving, self._braking = (
            [torque_nm / 3.0] * len(WHEELS) for torque_nm in (config.chassis.motor_nm, config.chassis.brake_nm)
        )
        # across the tracks, along a wheel's own y; a URDF knows one friction for all directions
        across = config.chassis.scrub_friction / config.chassis.track_friction
        for name in OUTER_WHEELS:
            client.changeDynamics(self.id, self.links[name], anisotropicFriction=[1.0, across, 1.0])
        self.set_joints([(axis.home, 0.0) for axis in axes(config)])
        self._couple("gripper_left", "gripper_right")

    def _couple(self, one: str, other: str) -> None:
        """Tie two sliding jaws together, as the pinion between two racks does: what they hold is in their middle."""
        numbers = [self._joints[JOINT_INDEX[name]] for name in (one, other)]
        gear = self._client.createConstraint(
            self.id, numbers[0], self.id, numbers[1], pybullet.JOINT_GEAR, [0, 1, 0], [0, 0, 0], [0, 0, 0]
        )
        self._client.changeConstraint(gear, gearRatio=-1, maxForce=PINION_N, erp=PINION_SHARE)

    def follow(self, setpoints: Setpoints, driven: Sequence[float], left_m_s: float, right_m_s: float) -> None:
        """Set all motors: servos to where they are driven, tracks to their speeds over the floor [m/s]."""
        self._client.setJointMotorControlArray(
            self.id,
            self._servos,
            pybullet.POSITION_CONTROL,
            targetPositions=driven,
            targetVelocities=setpoints.velocity,
            forces=self._efforts,
            positionGains=self._gains,
            velocityGains=self._ones,
        )
        left, right = left_m_s / self._radius, right_m_s / self._radius
        self._client.setJointMotorControlArray(
            self.id,
            self._wheels,
            pybullet.VELOCITY_CONTROL,
            targetVelocities=[left] * 3 + [right] * 3,
            forces=self._braking if setpoints.estop else self._driving,
        )

    def joints(self) -> list[tuple[float, float]]:
        """Position and speed of every joint, in the order of ALL_JOINTS [rad or m, per second]."""
        return [(state[0], state[1]) for state in self._client.getJointStates(self.id, self._joints)]

    def power_w(self) -> float:
        """Mechanical power of all motors now, |torque x speed| [W]."""
        states = self._client.getJointStates(self.id, self._joints)
        return float(sum(abs(state[1] * state[3]) for state in states))

    def set_joints(self, values: list[tuple[float, float]]) -> None:
        """Put the joints, from the first one of ALL_JOINTS on, to positions and speeds."""
        for joint, (q, qd) in zip(self._joints, values, strict=False):
            self._client.resetJointState(self.id, joint, q, qd)

    def where(self) -> tuple[float, float, float]:
        """x, y [m] and yaw [rad] of the chassis."""
        xyz, quaternion = self._client.getBasePositionAndOrientation(self.id)
        return xyz[0], xyz[1], self._client.getEulerFromQuaternion(quaternion)[2]

    def link_pose(self, link: str) -> LinkPose:
        """Where a link's frame is."""
        state = self._client.getLinkState(self.id, self.links[link], computeForwardKinematics=True)
        return LinkPose(np.array(state[4]), np.array(self._client.getMatrixFromQuaternion(state[5])).reshape(3, 3))
