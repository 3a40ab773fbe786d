"""How sessions are recorded."""

from __future__ import annotations

from pydantic import Field

from teleop.config.base import Section


class RecordingConfig(Section):
    """Settings of the recorder; none of them changes what the robot does but ``color``."""

    color: bool = Field(
        default=True,
        description="record colour; off, it is neither recorded nor used nor shown while recording (privacy)",
    )
    jpeg_quality: int = Field(default=90, ge=30, le=100, description="JPEG quality of recorded colour")
    compression_level: int = Field(
        default=1, ge=-7, le=19, description="zstd level of the chunks; 1 takes half the time of 3 for 4 % more bytes"
    )
    flush_s: float = Field(
        default=0.5, ge=0.1, le=1.0, description="recording time after which a chunk is closed: what a crash loses [s]"
    )
    chunk_mb: int = Field(
        default=4,
        ge=1,
        le=64,
        description="largest chunk before compression [MB]; larger ones are not smaller on disk and slow a seek down",
    )
    queue_frames: int = Field(
        default=120,
        ge=4,
        le=600,
        description="frames held back while the disk stalls; 120 are 4 s at 30 frames/s, 180 MB at 640x480",
    )
