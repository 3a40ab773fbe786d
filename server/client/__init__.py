"""A typed Python client of the API, blocking and asynchronous: read the state, operate the robot, follow the stream.

with TeleopClient() as robot:
    robot.open("greenhouse_demo", loop=False)
    for state in robot.states():
        print(state.angles.theta1_right)

async with AsyncTeleopClient("https://greenhouse:8000", token="gt_operator_...") as robot:
    async for state in robot.states():
        ...
"""

from server.client.async_client import AsyncTeleopClient
from server.client.show import Jpeg, columns
from server.client.sync_client import TeleopClient

__all__ = ["AsyncTeleopClient", "Jpeg", "TeleopClient", "columns"]
