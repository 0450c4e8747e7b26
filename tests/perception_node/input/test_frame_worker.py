"""The thread that processes frames, with a processing function of the test's own."""

from __future__ import annotations

import contextlib
import queue

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.perception_node.input import frame_worker
from semmap.nodes.perception_node.input.frame_worker import FrameWorker
from semmap.schemas.perception import DetectedMasks, MaskRun
from tests.conftest import PATIENCE_S
from tests.perception_node.input.test_frames import DEPTH

RESULT = object()


class Watched:
    """A worker that passes on what it was given and what it reports."""

    def __init__(self):
        self.looks = queue.Queue()
        self.complaints = queue.Queue()
        self.fails = False
        self.worker = FrameWorker(
            self._look,
            lambda clouds, found, duration_s: self.looks.put((clouds, self.masks, found, duration_s)),
            self.complaints.put,
        )

    def _look(self, clouds, masks):
        self.masks = masks
        if self.fails:
            raise ZeroDivisionError("nothing to divide by")
        return RESULT

    def show(self, stamp_ns, depth_m=1.0, camera="left", content=None, **changes):
        depth = structs.replace(DEPTH, camera=camera, stamp_ns=stamp_ns, **changes)
        pixels = (
            np.full((depth.height, depth.width), depth_m, "<f4").tobytes() if content is None else content
        )
        colour = structs.replace(depth, encoding="rgb8")
        self.worker.keep(colour, lambda: bytes(3 * depth.width * depth.height))
        self.worker.keep(depth, lambda: pixels)

    def next_look(self):
        return self.looks.get(timeout=PATIENCE_S)

    def next_complaint(self):
        return self.complaints.get(timeout=PATIENCE_S)


@pytest.fixture
def watched(monkeypatch):
    monkeypatch.setattr(frame_worker, "_TAKE_S", 0.01)  # the worker ends sooner
    watched = Watched()
    with contextlib.closing(watched.worker):
        yield watched
    assert watched.complaints.empty()


def test_a_frame_is_processed_and_its_result_passed_on_with_the_time_it_took(watched):
    watched.show(1)
    (cloud,), masks, found, duration_s = watched.next_look()
    assert (cloud.camera, cloud.stamp_ns, masks) == ("left", 1, [None])
    assert cloud.points_camera[0, 0, 2] == 1.0
    assert found is RESULT
    assert 0.0 <= duration_s < PATIENCE_S


def test_an_invalid_frame_is_reported_and_the_next_one_processed(watched):
    watched.show(1, content=b"short")
    assert "camera left: 5 bytes are not a depth32f image" in watched.next_complaint()
    watched.show(2)
    assert watched.next_look()[0][0].stamp_ns == 2
    assert watched.looks.empty()


def test_a_frame_with_an_older_stamp_is_reported(watched):
    watched.show(2)
    watched.next_look()
    watched.show(1)
    for _ in ("rgb8", "depth32f"):
        assert "camera left: frame ignored: its stamp is not newer" in watched.next_complaint()


def test_a_failure_is_reported_and_the_next_frame_processed(watched):
    watched.fails = True
    watched.show(1)
    assert watched.next_complaint() == "processing a frame failed: ZeroDivisionError: nothing to divide by"
    watched.fails = False
    watched.show(2)
    assert watched.next_look()[0][0].stamp_ns == 2


def test_a_camera_without_valid_depth_is_reported_and_its_frame_still_processed(watched):
    watched.show(1, depth_m=0.0)
    assert watched.next_complaint() == "camera left has no depth values from 0.01 to 100 m"
    assert watched.next_look()[0][0].measured == 0


def test_a_large_image_is_reduced_and_that_is_reported(watched):
    watched.show(
        1, width=1280, height=960, intrinsics=(1000.0, 0.0, 640.0, 0.0, 1000.0, 480.0, 0.0, 0.0, 1.0)
    )
    assert watched.next_complaint() == "camera left: 1280 x 960 pixels reduced by a factor of 2"
    assert watched.next_look()[0][0].points_camera.shape == (480, 640, 3)


def masks(stamp_ns, width=64):
    run = MaskRun(size=(48, width), label="Cup", score=0.9, counts=(0, 48, 48 * (width - 1)))
    return DetectedMasks(camera="left", stamp_ns=stamp_ns, width=width, height=48, masks=(run,))


def test_a_frame_is_processed_with_its_detectors_masks(watched):
    watched.worker.keep_masks(masks(1))
    watched.show(2)
    watched.worker.keep_masks(masks(2))
    _, (found,), _, _ = watched.next_look()
    assert found is not None
    assert found.labels.sum() == 48


def test_invalid_masks_are_reported_and_the_frame_is_processed_without_them(watched):
    watched.worker.keep_masks(masks(1))
    watched.show(2)
    watched.worker.keep_masks(masks(2, width=32))
    assert "camera left: masks ignored: they are of 32 x 48 pixels" in watched.next_complaint()
    assert watched.next_look()[1] == [None]


def test_masks_of_no_frame_are_reported(watched):
    watched.worker.keep_masks(masks(1))
    watched.worker.keep_masks(masks(2))
    assert "camera left: masks ignored: no frame with their stamp_ns" in watched.next_complaint()
