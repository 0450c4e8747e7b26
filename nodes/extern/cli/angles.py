"""Angles on the command line: radians, or degrees where the unit says so."""

from __future__ import annotations

import math
import re
import sys
from typing import Any, Final

import click

from semmap.nodes.extern.cli.output.printable import print_escaped

_ANGLE: Final = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(deg|°|rad)?\s*")


class Angle(click.ParamType[float]):
    """`1.57`, `1.57rad`, `90deg` or `90°`, in radians."""

    name = "angle"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The angle [rad]. Of more than a turn without a unit a note says that it was read as radians."""
        if not isinstance(value, str):
            return float(value)
        if (match := _ANGLE.fullmatch(value)) is None:
            self.fail(f"'{value}' is no angle; write radians (1.57) or degrees (90deg)", param, ctx)
        angle, unit = float(match[1]), match[2]
        if unit in ("deg", "°"):
            return math.radians(angle)
        if unit is None and math.isfinite(angle) and abs(angle) > math.tau:
            degrees = math.degrees(math.remainder(angle, math.tau))
            print_escaped(
                f"  note: {value} is read as radians, which is {degrees:.4g}°; for degrees write {value}deg",
                file=sys.stderr,
            )
        return angle


ANGLE: Final = Angle()

yaw_option = click.option(
    "--yaw",
    type=ANGLE,
    metavar="ANGLE",
    help="Rotation about the z axis: radians, or degrees as in 90deg.",
)
"""How a thing is turned."""

from_pose: Final = click.option(
    "--from-pose",
    "viewpoint",
    type=(float, float, float, ANGLE),
    metavar="X Y Z YAW",
    help="The same, from a position [m] and a direction: radians, or degrees as in 90deg.",
)
"""Who looks, for verbs that have `--from` as well."""
