"""Pictures of the world, rendered in software."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pybullet

from robot_sim.world.client import Client

SKY_RGB = (214, 226, 230)
"""Diffuse glass behind everything."""


def render_rgb(
    client: Client, view: npt.NDArray[np.float64], projection: npt.NDArray[np.float64], width: int, height: int
) -> npt.NDArray[np.uint8]:
    """Render with OpenGL view and projection matrices (4, 4): (height, width, 3) uint8 RGB."""
    _, _, rgba, depth, _ = client.getCameraImage(
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
    # PyBullet clears to white: whatever has no depth is sky
    image[np.reshape(depth, (height, width)) >= 1.0 - 1e-6] = SKY_RGB
    return image
