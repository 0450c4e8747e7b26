"""What is measured of a map, as it is asked for while a description is resolved."""

from __future__ import annotations

from typing import Protocol

from semmap.schemas.relations import RelationName


class MapGeometry(Protocol):
    """Where things are; all by name. Lengths are metres."""

    @property
    def has_viewer(self) -> bool:
        """Whether somebody looks, so that there is a left and a right."""

    def related(self, relation: RelationName, name: str, other: str) -> bool:
        """Whether the one is on, in, near, left of ... the other.

        Left, right, in front and behind raise BadRequest where there is no viewer.
        """

    def between(self, one: str, other: str) -> frozenset[str]:
        """What is between two things."""

    def position(self, name: str) -> tuple[float, float, float] | None:
        """Its bottom centre."""

    def size(self, name: str) -> tuple[float, float, float] | None:
        """Its extent along its own axes."""

    def distance(self, name: str, other: str) -> float:
        """How far two things are from one another, infinite where that is not known."""

    def distance_from_viewer(self, name: str) -> float:
        """How far a thing is from who looks. Raises BadRequest where there is no viewer."""

    def bearing(self, name: str) -> float:
        """By how much a thing is to the left of where the viewer looks [rad]; BadRequest without a viewer."""

    def holds_anything(self, name: str) -> bool:
        """Whether anything is in or on it."""

    def is_on_floor(self, name: str) -> bool:
        """Whether a thing stands on the floor of its place, and in or on nothing else."""

    def whereabouts(self, name: str) -> tuple[tuple[RelationName, str], ...]:
        """What a thing is inside, what it is on, and in which place, those that it has."""
