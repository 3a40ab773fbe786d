"""Take the lease and pick fruit with the assisted pick: ask, drive where the robot says, look on until it is over.

python examples/drive_to_pick.py --fruit cucumber_4_fruit_0
python examples/drive_to_pick.py --count 2        # the nearest ripe ones

Every motion passes the same limits as the operator's; the emergency stop of any console ends it.
"""

from __future__ import annotations

import argparse
import asyncio

from server import wire
from server.client import AsyncTeleopClient
from server.errors import ServerError

TIMEOUT_S = 60.0
NEAR_M = 0.03
"""A planned pick makes up for this."""


async def drive(robot: AsyncTeleopClient, forward_m: float) -> None:
    """Drive straight on. The speed is repeated: a client that falls silent stops the chassis."""
    goal_m = (await robot.state()).robot.base.x + forward_m
    async with asyncio.timeout(TIMEOUT_S):
        while abs(left_m := goal_m - (await robot.state()).robot.base.x) > NEAR_M:
            await robot.command(drive_m_s=max(-0.4, min(0.4, 1.5 * left_m)), for_s=0.25)
            await asyncio.sleep(0.05)
        while abs((await robot.state()).robot.drive_m_s) > 0.01:
            await asyncio.sleep(0.05)


async def pick(robot: AsyncTeleopClient, fruit: str | None) -> wire.TaskState:
    """One assisted pick; when the fruit is out of reach, the robot drives there first. Raises ServerError."""
    task = await robot.pick(fruit)
    if task.status == "refused" and task.forward_m is not None:
        print(f"{task.fruit}: {task.detail}")
        await drive(robot, task.forward_m)
        task = await robot.pick(task.fruit)
    stage = None
    async with asyncio.timeout(TIMEOUT_S):
        while task.ended is None:
            if task.stage != stage:
                stage = task.stage
                print(f"{task.fruit}: {stage}")
            await asyncio.sleep(0.1)
            task = await robot.task(task.id)
    if task.status != "succeeded":
        raise ServerError(f"{task.fruit} was not picked ({task.reason}): {task.detail or task.status}")
    return task


async def run(url: str, fruit: str | None, count: int) -> int:
    """The whole task; how many fruits are in the box at its end."""
    async with AsyncTeleopClient(url, name="drive to pick") as robot:
        access = await robot.request_lease()
        if not access.holds_lease:
            holder = access.lease.holder.name if access.lease.holder else "somebody"
            raise ServerError(f"{holder} is in control; ask them to hand over")
        await robot.disengage()  # the API picks while no operator is engaged
        for _ in range(count):
            await pick(robot, fruit)
        boxed = sum(f.status == "boxed" for f in await robot.fruits())
        await robot.release_lease()
    return boxed


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fruit", help="its name (GET /api/v1/fruits); the nearest ripe one by default")
    parser.add_argument("--count", type=int, default=1, help="how many, when none is named")
    parser.add_argument("--url", default="http://127.0.0.1:8000")
    given = parser.parse_args(arguments)
    boxed = asyncio.run(run(given.url, given.fruit, 1 if given.fruit else given.count))
    print(f"{boxed} in the box")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
