"""Angles on the command line, in radians or, with a unit, in degrees."""

from __future__ import annotations

from typing import Any, Final

import click

from semmap.schemas.entities import parse_angle


class Angle(click.ParamType[float]):
    """An angle: `1.57`, `1.57rad`, `90deg` or `90°`."""

    name = "angle"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the angle [rad]."""
        try:
            return parse_angle(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


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
