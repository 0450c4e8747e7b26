"""The shape of a figure as Rerun archetypes. A figure's origin is its bottom centre, z up."""

from __future__ import annotations

import numpy as np
import rerun as rr

from semmap.nodes.drawing.articulation import paths_of, transform_of
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
_FIXED = -1
"""Stands for the part of a surface that no joint moves."""


def shape_of(figure: Figure) -> tuple[rr.AsComponents, ...]:
    """Return a labelled box of the figure's size, and its surface if that is known.

    A place is a translucent sheet on the floor, in the shape of its polygon if it has one.
    """
    if figure.appearance == "place":
        return _sheet(figure)
    surface = drawn_surface_of(figure)
    return (_box(figure),) if surface is None else (_box(figure), *_mesh(surface, _FIXED))


def drawn_surface_of(figure: Figure) -> Surface | None:
    """Return the surface with which a figure is drawn; None for a box or sheet."""
    return None if figure.appearance in ("ghost", "place") else figure.surface


def leaf_paths_of(figure: Figure) -> list[tuple[str, ...]]:
    """Return the path of each moving leaf of a figure: the joints that it moves with, and its own.

    A leaf is an entity of the recording below the one that holds it, so a motion is only a transform.
    """
    surface = drawn_surface_of(figure)
    leaves = () if surface is None else surface.leaves
    return [tuple(leaves[number].joint for number in path) for path in paths_of(leaves)]


def leaf_shapes_of(figure: Figure) -> list[tuple[rr.AsComponents, ...]]:
    """Return the surface of each moving leaf of a figure, without the leaves that it holds."""
    surface = figure.surface
    return [] if surface is None else [_mesh(surface, number) for number in range(len(surface.leaves))]


def leaf_transforms_of(figure: Figure) -> list[rr.Transform3D]:
    """Return the transform of each moving leaf of a figure, in the frame of what holds it."""
    positions = dict(figure.joint_positions)
    leaves = () if figure.surface is None else figure.surface.leaves
    moves = [transform_of(leaf, positions.get(leaf.joint, 0.0)) for leaf in leaves]
    return [rr.Transform3D(mat3x3=turn, translation=shift) for turn, shift in moves]


def _mesh(surface: Surface, number: int) -> tuple[rr.Mesh3D, ...]:
    """Return the part of a surface that belongs to a leaf, or to none; empty if there is nothing."""
    points = np.frombuffer(surface.points, "<f4").reshape(-1, 3)
    owner = np.full(len(points), _FIXED)
    for k, leaf in enumerate(surface.leaves):  # those on another leaf follow it
        owner[leaf.first : leaf.first + leaf.count] = k
    own = owner == number
    if not own.any():
        return ()
    triangles = np.frombuffer(surface.triangles, "<u4").reshape(-1, 3)
    mesh = rr.Mesh3D(
        vertex_positions=points[own],
        vertex_normals=np.frombuffer(surface.normals, "<f4").reshape(-1, 3)[own],
        vertex_colors=np.frombuffer(surface.colours, "u1").reshape(-1, 3)[own],
        triangle_indices=(np.cumsum(own) - 1)[triangles[own[triangles[:, 0]]]],
    )
    return (mesh,)


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
