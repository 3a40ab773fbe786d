"""Take the lease, drive the robot along the row, and pick with its right arm: reach, close the gripper, cut, let go.

python examples/drive_to_pick.py --forward 0.5

Every motion passes the same limits as the operator's; the emergency stop of any console ends it.
"""

from __future__ import annotations

import argparse
import asyncio
import math
from collections.abc import Callable

from server import wire
from server.client import AsyncTeleopClient
from server.errors import ServerError

REACH = {"c1_deg": 60.0, "c2_deg": 15.0, "elbow_deg": 150.0}
REST = {"c1_deg": 0.0, "c2_deg": 0.0, "elbow_deg": 180.0}
TIMEOUT_S = 30.0


async def until(robot: AsyncTeleopClient, reached: Callable[[wire.State], bool]) -> wire.State:
    """The first state that is so. Raises ServerError under emergency stop, TimeoutError after half a minute."""
    async with asyncio.timeout(TIMEOUT_S):
        async for state in robot.states():
            if state.robot.estop:
                raise ServerError("the emergency stop was pressed; reset it in the console, then start again")
            if reached(state):
                return state
    raise ServerError("the server has ended")


async def drive(robot: AsyncTeleopClient, forward_m: float, speed_m_s: float = 0.25) -> float:
    """Drive straight on; how far it went [m]. The speed is repeated: a client that falls silent stops the chassis."""
    start = (await robot.state()).robot.base
    async with asyncio.timeout(TIMEOUT_S):
        while (gone_m := _distance_m(start, (await robot.state()).robot.base)) < abs(forward_m):
            await robot.command(drive_m_s=math.copysign(speed_m_s, forward_m), for_s=0.25)
            await asyncio.sleep(0.1)
    await until(robot, lambda s: abs(s.robot.drive_m_s) < 0.01)
    return gone_m


async def reach(robot: AsyncTeleopClient, arm: dict[str, float]) -> None:
    """Move the right arm there and wait until its servos have arrived."""
    await robot.command(right_arm=arm)
    wanted = {"right_c1": arm["c1_deg"], "right_c2": arm["c2_deg"]}
    await until(robot, lambda s: all(abs(math.degrees(s.robot.joints[j]) - deg) < 1.0 for j, deg in wanted.items()))


async def pick(robot: AsyncTeleopClient) -> None:
    """Reach out with an open gripper, close it, cut, and take the arm back."""
    await robot.command(gripper_open=True)
    await reach(robot, REACH)
    await robot.command(gripper_open=False)
    await until(robot, lambda s: not s.robot.gripper_open)
    await robot.command(cutter_closed=True)
    await until(robot, lambda s: s.robot.cutter_closed)
    await robot.command(cutter_closed=False)
    await reach(robot, REST)


async def run(url: str, forward_m: float) -> float:
    """The whole task; how far the robot drove [m]."""
    async with AsyncTeleopClient(url, name="drive to pick") as robot:
        access = await robot.request_lease()
        if not access.holds_lease:
            holder = access.lease.holder.name if access.lease.holder else "somebody"
            raise ServerError(f"{holder} is in control; ask them to hand over")
        await robot.disengage()  # arms and chassis obey the API while no operator is engaged
        gone_m = await drive(robot, forward_m)
        await pick(robot)
        await robot.release_lease()
    return gone_m


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--forward", type=float, default=0.5, help="how far to drive first [m]")
    parser.add_argument("--url", default="http://127.0.0.1:8000")
    given = parser.parse_args(arguments)
    print(f"drove {asyncio.run(run(given.url, given.forward)):.2f} m and picked")
    return 0


def _distance_m(a: wire.BasePose, b: wire.BasePose) -> float:
    return math.hypot(b.x - a.x, b.y - a.y)


if __name__ == "__main__":
    raise SystemExit(main())
