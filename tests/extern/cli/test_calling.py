"""What the command line hands on of its options."""

from nodes.extern.cli.calling import given


def test_what_is_not_given_is_left_out():
    assert given({"yaw": None, "wait": False, "leave": (), "frame": None}) == {}


def test_zero_is_given():
    fields = {"yaw": 0.0, "to": 0.0, "number": 0, "wait": True, "text": "", "at": (0.0, 0.0, 0.0)}
    assert given(dict(fields)) == fields
