"""The shape of a figure in Rerun's terms. A figure's origin is its bottom centre, z up."""

from __future__ import annotations

import rerun as rr

from nodes.recorder.figures import Figure
from nodes.recorder.palette import GREY, colour_of

_GHOST_ALPHA = 90
_SHEET_ALPHA = 36
_SHEET_M = 0.002
_LABEL_M = 0.02


def shape_of(figure: Figure) -> tuple[rr.AsComponents, ...]:
    """A box of the figure's size with its name; a place is a translucent sheet on the floor."""
    return _sheet(figure) if figure.look == "place" else (_box(figure),)


def _box(figure: Figure) -> rr.Boxes3D:
    x, y, z = figure.size_m
    colour = GREY if figure.look == "furniture" else colour_of(figure.class_)
    return rr.Boxes3D(
        half_sizes=[(x / 2.0, y / 2.0, z / 2.0)],
        centers=[(0.0, 0.0, z / 2.0)],
        colors=[(*colour, _GHOST_ALPHA if figure.look == "ghost" else 255)],
        fill_mode=_FILL_MODE.get(figure.look, rr.components.FillMode.Solid),
        labels=[figure.label],
        show_labels=False,
    )


_FILL_MODE = {
    "ghost": rr.components.FillMode.TransparentFillMajorWireframe,
    "believed": rr.components.FillMode.MajorWireframe,
}


def _sheet(figure: Figure) -> tuple[rr.Boxes3D, rr.Points3D]:
    """Places lie in one another, so the larger a sheet, the lower it lies."""
    x, y, _ = figure.size_m
    below = -_SHEET_M * (x + y)
    sheet = rr.Boxes3D(
        half_sizes=[(x / 2.0, y / 2.0, _SHEET_M / 2.0)],
        centers=[(0.0, 0.0, below)],
        colors=[(*colour_of(figure.class_), _SHEET_ALPHA)],
        fill_mode=rr.components.FillMode.Solid,
    )
    name = rr.Points3D(
        [(0.0, 0.0, below)],
        radii=[_LABEL_M],
        colors=[colour_of(figure.class_)],
        labels=[figure.label],
        show_labels=True,
    )
    return sheet, name
