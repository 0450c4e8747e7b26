import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.extern.ros.detections import observations_of
from semmap.nodes.extern.ros.frames import Frames
from semmap.nodes.extern.ros.messages import detections
from semmap.schemas import errors
from semmap.schemas.entities import angle_rad, distance_m
from tests.extern.ros.made import AT, thing, transforms

NUMBERS = st.floats(-50, 50)


def read(message, base="map", *links):
    frames = Frames()
    if links:
        frames.take(transforms(*links), static=True)
    return observations_of(message, frames, base).observations


@given(at=st.tuples(NUMBERS, NUMBERS, NUMBERS), yaw=st.floats(-3.1, 3.1))
def test_published_detections_can_be_read_back(at, yaw):
    told = thing(at=at, yaw=yaw, probability=0.75)
    (seen,) = read(detections([told], AT))
    assert distance_m(seen.pose, told.pose) < 1e-6
    assert angle_rad(seen.pose, told.pose) < 1e-5
    assert (seen.class_, seen.probability, seen.size_m) == ("Cup", 0.75, told.size_m)


def test_another_frame_is_gone_by():
    (seen,) = read(detections([thing()], AT), "world", ("map", "world", (10, 0, 0)))
    assert seen.pose.position_m == pytest.approx((11, 2, 0.7))


def test_the_likeliest_hypothesis_is_its_class():
    said = detections([thing()], AT)
    other = detections([thing(class_="Bowl", probability=0.9)], AT).detections[0].results[0]
    said.detections[0].results[0].hypothesis.score = 0.4
    said.detections[0].results.append(other)
    (seen,) = read(said)
    assert (seen.class_, seen.candidates) == ("Bowl", {"Cup": 0.4, "Bowl": 0.9})


def test_without_a_size_or_a_hypothesis_there_is_nothing_to_see():
    said = detections([thing(size_m=None), thing()], AT)
    said.detections[1].results.clear()
    assert read(said) == ()


def test_an_unknown_frame_is_named():
    with pytest.raises(errors.BadRequest, match="frame 'map' has no parent"):
        read(detections([thing()], AT), "world")


def test_too_many_are_refused():
    with pytest.raises(errors.BadRequest, match="1001 detections in a message; the maximum is 1000"):
        read(detections([thing()] * 1001, AT))
