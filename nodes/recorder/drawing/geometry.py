"""The shape of a figure as Rerun archetypes. A figure's origin is its bottom centre, z up."""

from __future__ import annotations

import numpy as np
import rerun as rr

from semmap.nodes.drawing.figures import Figure
from semmap.nodes.drawing.palette import GREY, colour_of
from semmap.nodes.drawing.triangulation import triangles_of
from semmap.schemas.polygons import Polygon
from semmap.schemas.scenes import Surface

_GHOST_ALPHA = 90
_SHEET_ALPHA = 36
_SHEET_M = 0.002
_LABEL_M = 0.02
_BORDER_M = 0.015
_THIN_M = 0.001


def shape_of(figure: Figure) -> tuple[rr.AsComponents, ...]:
    """Return a labelled box of the figure's size, and its surface if that is known.

    A place is a translucent sheet on the floor, in the shape of its polygon if it has one.
    """
    if figure.appearance == "place":
        return _sheet(figure)
    if figure.surface is None or figure.appearance == "ghost":
        return (_box(figure),)
    return _box(figure), _mesh(figure.surface)


def _mesh(surface: Surface) -> rr.Mesh3D:
    return rr.Mesh3D(
        vertex_positions=np.frombuffer(surface.points, "<f4").reshape(-1, 3),
        vertex_normals=np.frombuffer(surface.normals, "<f4").reshape(-1, 3),
        vertex_colors=np.frombuffer(surface.colours, "u1").reshape(-1, 3),
        triangle_indices=np.frombuffer(surface.triangles, "<u4").reshape(-1, 3),
    )


def _box(figure: Figure) -> rr.Boxes3D:
    x, y, z = figure.size_m
    colour = GREY if figure.appearance == "furniture" else colour_of(figure.class_)
    return rr.Boxes3D(
        half_sizes=[(x / 2.0, y / 2.0, z / 2.0)],
        centers=[(0.0, 0.0, z / 2.0)],
        colors=[(*colour, _GHOST_ALPHA if figure.appearance == "ghost" else 255)],
        radii=None if figure.surface is None else [_THIN_M],
        fill_mode=_fill_mode(figure),
        labels=[figure.label],
        show_labels=False,
    )


def _fill_mode(figure: Figure) -> rr.components.FillMode:
    """Return how a box is filled: edges only, if a surface is drawn inside it."""
    usual = rr.components.FillMode.Solid if figure.surface is None else rr.components.FillMode.MajorWireframe
    return _FILL_MODE.get(figure.appearance, usual)


_FILL_MODE = {
    "ghost": rr.components.FillMode.TransparentFillMajorWireframe,
    "believed": rr.components.FillMode.MajorWireframe,
}


def _borders(figure: Figure, extent: Polygon, z_m: float) -> rr.LineStrips3D:
    """Return the borders of a polygon, relative to the centre of its bounds."""
    x0, y0, x1, y1 = extent.bounds
    x, y = (x0 + x1) / 2.0, (y0 + y1) / 2.0
    return rr.LineStrips3D(
        [[(px - x, py - y, z_m) for px, py in (*ring, ring[0])] for ring in extent.rings],
        radii=[_BORDER_M],
        colors=[colour_of(figure.class_)],
    )


def _sheet(figure: Figure) -> tuple[rr.AsComponents, ...]:
    """Draw a place. Places overlap, so a larger sheet is drawn lower."""
    x, y, _ = figure.size_m
    below = -_SHEET_M * (x + y)
    colour = (*colour_of(figure.class_), _SHEET_ALPHA)
    name = rr.Points3D(
        [(0.0, 0.0, below)],
        radii=[_LABEL_M],
        colors=[colour_of(figure.class_)],
        labels=[figure.label],
        show_labels=True,
    )
    if figure.extent is not None:
        return _covered(figure.extent, below, colour), _borders(figure, figure.extent, below), name
    sheet = rr.Boxes3D(
        half_sizes=[(x / 2.0, y / 2.0, _SHEET_M / 2.0)],
        centers=[(0.0, 0.0, below)],
        colors=[colour],
        fill_mode=rr.components.FillMode.Solid,
    )
    return sheet, name


def _covered(extent: Polygon, z_m: float, colour: tuple[int, int, int, int]) -> rr.Mesh3D:
    """Return the area of a polygon, relative to the centre of its bounds."""
    points, triangles = triangles_of(extent)
    return rr.Mesh3D(
        vertex_positions=np.column_stack([points, np.full(len(points), z_m, np.float32)]),
        triangle_indices=triangles,
        albedo_factor=colour,
    )
