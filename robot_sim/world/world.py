"""The robot in its greenhouse row, stepped by PyBullet at 240 Hz from RobotCommands."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite

import numpy as np
import numpy.typing as npt

from robot_sim.actuators import JOINT_INDEX, JOINTS
from robot_sim.commands import Liquid, RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.errors import RobotError
from robot_sim.events import RobotEvent
from robot_sim.greenhouse import greenhouse, solid
from robot_sim.head_camera import projection_matrix, view_matrix
from robot_sim.limiter import Goals, Setpoints, advance, home_setpoints, latch_estop, resolve
from robot_sim.metrics import RunMetrics
from robot_sim.plants import Fruit
from robot_sim.primitives import Primitive
from robot_sim.reasons import RobotReason
from robot_sim.servo import driven, exact
from robot_sim.spray import LIQUIDS, SprayState, canopy, coverage, fresh, missed_share, spray, wet_share, wrong_share
from robot_sim.standing import standing_place
from robot_sim.start_config import Start
from robot_sim.state import RobotState
from robot_sim.urdf import robot_urdf
from robot_sim.urdf_parts_tools import NOZZLE_M
from robot_sim.world.arm_contacts import touching as arm_contacts
from robot_sim.world.body import ALL_JOINTS, RobotBody, motion, put
from robot_sim.world.client import Client
from robot_sim.world.contacts import Touch, away_from
from robot_sim.world.crops import Crops, FruitContact
from robot_sim.world.meshes import merge
from robot_sim.world.render import render_rgb
from robot_sim.world.run_log import RunLog, Touching, logged
from robot_sim.world.scene import Looks, load_floor, load_obstacles
from robot_sim.world.snapshot import FruitMoment, Snapshot
from robot_sim.world.tracks import Heading, track_speeds

TICK_HZ = 240
TICK_S = 1.0 / TICK_HZ
"""PyBullet's own default, on which its solver's settings rest."""
CUTTER = JOINT_INDEX["cutter"]
START_PERIOD_S, START_GAIN_1_S, START_PATIENCE_S, ARRIVED_M = 1.0 / 30.0, 2.0, 60.0, 0.003
"""How the robot goes to its place before a run begins."""


class World:
    """One simulated robot. Not thread-safe: one thread steps, reads and renders.

    config: dimensions and limits. seed: decides the crop and how droplets fly; the same seed and the same commands
    give bit-equal states.
    """

    _robot: RobotBody
    _obstacles: int
    _crops: Crops
    _setpoints: Setpoints
    _heading: Heading
    _spray: SprayState
    _ticks: int
    _carried_s: float
    _blades_closed: bool
    _reasons: tuple[str, ...]
    _driven: tuple[float, ...]
    _log: RunLog
    _cut: list[str]
    _missed_cut: bool

    def __init__(self, config: RobotConfig | None = None, seed: int = 0) -> None:
        self.config = config or RobotConfig()
        self.seed = seed
        self._greenhouse = greenhouse(self.config.greenhouse, seed)
        self._canopy = canopy(self._greenhouse.leaves)
        self._looks = Looks(merge(self._greenhouse.parts))
        self._unripe = frozenset(f.name for f in self._greenhouse.fruits if not f.ripe)
        self._client = Client()
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
        goals, at_obstacle = self._away_from_contacts(resolve(command, self.config))
        self._cut, self._missed_cut = [], False
        reasons = dict.fromkeys(goals.reasons)
        spraying = 0
        for _ in range(ticks):
            self._setpoints, tick_reasons = advance(self._setpoints, goals, TICK_S, self.config)
            reasons |= dict.fromkeys(tick_reasons)
            self._tick()
            spraying += self._setpoints.spray_on
        self._ticks += ticks
        self._spray_for(spraying * TICK_S)
        self._observe_fruit()
        if self._setpoints.spray_on and not self._flows():
            reasons[RobotReason.TANK_EMPTY] = None
        touching = Touching(arm_contacts(self._client, self._robot) if ticks else self._log.touching.arms, at_obstacle)
        if touching.arms:
            reasons[RobotReason.ARM_CONTACT] = None
        status = self._crops.report()
        if any(not status.get(name, "").startswith(("held", "boxed")) for name in self._cut):
            reasons[RobotReason.NOT_HELD] = None
        if self._missed_cut:
            reasons[RobotReason.NOTHING_CUT] = None
        self._reasons = tuple(str(r) for r in reasons)
        state = self.state()
        work_j = self._robot.power_w() * ticks * TICK_S
        self._log = logged(self._log, state, work_j, touching, self._cut, self._unripe)
        return state

    @property
    def events(self) -> tuple[RobotEvent, ...]:
        """What happened in the last step."""
        return self._log.events

    def metrics(self) -> RunMetrics:
        """What the run has come to since the last reset."""
        full = self.config.spray.tank_l
        return replace(
            self._log.metrics,
            sprayed_l={str(q): full - level for q, level in zip(LIQUIDS, self._spray.tank_l, strict=True)},
            coverage={str(q): self.coverage(q, (-1e3,) * 3, (1e3,) * 3) for q in LIQUIDS},
            overspray=missed_share(self._spray),
            wrong_liquid=wrong_share(self._spray, self._canopy, self._greenhouse.diseased),
        )

    @property
    def diseased(self) -> frozenset[str]:
        """Names of the plants with mildew."""
        return self._greenhouse.diseased

    def state(self) -> RobotState:
        """The robot as it stands."""
        x, y, yaw = self._robot.where()
        moving = motion(self._client, self._robot.id)
        joints = self._robot.joints()
        s = self._setpoints
        return RobotState(
            sim_time_s=self._ticks * TICK_S,
            base_x_m=x,
            base_y_m=y,
            base_yaw_rad=yaw,
            drive_m_s=float(np.cos(yaw) * moving.velocity_m_s[0] + np.sin(yaw) * moving.velocity_m_s[1]),
            turn_rad_s=moving.spin_rad_s[2],
            joint_rad={name: q for name, (q, _) in zip(ALL_JOINTS, joints, strict=True)},
            target_rad=dict(zip(JOINTS, s.position, strict=True)),
            gripper_open=s.gripper_open,
            cutter_closed=s.cutter_closed,
            spray_on=s.spray_on and self._flows(),
            liquid=s.liquid,
            estop=s.estop,
            reasons=self._reasons,
            tank_l={str(liquid): level for liquid, level in zip(LIQUIDS, self._spray.tank_l, strict=True)},
            fruits=self._crops.report(),
            moved=self._crops.moved(),
        )

    def reset(self) -> RobotState:
        """Back to the start, as newly built: the same commands give the same states again."""
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

    def snapshot(self) -> Snapshot:
        """Keep this moment. The world goes on from it exactly as it will after :meth:`restore`.

        For that it is built anew from the snapshot's own numbers, which forgets the solver's warm start.
        """
        crops = self._crops
        fruits = zip(crops.motions(), crops.attached, crops.damaged, crops.status, strict=True)
        kept = Snapshot(
            config=self.config,
            seed=self.seed,
            robot=motion(self._client, self._robot.id),
            joints=tuple(self._robot.joints()),
            fruits=tuple(FruitMoment(*fruit) for fruit in fruits),
            setpoints=self._setpoints,
            heading=self._heading,
            spray=self._spray,
            ticks=self._ticks,
            carried_s=self._carried_s,
            blades_closed=self._blades_closed,
            reasons=self._reasons,
            driven=self._driven,
            log=self._log,
        )
        self.restore(kept)
        return kept

    def restore(self, snapshot: Snapshot) -> RobotState:
        """Back to a snapshot: the same commands give bit-equal states from there on, however often.

        Raises RobotError for a snapshot of a world with another configuration or seed.
        """
        if (snapshot.config, snapshot.seed) != (self.config, self.seed):
            raise RobotError(
                f"this snapshot belongs to another configuration or to seed {snapshot.seed}, not {self.seed}"
            )
        self._build()
        put(self._client, self._robot.id, snapshot.robot)
        self._robot.set_joints(list(snapshot.joints))
        self._crops.put([fruit.motion for fruit in snapshot.fruits])
        for i, fruit in enumerate(snapshot.fruits):
            self._crops.damaged[i] = fruit.damaged
            self._crops.status[i] = fruit.status
            if not fruit.attached:
                self._crops.detach(i)
        self._setpoints = snapshot.setpoints
        self._heading = snapshot.heading
        self._spray = snapshot.spray
        self._ticks = snapshot.ticks
        self._carried_s = snapshot.carried_s
        self._blades_closed = snapshot.blades_closed
        self._reasons = snapshot.reasons
        self._driven = snapshot.driven
        self._log = snapshot.log
        return self.state()

    def coverage(self, liquid: Liquid, low_m: npt.ArrayLike, high_m: npt.ArrayLike) -> float:
        """Share 0..1 of the leaf area between two corners (3,) [m] that is wet with a liquid."""
        return coverage(self._spray, self._canopy, liquid, low_m, high_m, self.config.spray)

    def wet_leaves(self) -> dict[str, tuple[float, float, float]]:
        """Leaf -> share 0..1 wet with water, nutrient and pesticide; leaves without a drop are left out."""
        hit = np.flatnonzero(self._spray.hits.any(axis=1))
        if len(hit) == 0:
            return {}
        wet = wet_share(self._spray, self._canopy, self.config.spray)[hit].round(3).tolist()
        return {self._canopy.names[i]: (a, b, c) for i, (a, b, c) in zip(hit, wet, strict=True)}

    def overspray(self, liquid: Liquid) -> float:
        """Share 0..1 of what was sprayed of a liquid that hit no leaf."""
        return missed_share(self._spray, liquid)

    def head_camera_rgb(self, width: int = 320, height: int = 240) -> npt.NDArray[np.uint8]:
        """What the head camera sees, (height, width, 3) uint8 RGB, rendered in software."""
        eye = self._robot.link_pose("head_camera")
        projection = projection_matrix(self.config.body.head_fov_rad, width, height)
        return self.render_rgb(view_matrix(eye.xyz_m, eye.R), projection, width, height)

    def render_rgb(
        self, view: npt.NDArray[np.float64], projection: npt.NDArray[np.float64], width: int, height: int
    ) -> npt.NDArray[np.uint8]:
        """Render with OpenGL view and projection matrices (4, 4): (height, width, 3) uint8 RGB."""
        return render_rgb(self._client, view, projection, width, height)

    def close(self) -> None:
        """Free the simulation; the world cannot be used afterwards."""
        self._client.disconnect()

    def _start(self) -> None:
        self._setpoints = home_setpoints(self.config)
        self._heading = Heading(0.0)
        self._spray = fresh(self._canopy, self.config.spray)
        self._ticks = 0
        self._carried_s = 0.0
        self._blades_closed = False
        self._reasons = ()
        self._driven = self._setpoints.position
        self._cut, self._missed_cut = [], False
        self._build()
        # the chassis settles on its tracks before anybody looks
        for _ in range(TICK_HZ // 4):
            self._tick()
        self._log = RunLog(self.state())
        if self.config.start != Start():
            self._go_to_start(self.config.start)

    def _go_to_start(self, start: Start) -> None:
        """On its own tracks and lift, as everything the robot does; none of it counts."""
        most, state = 0.5 * self.config.chassis.drive_m_s, self.state()
        x_m, lift_m = 0.0, state.joint_rad["lift"]
        if start.beside_fruit is not None:
            x_m, lift_m = standing_place(self._fruit(start.beside_fruit), self.config)
        limits = self.config.body.lift
        x_m, lift_m = x_m - start.off_m, min(max(lift_m + start.lift_off_m, limits.lower), limits.upper)
        while state.sim_time_s < START_PATIENCE_S:
            ahead = x_m - state.base_x_m
            there = abs(ahead) < ARRIVED_M and abs(state.drive_m_s) < ARRIVED_M
            if there and abs(state.joint_rad["lift"] - lift_m) < ARRIVED_M:
                break
            drive = 0.0 if abs(ahead) < ARRIVED_M else min(max(START_GAIN_1_S * ahead, -most), most)
            state = self.step(RobotCommand(t_ns=0, drive_m_s=drive, lift_m=lift_m), START_PERIOD_S)
        self._ticks, self._carried_s, self._reasons = 0, 0.0, ()
        self._log = RunLog(self.state())

    def _fruit(self, name: str) -> Fruit:
        fruit = next((f for f in self.fruits if f.name == name), None)
        if fruit is None:
            names = ", ".join(f.name for f in self.fruits)
            raise RobotError(f"robot.start: no fruit '{name}'; there are: {names}")
        return fruit

    def _build(self) -> None:
        client = self._client
        client.resetSimulation()
        client.setGravity(0.0, 0.0, -9.81)
        # Bullet's friction cone takes the outer wheels' low friction across the tracks for that of all directions
        client.setPhysicsEngineParameter(
            fixedTimeStep=TICK_S, numSolverIterations=50, deterministicOverlappingPairs=1, enableConeFriction=0
        )
        load_floor(client)
        self._obstacles = load_obstacles(client, solid(self._greenhouse.parts))
        self._looks.load(client)
        self._robot = RobotBody(client, self.config)
        self._crops = Crops(client, self._greenhouse.fruits, self.config.tool)

    def _tick(self) -> None:
        s, chassis = self._setpoints, self.config.chassis
        _, _, yaw = self._robot.where()
        self._heading, left, right = track_speeds(self._heading, yaw, s.drive_m_s, s.turn_rad_s, TICK_S, chassis)
        servo = self.config.servo
        self._driven = s.position if exact(servo) else driven(self._driven, s.position, servo)
        self._robot.follow(s, self._driven, left, right)
        self._client.stepSimulation()
        self._crops.press(self._touched())
        closed = s.position[CUTTER] >= self.config.tool.cutter.upper
        if closed and not self._blades_closed:
            parted = self._crops.cut(self._robot.link_pose("right_tool"))
            self._cut += [self.fruits[i].name for i in parted]
            self._missed_cut = not parted
        self._blades_closed = closed

    def _spray_for(self, dt_s: float) -> None:
        if dt_s == 0.0:
            return
        tool = self._robot.link_pose("rear_tool")
        # a stream of its own for every step: what is sprayed depends on the seed and the time alone
        rng = np.random.default_rng((self.seed, self._ticks))
        nozzle, R, config = tool.world((0.0, 0.0, -NOZZLE_M)), tool.R, self.config.spray
        self._spray = spray(self._spray, self._canopy, self._setpoints.liquid, nozzle, R, dt_s, rng, config)

    def _flows(self) -> bool:
        return self._spray.tank_l[LIQUIDS.index(self._setpoints.liquid)] > 0.0

    def _touched(self) -> list[FruitContact]:
        """What the robot presses against of the fruit."""
        index = self._crops.index
        points = self._client.getContactPoints(self._robot.id)
        return [FruitContact(index[p[2]], p[3], p[9]) for p in points if p[2] in index and p[9] > 0.0]

    def _observe_fruit(self) -> None:
        fingers = (self._robot.links["gripper_left_link"], self._robot.links["gripper_right_link"])
        self._crops.observe(self._touched(), fingers, self._robot.link_pose("left_box"))

    def _away_from_contacts(self, goals: Goals) -> tuple[Goals, bool]:
        points = self._client.getContactPoints(self._robot.id, self._obstacles)
        # PyBullet's normal points from the obstacle to the robot; points ahead of a touch do not count yet
        touches = [Touch(p[5][0], p[5][1], p[7][0], p[7][1]) for p in points if p[8] <= 0.0]
        if not touches:
            return goals, False
        return away_from(touches, goals, *self._robot.where()), True
