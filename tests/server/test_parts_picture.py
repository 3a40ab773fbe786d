"""Body parts as a picture: colours where the forest looked, nothing elsewhere, sides in different families."""

import cv2
import numpy as np

from server.engine.parts_picture import PALETTE, parts_packet, parts_picture
from server.images_wire import ImageKind
from teleop.body.parts import MIRROR_PART, N_PARTS, PART_NAMES
from teleop.skeleton import BodyParts


def answer(u: list[int], v: list[int], labels: list[int], stride: int) -> BodyParts:
    n = len(u)
    probability = np.full((n, N_PARTS), 0.1, np.float32)
    probability[np.arange(n), labels] = 0.9
    return BodyParts(np.array(u, np.int32), np.array(v, np.int32), np.zeros((n, 3), np.float32), probability, stride)


def test_every_pixel_has_the_colour_of_its_likeliest_part() -> None:
    picture = parts_picture(answer([0, 4, 318], [0, 2, 238], [0, 5, 29], 2), 320, 240)
    assert picture.shape == (120, 160, 4)
    assert np.array_equal(picture[0, 0], PALETTE[0])
    assert np.array_equal(picture[1, 2], PALETTE[5])
    assert np.array_equal(picture[119, 159], PALETTE[29])
    assert int((picture[:, :, 3] > 0).sum()) == 3


def test_nobody_is_a_clear_picture() -> None:
    assert not parts_picture(None, 640, 480).any()


def test_the_packet_is_a_png_with_clear_pixels() -> None:
    packet = parts_packet(answer([8], [8], [3], 4), 320, 240, 7)
    assert (packet.kind, packet.width, packet.height, packet.seq) == (ImageKind.PARTS, 80, 60, 7)
    decoded = cv2.imdecode(np.frombuffer(packet.jpeg, np.uint8), cv2.IMREAD_UNCHANGED)
    assert decoded is not None
    assert np.array_equal(decoded[2, 2], PALETTE[3]) and not decoded[0, 0].any()


def test_right_and_left_are_told_apart_and_no_two_parts_of_a_side_are_alike() -> None:
    for i, j in enumerate(MIRROR_PART):
        if i != j:
            assert np.abs(PALETTE[i].astype(int) - PALETTE[j].astype(int)).max() > 60, PART_NAMES[i]
    assert len(np.unique(PALETTE, axis=0)) == N_PARTS
