"""Angles on the command line, in radians or, with a unit, in degrees."""

from __future__ import annotations

import math
import re
import sys
from typing import Any, Final

import click

from semmap.nodes.extern.cli.output.printable import print_escaped

_ANGLE: Final = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(deg|°|rad)?\s*")


class Angle(click.ParamType[float]):
    """An angle: `1.57`, `1.57rad`, `90deg` or `90°`."""

    name = "angle"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the angle [rad].

        A number without a unit that exceeds a full turn prints a note that it is read as radians.
        """
        if not isinstance(value, str):
            return float(value)
        if (match := _ANGLE.fullmatch(value)) is None:
            self.fail(f"'{value}' is not an angle; use radians (1.57) or degrees (90deg)", param, ctx)
        angle, unit = float(match[1]), match[2]
        if unit in ("deg", "°"):
            return math.radians(angle)
        if unit is None and math.isfinite(angle) and abs(angle) > math.tau:
            degrees = math.degrees(math.remainder(angle, math.tau))
            print_escaped(
                f"  note: {value} is read as radians ({degrees:.4g}°); for degrees use {value}deg",
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

from_pose: Final = click.option(
    "--from-pose",
    "viewpoint",
    type=(float, float, float, ANGLE),
    metavar="X Y Z YAW",
    help="Viewpoint instead of --from: position [m] and yaw (radians, or degrees as in 90deg).",
)
"""The viewpoint as a pose, for commands that also have `--from`."""
