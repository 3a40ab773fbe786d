"""One physics server of its own for every world."""

from __future__ import annotations

from functools import partial
from typing import Any

import pybullet


class Client:
    """PyBullet's functions, bound to one private server without a window.

    Does what pybullet_utils' BulletClient does, but binds every function only once (a tick calls four of them) and
    prints nothing on connecting.
    """

    def __init__(self) -> None:
        self._id: int = pybullet.connect(pybullet.DIRECT)

    def __getattr__(self, name: str) -> Any:
        function = partial(getattr(pybullet, name), physicsClientId=self._id)
        setattr(self, name, function)
        return function
