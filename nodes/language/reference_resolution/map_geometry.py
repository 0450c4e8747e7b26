"""The geometric queries that resolving a description needs."""

from __future__ import annotations

from typing import Protocol

from semmap.schemas.relations import RelationName


class MapGeometry(Protocol):
    """Positions and spatial relations of entities, by name. Lengths are in metres."""

    @property
    def has_viewer(self) -> bool:
        """Whether there is a viewer, so that left and right are defined."""

    def related(self, relation: RelationName, name: str, other: str) -> bool:
        """Return whether `name` is on, in, near, left of ... `other`.

        Raises BadRequest for left, right, in front and behind without a viewer.
        """

    def between(self, one: str, other: str) -> frozenset[str]:
        """Return the objects between two objects."""

    def position(self, name: str) -> tuple[float, float, float] | None:
        """Return the bottom centre."""

    def size(self, name: str) -> tuple[float, float, float] | None:
        """Return the extent along the object's own axes."""

    def distance(self, name: str, other: str) -> float:
        """Return the distance of two objects, infinite if it is unknown."""

    def distance_from_viewer(self, name: str) -> float:
        """Return the distance from the viewer. Raises BadRequest without a viewer."""

    def bearing(self, name: str) -> float:
        """Return the angle to the left of the viewing direction [rad]. Raises BadRequest without a viewer."""

    def holds_anything(self, name: str) -> bool:
        """Return whether any object is in or on it."""

    def is_on_floor(self, name: str) -> bool:
        """Return whether an object stands on the floor of its place, and not in or on another object."""

    def spatial_relations(self, name: str) -> tuple[tuple[RelationName, str], ...]:
        """Return what the object is inside, what it is on, and its place, as far as they exist."""
