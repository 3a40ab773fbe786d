"""The body tracker: one depth frame and a state in, one track and the next state out."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from teleop.body.assemble import assemble
from teleop.body.bones import Bones, known_lengths, learn, straighten, unknown_bones
from teleop.body.cascade import Placed, begin, settle, trust
from teleop.body.features import operator_pixels, pad_image, working_step
from teleop.body.filter import FilterState, empty_state, filter_step
from teleop.body.forest import infer, stride_for
from teleop.body.grid import Window
from teleop.body.layers import one_thread_products
from teleop.body.model import BodyModel
from teleop.body.person import person_features, person_probability
from teleop.body.proportions import NOBODYS_M, in_proportion
from teleop.body.segmentation import Candidate, Scene, candidate, grid_mask, look, rank, window_round
from teleop.body.unbend import unbend
from teleop.body.votes import Proposals, propose, vote_weights
from teleop.config.body import BodyConfig
from teleop.frames import Camera, DepthFrame
from teleop.skeleton import BodyParts, FloorPlane, Skeleton, Track

NS: float = 1e9


@dataclass(frozen=True, slots=True, eq=False)
class TrackerState:
    """What the tracker carries from frame to frame. t_ns, cells and centre_m are None before the first person; bones
    are the operator's."""

    t_ns: int | None
    camera: Camera | None
    floor: FloorPlane | None
    cells: npt.NDArray[np.bool_] | None
    centre_m: npt.NDArray[np.float64] | None
    bones: Bones
    filter: FilterState


@dataclass(frozen=True, slots=True, eq=False)
class Single:
    """The answer for one candidate in one frame: joints (20, 3), confidence (20,), and what they come from."""

    joints_m: npt.NDArray[np.float64]
    confidence: npt.NDArray[np.float64]
    parts: BodyParts
    forest_m: npt.NDArray[np.float64]
    proposals: Proposals
    placed: Placed | None


class BodyTracker:
    """Depth frames to skeletons. Pure: all memory is in TrackerState, all time in the frames.

    Parameters: model (load_model), config (every threshold).
    """

    def __init__(self, model: BodyModel, config: BodyConfig) -> None:
        self.model = model
        self.config = config
        self._weight_of = vote_weights(config.proposals)
        self._max_offset_m = model.max_offset_m
        self._second = ThreadPoolExecutor(1, "tracker-beside")
        one_thread_products()

    def initial_state(self) -> TrackerState:
        """The state before the first frame."""
        return TrackerState(None, None, None, None, None, unknown_bones(), empty_state())

    def step(self, frame: DepthFrame, state: TrackerState) -> tuple[Track, TrackerState]:
        """Track one frame. Equal frames and states give equal results, bit for bit."""
        state, dt_s = self._continue(frame, state)
        reset = dt_s is None
        window = self._window(frame, state, dt_s)
        scene = self._look(frame, state.floor, window)
        state = replace(state, t_ns=frame.t_ns, camera=frame.camera, floor=scene.floor)
        picked = self._pick(frame, scene, state)
        if picked is None and window is not None:
            scene = self._look(frame, state.floor, None)
            picked = self._pick(frame, scene, state)
        if picked is None:
            lost = replace(state, cells=None, centre_m=None, bones=unknown_bones(), filter=empty_state())
            return Track(frame.t_ns, None, None, scene.floor, None, None, reset), lost
        found, single, fresh = picked
        if fresh:
            state = replace(state, bones=unknown_bones(), filter=empty_state())
        single, bones = self._constant(single, state.bones)
        skeleton, filter_state = self._smooth(frame.t_ns, single, dt_s, state.filter)
        cut = fresh and state.centre_m is not None and self.config.filter.enabled
        track = Track(frame.t_ns, skeleton, single.parts, scene.floor, found.mask, found.box, reset or cut)
        cells = grid_mask(found, scene.grid.step)
        return track, replace(state, cells=cells, centre_m=found.centre_m, bones=bones, filter=filter_state)

    def _pick(self, frame: DepthFrame, scene: Scene, state: TrackerState) -> tuple[Candidate, Single, bool] | None:
        """The operator among the scene's surfaces, and whether it is a new one. None: nobody.

        The one who was there is kept as long as joints are found; else the first who is certainly a person is taken,
        else the likeliest of all.
        """
        best: tuple[Candidate, Single, bool] | None = None
        most = self.config.person.acquire
        before = state.centre_m if self.config.filter.enabled else None
        for label in rank(scene, state.cells if before is not None else None, self.config.segmentation):
            found = candidate(frame, scene, label, self.config.segmentation)
            if found is None or found.person < self.config.person.min_cells:
                continue
            moved_m = np.inf if before is None else float(np.linalg.norm(found.centre_m - before))
            near = moved_m <= self.config.scene_cut_m
            if near:
                single = self.estimate(frame, found, state.filter.joints_m, self._arm(state.bones))
            else:
                single = self.estimate(frame, found, None)
            if near and float(single.confidence.mean()) >= self.config.person.keep:
                return found, single, False
            person = person_probability(self.cues(frame, found, single), self.model.person_weights)
            if person >= self.config.person.certain:
                return found, single, True
            if person >= most:
                best, most = (found, single, True), person
        return best

    def estimate(
        self,
        frame: DepthFrame,
        found: Candidate,
        previous_m: npt.NDArray[np.float64] | None,
        arm_m: npt.NDArray[np.float64] = NOBODYS_M,
    ) -> Single:
        """Joints of one candidate from this frame alone, helped by the last joints and the lengths of the operator's
        own arm (2,) where given."""
        model, camera, config = self.model, frame.camera, self.config
        cascade, begun, placed = model.cascade, None, None
        if cascade is not None:
            # the networks begin on the second core while the forest runs on this one
            whole = operator_pixels(frame.depth_mm, found.mask, found.box, camera)
            begun = begin(cascade, whole, config.cascade.rounds, self._second)
        step = working_step(camera, config.forest.working_focal_px)
        image = pad_image(frame.depth_mm, found.mask, found.box, camera, self._max_offset_m, step)
        stride = stride_for(found.area_px // step**2, config.forest.max_pixels)
        parts, leaves = infer(model, image, stride, step, camera.mirrored)
        proposals = propose(model, parts.points_m, leaves, stride, image.fx, self._weight_of, config.proposals)
        forest_m, confidence = assemble(proposals, model.bones_m, previous_m, config.skeleton)
        joints = forest_m
        if cascade is not None and begun is not None:
            placed = settle(cascade, whole, begun, forest_m, config.cascade.rounds, self._second)
            if config.cascade.enabled:
                confidence = trust(placed.cues, cascade.trust)
                sure = confidence >= config.cascade.min_confidence
                joints = np.where(sure[:, None], placed.joints_m, np.nan)
                joints = in_proportion(joints, placed.spread_m, model.bones_m, arm_m, config.proportions)
                joints = unbend(joints, placed.spread_m, config.elbow)
        return Single(joints, confidence, parts, forest_m, proposals, placed)

    def cues(self, frame: DepthFrame, found: Candidate, single: Single) -> npt.NDArray[np.float64]:
        """What tells whether a candidate is a person at all, see teleop.body.person."""
        focal_px = frame.camera.depth.fx
        return person_features(
            single.parts, single.proposals, single.forest_m, single.placed, found.person, self.model.bones_m, focal_px
        )

    def warm_up(self, camera: Camera) -> None:
        """Compile every kernel by tracking a standing shape on a floor, so that the first real frame is quick.

        The finder does not take the shape for a person, so all that follows it is compiled by a tracker that tracks
        whatever stands there.
        """
        person = self.config.person.model_copy(update={"acquire": 0.0, "keep": 0.0, "min_cells": 0.0})
        cascade = self.config.cascade.model_copy(update={"finder": False})
        anything = BodyTracker(self.model, self.config.model_copy(update={"person": person, "cascade": cascade}))
        depth_mm = _standing_shape(camera)
        for tracker in (self, anything):
            state = tracker.initial_state()
            for t_ns in (0, 33_000_000, 66_000_000):
                _, state = tracker.step(DepthFrame(t_ns, depth_mm, camera), state)

    def _look(self, frame: DepthFrame, floor: FloorPlane | None, window: Window | None) -> Scene:
        """The frame's surfaces, the finder beside the floor."""
        finder = self.model.finder if self.config.cascade.finder else None
        return look(frame, floor, finder, self.config.floor, self.config.segmentation, self._second, window)

    def _window(self, frame: DepthFrame, state: TrackerState, dt_s: float | None) -> Window | None:
        """Where the operator may be by now; None where nobody was."""
        if dt_s is None or state.cells is None or state.centre_m is None or not self.config.filter.enabled:
            return None
        return window_round(state.cells, float(state.centre_m[2]), dt_s, frame.camera, self.config.segmentation)

    def _continue(self, frame: DepthFrame, state: TrackerState) -> tuple[TrackerState, float | None]:
        """The state to go on from and the seconds since; None at a new beginning (gap, time back, other camera)."""
        if state.t_ns is None:
            return self.initial_state(), None
        gap_s = (frame.t_ns - state.t_ns) / NS
        if not 0 < gap_s <= self.config.max_gap_s or frame.camera != state.camera:
            return self.initial_state(), None
        return state, gap_s

    def _constant(self, single: Single, bones: Bones) -> tuple[Single, Bones]:
        """The answer with the operator's own bone lengths, and what is known of them now."""
        config = self.config.bones
        if single.placed is None or not (config.enabled and self.config.filter.enabled):
            return single, bones
        spread_m = single.placed.spread_m
        bones = learn(bones, single.joints_m, spread_m, config)
        return replace(single, joints_m=straighten(single.joints_m, spread_m, bones, config)), bones

    def _arm(self, bones: Bones) -> npt.NDArray[np.float64]:
        """What is known of the lengths of the operator's upper arm and forearm (2,)."""
        return known_lengths(bones, self.config.bones)[: len(NOBODYS_M)]

    def _smooth(
        self, t_ns: int, single: Single, dt_s: float | None, state: FilterState
    ) -> tuple[Skeleton, FilterState]:
        """The skeleton after the temporal filter, or as it is where the filter is off."""
        if not self.config.filter.enabled:
            return Skeleton(t_ns, single.joints_m, single.confidence), state
        # at a new beginning every joint is unknown and the interval has no effect
        interval_s = self.config.max_gap_s if dt_s is None else dt_s
        joints, confidence, state = filter_step(
            single.joints_m, single.confidence, interval_s, state, self.config.filter
        )
        return Skeleton(t_ns, joints, confidence), state


def _standing_shape(camera: Camera) -> npt.NDArray[np.uint16]:
    """Depth [mm] (h, w) of a board as wide and high as a person, 2 m before a level camera 1 m above a floor."""
    k = camera.depth
    v, u = np.mgrid[: k.height, : k.width]
    with np.errstate(divide="ignore"):
        floor_mm = np.where(v > k.cy, 1000.0 * k.fy / (v - k.cy), np.inf)
    board = (abs(u - k.cx) < 0.12 * k.fx) & (v > k.cy - 0.4 * k.fy)
    depth_mm = np.minimum(floor_mm, np.where(board, 2000.0, np.inf))
    return np.where(depth_mm < 6000.0, depth_mm, 0.0).astype(np.uint16)
