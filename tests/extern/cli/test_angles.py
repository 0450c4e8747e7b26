"""Angles on the command line."""

import math

import click
import pytest

from semmap.nodes.extern.cli.angles import ANGLE


@pytest.mark.parametrize(
    ("text", "radians"),
    [
        ("1.57", 1.57),
        ("-1.57rad", -1.57),
        ("90deg", math.pi / 2),
        ("-90°", -math.pi / 2),
        ("4.5e1 deg", math.pi / 4),
        (0.5, 0.5),
    ],
)
def test_radians_or_degrees(text, radians):
    assert ANGLE.convert(text, None, None) == pytest.approx(radians)


@pytest.mark.parametrize("text", ["", "ninety", "90 degrees", "nan", "1.5.7", "deg"])
def test_another_text_is_an_error(text):
    with pytest.raises(click.BadParameter, match=r"use radians \(1.57\) or degrees \(90deg\)"):
        ANGLE.convert(text, None, None)


def test_a_large_angle_without_a_unit_is_an_error():
    with pytest.raises(click.BadParameter, match="exceeds one turn in radians; for degrees write 90deg"):
        ANGLE.convert("90", None, None)
