"""What the options of a verb say."""

from nodes.extern.cli.calling import given


def test_what_is_left_out_is_not_given():
    assert given({"name": "cup1", "at": None, "alt": (), "wait": False}) == {"name": "cup1"}


def test_zero_is_given():
    assert given({"yaw": 0.0, "speed": 0, "ref": "", "wait": True}) == {
        "yaw": 0.0,
        "speed": 0,
        "ref": "",
        "wait": True,
    }
