import re

import numpy as np
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from semmap.nodes.extern.ros.definitions import DEFINITIONS
from semmap.nodes.extern.ros.types import decode, encode, new, store, topic
from semmap.schemas import errors

OURS = sorted(DEFINITIONS)
BOUNDED = re.compile(r"\[<=\d+\]")
"""A sequence with a bound: zenoh-ros2-sdk 0.1.8 takes it for one without, and gets another hash."""
SPOKEN = [*OURS, "tf2_msgs/msg/TFMessage", "visualization_msgs/msg/MarkerArray", "sensor_msgs/msg/Image"]


@pytest.mark.parametrize("name", SPOKEN)
def test_an_empty_message_comes_back(name):
    assert encode(decode(encode(new(name)), name)) == encode(new(name))


@pytest.mark.parametrize("name", SPOKEN)
def test_another_party_computes_the_same_hash(name):
    from zenoh_ros2_sdk.utils import get_type_hash

    def text(of):
        return store().generate_msgdef(of, ros_version=2)[0].partition("=" * 80)[0]

    def needed(of, found):
        for inner in re.findall(r"^(\w+)/(\w+)", text(of), re.MULTILINE):
            full = "{}/msg/{}".format(*inner)
            if full not in found:
                found[full] = text(full)
                needed(full, found)
        return found

    texts = {name: text(name), **needed(name, {})}
    if any(BOUNDED.search(each) for each in texts.values()):
        texts = {each: BOUNDED.sub("[]", said) for each, said in texts.items()}
        ours = get_typestore(Stores.EMPTY)
        for each, said in texts.items():
            ours.register(get_types_from_msg(said, each))
        expected = ours.hash_rihs01(name)
    else:
        expected = store().hash_rihs01(name)
    assert get_type_hash(name, msg_definition=texts.pop(name), dependencies=texts) == expected


def test_a_hash_from_another_implementation():
    """As a client of rmw_zenoh written in another language has it."""
    known = "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"
    assert store().hash_rihs01("vision_msgs/msg/Detection3DArray") == known


def test_a_quaternion_begins_as_one():
    assert new("geometry_msgs/msg/Pose").orientation.w == 1.0


def test_arrays_of_numbers_are_numpys():
    assert new("geometry_msgs/msg/PoseWithCovariance").covariance.shape == (36,)
    assert new("moveit_msgs/msg/AllowedCollisionEntry").enabled.dtype == np.bool_


def test_a_field_that_there_is_not_is_an_error():
    with pytest.raises(TypeError, match="has no field colour"):
        new("std_msgs/msg/ColorRGBA", colour=1)


@pytest.mark.parametrize("cdr", [b"", b"\0\1\0\0", b"\0\1\0\0\xff\xff\xff\xff" * 4])
def test_nonsense_is_not_a_message(cdr):
    with pytest.raises(errors.BadRequest, match="not a vision_msgs/msg/Detection3DArray"):
        decode(cdr, "vision_msgs/msg/Detection3DArray")


def test_a_topic_has_the_key_and_the_quality_of_rmw_zenoh():
    made = topic("/semmap/map", "nav_msgs/msg/OccupancyGrid", latched=True)
    assert made.key(3) == f"3/semmap/map/nav_msgs::msg::dds_::OccupancyGrid_/{made.hash}"
    assert made.qos == ":1:,1:,:,:,,"
    assert made.token == f"%semmap%map/nav_msgs::msg::dds_::OccupancyGrid_/{made.hash}/:1:,1:,:,:,,"
    assert topic("/tf", "tf2_msgs/msg/TFMessage", reliable=False).qos == "2::,10:,:,:,,"
