"""What a recording was made with, so that a replay knows whether it may expect the very same bits."""

from __future__ import annotations

import hashlib
from dataclasses import fields

import numpy as np

from teleop.body.model import BodyModel


def model_digest(model: BodyModel) -> str:
    """SHA-256 of all a body model computes with; its provenance does not count."""
    digest = hashlib.sha256()
    for field in fields(model):
        if field.name == "meta":
            continue
        value = np.asarray(getattr(model, field.name))
        digest.update(f"{field.name} {value.dtype.str} {value.shape}\n".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    return digest.hexdigest()
