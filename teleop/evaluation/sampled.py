"""The sampler's own test split: people, clothes and recorded motions apart from training, the same wide variety."""

from __future__ import annotations

from dataclasses import dataclass, replace

from teleop.evaluation.cases import Case
from teleop.people.sampling import SampleSpec, sample_frame

PER_BATCH = 10


@dataclass(frozen=True, slots=True)
class Sampled:
    """Extreme poses included; every second frame mirrored. room: in a furnished room, else cut out with the faults
    of a segmentation."""

    width: int = 640
    height: int = 480
    room: bool = False

    def batch(self, index: int) -> list[Case]:
        """Frames PER_BATCH * index and on. Raises DataError without the MakeHuman files."""
        out = []
        for seed in range(PER_BATCH * index, PER_BATCH * (index + 1)):
            spec = SampleSpec("test", self.width, self.height, self.room, mirrored=bool(seed % 2))
            s = sample_frame(seed, spec)
            out.append(Case(replace(s.frame, t_ns=0), s.joints_m, s.visible, s.part, group=seed))
        return out
