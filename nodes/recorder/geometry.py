"""The shape of a figure in Rerun's terms. A figure's origin is its bottom centre, z up."""

from __future__ import annotations

import rerun as rr

from nodes.recorder.figures import Figure
from nodes.recorder.palette import GREY, colour_of

_ALPHA = {"ghost": 90, "place": 28}
_FLOOR_M = 0.01


def shape_of(figure: Figure) -> rr.Boxes3D:
    """A box of the figure's size; a place is a translucent sheet on its floor."""
    x, y, z = figure.size_m
    height = _FLOOR_M if figure.look == "place" else z
    colour = GREY if figure.look == "furniture" else colour_of(figure.class_)
    return rr.Boxes3D(
        half_sizes=[(x / 2.0, y / 2.0, height / 2.0)],
        centers=[(0.0, 0.0, height / 2.0)],
        colors=[(*colour, _ALPHA.get(figure.look, 255))],
        fill_mode=_fill_mode(figure),
        labels=[figure.label],
        show_labels=figure.look == "place",
    )


def _fill_mode(figure: Figure) -> rr.components.FillMode:
    if figure.look in _ALPHA:
        return rr.components.FillMode.TransparentFillMajorWireframe
    if figure.look == "believed":
        return rr.components.FillMode.MajorWireframe
    return rr.components.FillMode.Solid
