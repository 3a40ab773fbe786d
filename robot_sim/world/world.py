"""The robot in its greenhouse row, stepped by PyBullet at 240 Hz from RobotCommands."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt
import pybullet
from pybullet_utils.bullet_client import BulletClient

from robot_sim.actuators import JOINT_INDEX, JOINTS, WHEELS, axes
from robot_sim.commands import RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.errors import RobotError
from robot_sim.greenhouse import greenhouse, solid
from robot_sim.head_camera import projection_matrix, view_matrix
from robot_sim.limiter import Goals, Setpoints, advance, home_setpoints, latch_estop, resolve
from robot_sim.plants import Fruit
from robot_sim.primitives import Primitive
from robot_sim.state import RobotState
from robot_sim.urdf import robot_urdf
from robot_sim.world.contacts import Touch, away_from
from robot_sim.world.crops import Crops, FruitContact, ToolPose
from robot_sim.world.meshes import merge
from robot_sim.world.tracks import Heading, track_speeds

TICK_HZ = 240
TICK_S = 1.0 / TICK_HZ
"""PyBullet's own default, on which its solver's settings rest."""
CUTTER = JOINT_INDEX["cutter"]
SKY_RGB = (214, 226, 230)
"""Diffuse glass behind everything."""


class World:
    """One simulated robot. Not thread-safe: one thread steps, reads and renders.

    config: dimensions and limits. seed: decides the crop, nothing else; the same seed and the same commands give
    bit-equal states.
    """

    _setpoints: Setpoints
    _heading: Heading
    _ticks: int
    _carried_s: float
    _reasons: tuple[str, ...]
    _crops: Crops
    _blades_closed: bool

    def __init__(self, config: RobotConfig | None = None, seed: int = 0) -> None:
        self.config = config or RobotConfig()
        self.seed = seed
        self._greenhouse = greenhouse(self.config.greenhouse, seed)
        self._meshes = merge(self._greenhouse.parts)
        self._client = BulletClient(pybullet.DIRECT)
        self._start()

    @property
    def urdf(self) -> str:
        """The robot's URDF text."""
        return robot_urdf(self.config)

    def scenery(self) -> tuple[Primitive, ...]:
        """Everything in the greenhouse but the robot, as it is at the start (RobotState.moved: what moved since)."""
        return self._greenhouse.primitives

    @property
    def fruits(self) -> tuple[Fruit, ...]:
        """All fruit as it grew; RobotState.fruits says what became of it."""
        return self._greenhouse.fruits

    def step(self, command: RobotCommand, dt_s: float) -> RobotState:
        """Follow a command for ``dt_s`` seconds [s] and report.

        Physics runs in whole ticks of 1/240 s; what is left of ``dt_s`` is carried to the next call, so that
        simulated time never drifts from the caller's by a tick or more.

        Raises RobotError when ``dt_s`` is negative or not finite.
        """
        if not (isfinite(dt_s) and dt_s >= 0.0):
            raise RobotError(f"the time step must be a finite number of seconds >= 0, got {dt_s}")
        due = self._carried_s + dt_s
        # a caller's 1/30 s is 8 ticks although the binary sum may fall a hair short
        ticks = int(due * TICK_HZ + 1e-6)
        self._carried_s = due - ticks * TICK_S
        goals = self._away_from_contacts(resolve(command, self.config))
        reasons = dict.fromkeys(goals.reasons)
        for _ in range(ticks):
            self._setpoints, tick_reasons = advance(self._setpoints, goals, TICK_S, self.config)
            reasons |= dict.fromkeys(tick_reasons)
            self._drive_motors()
            self._client.stepSimulation()
            self._cut_when_closed()
        self._ticks += ticks
        self._observe_fruit()
        self._reasons = tuple(str(r) for r in reasons)
        return self.state()

    def state(self) -> RobotState:
        """The robot as it stands."""
        xyz, quaternion = self._client.getBasePositionAndOrientation(self._robot)
        velocity, spin = self._client.getBaseVelocity(self._robot)
        R = self._client.getMatrixFromQuaternion(quaternion)
        joints = self._client.getJointStates(self._robot, self._all_joints)
        s = self._setpoints
        return RobotState(
            sim_time_s=self._ticks * TICK_S,
            base_x_m=xyz[0],
            base_y_m=xyz[1],
            base_yaw_rad=self._client.getEulerFromQuaternion(quaternion)[2],
            drive_m_s=velocity[0] * R[0] + velocity[1] * R[3],
            turn_rad_s=spin[2],
            joint_rad={name: state[0] for name, state in zip((*JOINTS, *WHEELS), joints, strict=True)},
            target_rad=dict(zip(JOINTS, s.position, strict=True)),
            gripper_open=s.gripper_open,
            cutter_closed=s.cutter_closed,
            spray_on=s.spray_on,
            liquid=s.liquid,
            estop=s.estop,
            reasons=self._reasons,
            fruits=self._crops.report(),
            moved=self._crops.moved(),
        )

    def reset(self) -> RobotState:
        """Back to the start, as newly built: the same commands give the same states again."""
        self._client.resetSimulation()
        self._start()
        return self.state()

    def estop(self) -> RobotState:
        """Latch the emergency stop: from the next tick on all motion brakes and no command is followed."""
        self._setpoints = latch_estop(self._setpoints, True)
        return self.state()

    def estop_reset(self) -> RobotState:
        """Release the emergency stop; the robot stays where it is until the next command."""
        self._setpoints = latch_estop(self._setpoints, False)
        return self.state()

    def head_camera_rgb(self, width: int = 320, height: int = 240) -> npt.NDArray[np.uint8]:
        """What the head camera sees, (height, width, 3) uint8 RGB, rendered in software."""
        link = self._client.getLinkState(self._robot, self._links["head_camera"], computeForwardKinematics=True)
        R = np.array(self._client.getMatrixFromQuaternion(link[5])).reshape(3, 3)
        view = view_matrix(link[4], R)
        projection = projection_matrix(self.config.body.head_fov_rad, width, height)
        return self.render_rgb(view, projection, width, height)

    def render_rgb(
        self, view: npt.NDArray[np.float64], projection: npt.NDArray[np.float64], width: int, height: int
    ) -> npt.NDArray[np.uint8]:
        """Render with OpenGL view and projection matrices (4, 4): (height, width, 3) uint8 RGB."""
        _, _, rgba, depth, _ = self._client.getCameraImage(
            width,
            height,
            view.T.ravel().tolist(),
            projection.T.ravel().tolist(),
            renderer=pybullet.ER_TINY_RENDERER,
            lightDirection=[0.4, 0.3, 1.0],
            lightAmbientCoeff=0.62,
            lightDiffuseCoeff=0.45,
            lightSpecularCoeff=0.05,
            shadow=0,
            flags=pybullet.ER_NO_SEGMENTATION_MASK,
        )
        image = np.ascontiguousarray(np.reshape(rgba, (height, width, 4))[:, :, :3].astype(np.uint8))
        nothing = np.reshape(depth, (height, width)) >= 1.0 - 1e-6
        image[nothing] = SKY_RGB
        return image

    def close(self) -> None:
        """Free the simulation; the world cannot be used afterwards."""
        self._client.disconnect()

    def _start(self) -> None:
        self._setpoints = home_setpoints(self.config)
        self._heading = Heading(0.0)
        self._ticks = 0
        self._carried_s = 0.0
        self._reasons = ()
        client = self._client
        client.setGravity(0.0, 0.0, -9.81)
        client.setPhysicsEngineParameter(fixedTimeStep=TICK_S, numSolverIterations=50, deterministicOverlappingPairs=1)
        self._load_scenery()
        self._load_robot()
        self._crops = Crops(client, self._greenhouse.fruits, self.config.tool)
        self._blades_closed = False
        # the chassis settles on its tracks before anybody looks
        for _ in range(TICK_HZ // 4):
            self._drive_motors()
            client.stepSimulation()

    def _load_scenery(self) -> None:
        client = self._client
        # bodies that only collide get a speck under the floor as their look, or PyBullet draws the collision shape
        hidden = client.createVisualShape(
            pybullet.GEOM_BOX, halfExtents=[1e-4] * 3, visualFramePosition=[0.0, 0.0, -1.0]
        )
        floor = client.createMultiBody(0.0, client.createCollisionShape(pybullet.GEOM_PLANE), hidden)
        client.changeDynamics(floor, -1, lateralFriction=1.0)
        boxes = solid(self._greenhouse.parts)
        shape = client.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_BOX] * len(boxes),
            halfExtents=[[0.5 * s for s in b.size_m] for b in boxes],
            collisionFramePositions=[b.xyz_m for b in boxes],
        )
        self._obstacles = client.createMultiBody(0.0, shape, hidden)
        for mesh in self._meshes:
            look = client.createVisualShape(
                pybullet.GEOM_MESH,
                vertices=mesh.vertices_m.tolist(),
                indices=mesh.triangles.ravel().tolist(),
                normals=mesh.normals.tolist(),
                uvs=np.zeros((len(mesh.vertices_m), 2)).tolist(),
                rgbaColor=mesh.rgba,
            )
            client.createMultiBody(0.0, baseVisualShapeIndex=look)

    def _load_robot(self) -> None:
        client = self._client
        with TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            path.write_text(self.urdf)
            flags = pybullet.URDF_USE_INERTIA_FROM_FILE | pybullet.URDF_USE_MATERIAL_COLORS_FROM_MTL
            self._robot = client.loadURDF(str(path), [0.0, 0.0, 0.0], flags=flags)
        infos = [client.getJointInfo(self._robot, i) for i in range(client.getNumJoints(self._robot))]
        joints = {info[1].decode(): info[0] for info in infos}
        self._links = {info[12].decode(): info[0] for info in infos}
        self._servos = [joints[name] for name in JOINTS]
        self._wheels = [joints[name] for name in WHEELS]
        self._all_joints = [*self._servos, *self._wheels]
        self._efforts = [axis.limits.effort for axis in axes(self.config)]
        self._gains = [self.config.position_gain] * len(JOINTS)
        self._ones = [1.0] * len(JOINTS)
        for axis, joint in zip(axes(self.config), self._servos, strict=True):
            client.resetJointState(self._robot, joint, axis.home)
        chassis = self.config.chassis
        self._wheel_efforts = [chassis.motor_nm / 3.0] * len(WHEELS)

    def _cut_when_closed(self) -> None:
        closed = self._setpoints.position[CUTTER] >= self.config.tool.cutter.upper
        if closed and not self._blades_closed:
            self._crops.cut(self._tool_pose("right_tool"))
        self._blades_closed = closed

    def _observe_fruit(self) -> None:
        index = self._crops.index
        contacts = [
            FruitContact(index[p[2]], p[3], p[9])
            for p in self._client.getContactPoints(self._robot)
            if p[2] in index and p[9] > 0.0
        ]
        fingers = (self._links["gripper_left_link"], self._links["gripper_right_link"])
        self._crops.observe(contacts, fingers, self._tool_pose("left_tool"))

    def _tool_pose(self, link: str) -> ToolPose:
        state = self._client.getLinkState(self._robot, self._links[link], computeForwardKinematics=True)
        return ToolPose(np.array(state[4]), np.array(self._client.getMatrixFromQuaternion(state[5])).reshape(3, 3))

    def _away_from_contacts(self, goals: Goals) -> Goals:
        points = self._client.getContactPoints(self._robot, self._obstacles)
        # PyBullet's normal points from the obstacle to the robot; points ahead of a touch do not count yet
        touches = [Touch(p[5][0], p[5][1], p[7][0], p[7][1]) for p in points if p[8] <= 0.0]
        if not touches:
            return goals
        xyz, quaternion = self._client.getBasePositionAndOrientation(self._robot)
        return away_from(touches, goals, xyz[0], xyz[1], self._client.getEulerFromQuaternion(quaternion)[2])

    def _drive_motors(self) -> None:
        client, s = self._client, self._setpoints
        client.setJointMotorControlArray(
            self._robot,
            self._servos,
            pybullet.POSITION_CONTROL,
            targetPositions=s.position,
            targetVelocities=s.velocity,
            forces=self._efforts,
            positionGains=self._gains,
            velocityGains=self._ones,
        )
        _, quaternion = client.getBasePositionAndOrientation(self._robot)
        yaw = client.getEulerFromQuaternion(quaternion)[2]
        chassis = self.config.chassis
        self._heading, left, right = track_speeds(self._heading, yaw, s.drive_m_s, s.turn_rad_s, TICK_S, chassis)
        r = chassis.wheel_radius_m
        client.setJointMotorControlArray(
            self._robot,
            self._wheels,
            pybullet.VELOCITY_CONTROL,
            targetVelocities=[left / r] * 3 + [right / r] * 3,
            forces=self._wheel_efforts,
        )
