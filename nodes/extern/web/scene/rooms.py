"""Places as coloured floors with names, and the walls of the world."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray
from viser import BatchedGlbHandle, MeshHandle, SceneApi

from semmap.nodes.drawing.palette import colour_of
from semmap.nodes.drawing.triangulation import triangles_of
from semmap.nodes.extern.web.scene.annotations import LabelText
from semmap.nodes.extern.web.scene.meshes import cube, glb, linear, srgb
from semmap.schemas import errors
from semmap.schemas.entities import Entity
from semmap.schemas.polygons import Polygon, extent_of
from semmap.schemas.scenes import Surface

_SHEET_M = 0.01
_MAX_INNER_ROOMS = 2
_LIGHT, _DARK = 0.12, 0.03
"""Grey levels (linear) that are mixed into floor colours on a light and a dark background."""
_PALE = 0.6
"""Share of the grey in a floor colour."""


class Rooms:
    """The places of the map and the walls of the world, in the scene of one tab."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._paper = _LIGHT
        self._drawn: tuple[tuple[object, ...], ...] = ()
        self._places: list[Entity] = []
        self.names: dict[str, LabelText] = {}
        """The names of the places, and their positions."""
        self._outlines: list[MeshHandle] = []
        self._walls: BatchedGlbHandle | None = None

    def show(self, entities: Mapping[str, Entity]) -> None:
        """Draw the places among these entities.

        Places with a size are sheets, the smaller above the larger.
        """
        places = sorted(
            (entity for entity in entities.values() if entity.place and entity.pose is not None),
            key=lambda place: (-_area(place), place.name),
        )
        drawn = tuple((p.name, p.class_, p.pose, p.size_m, extent_of(p), _label(p)) for p in places)
        if drawn == self._drawn:
            return
        self._drawn, self._places = drawn, places
        self._sheets([place for place in places if place.size_m is not None])
        self.names = {
            place.name: _label_text(place) for place in places if not _encloses_rooms(place, places)
        }

    def darken(self, dark: bool) -> None:
        """Adapt the floors to a dark or a light background."""
        paper = _DARK if dark else _LIGHT
        if paper != self._paper:
            self._paper = paper
            self._sheets([place for place in self._places if place.size_m is not None])

    def _sheets(self, places: list[Entity]) -> None:
        for outline in self._outlines:
            outline.remove()
        self._outlines.clear()
        if not places:
            self._scene.remove_by_name("/rooms/floors")
            return
        points, triangles = cube()
        heights = -_SHEET_M * np.arange(len(places), 0, -1)
        positions = np.array([place.pose.position_m for place in places if place.pose is not None])
        positions[:, 2] += heights - _SHEET_M
        sizes = np.array([place.size_m for place in places])
        sizes[:, 2] = _SHEET_M
        light = linear(np.array([colour_of(place.class_) for place in places], dtype=np.uint8))
        colours = srgb(light * (1.0 - _PALE) + self._paper * _PALE)
        outlines = {k: extent for k, place in enumerate(places) if (extent := extent_of(place)) is not None}
        for k, extent in outlines.items():
            self._outlines.append(self._outline(places[k].name, extent, positions[k], colours[k]))
        boxes = [k for k in range(len(places)) if k not in outlines]
        if not boxes:
            self._scene.remove_by_name("/rooms/floors")
            return
        self._scene.add_batched_meshes_simple(
            "/rooms/floors",
            points,
            triangles,
            batched_positions=positions[boxes],
            batched_wxyzs=np.array([p.pose.orientation_wxyz for p in places if p.pose is not None])[boxes],
            batched_scales=sizes[boxes],
            batched_colors=colours[boxes],
            lod="off",
            cast_shadow=False,
        )

    def _outline(
        self, name: str, extent: Polygon, position: NDArray[np.float64], colour: NDArray[np.uint8]
    ) -> MeshHandle:
        """Draw a sheet in the shape of a polygon, at the height of the top of a box."""
        corners, triangles = triangles_of(extent)
        red, green, blue = (int(part) for part in colour)
        return self._scene.add_mesh_simple(
            f"/rooms/outlines/{name}",
            np.column_stack([corners, np.full(len(corners), _SHEET_M, np.float32)]),
            triangles,
            color=(red, green, blue),
            position=position,
            cast_shadow=False,
        )

    def walls(self, surface: Surface | None) -> None:
        """Draw transparent walls; None removes them."""
        if self._walls is not None:
            self._walls.remove()
            self._walls = None
        if surface is not None and surface.triangles:
            self._walls = self._scene.add_batched_glb(
                "/rooms/walls",
                glb(surface, "wall"),
                batched_positions=np.zeros((1, 3)),
                batched_wxyzs=np.array([(1.0, 0.0, 0.0, 0.0)]),
                lod="off",
                cast_shadow=False,
                receive_shadow=False,
            )


def _area(place: Entity) -> float:
    return place.size_m[0] * place.size_m[1] if place.size_m is not None else 0.0


def _encloses_rooms(place: Entity, places: Iterable[Entity]) -> bool:
    """Return whether a place contains several others, so that its name is not shown."""
    if place.pose is None or place.size_m is None:
        return False
    (x, y, _), (width, depth, _) = place.pose.position_m, place.size_m
    inner = 0
    for other in places:
        if other is not place and other.pose is not None:
            ox, oy, _ = other.pose.position_m
            inner += abs(ox - x) <= width / 2.0 and abs(oy - y) <= depth / 2.0
    return inner > _MAX_INNER_ROOMS


def _label_text(place: Entity) -> LabelText:
    if place.pose is None:
        raise errors.InternalError(f"{place.name} has no pose")
    return _label(place).upper(), place.pose.position_m


def _label(place: Entity) -> str:
    return place.preferred_reference or place.name
