"""Body surfaces, requested from the simulator once for each model and size, or body of the world file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from semmap.nodes.drawing.articulation import articulated, joint_positions_of
from semmap.schemas.entities import Size
from semmap.schemas.scenes import Body, Surface

Kind = tuple[str, Size]
_OWN: Final = "body:"


def appearance_of(body: Body) -> str:
    """Return the key of a body's surface: its model, or its own name for a body of the world file."""
    return body.model or f"{_OWN}{body.name}"


class SurfaceCache:
    """Surfaces by model and size."""

    def __init__(self) -> None:
        self._known: dict[Kind, Surface | None] = {}

    def of(self, body: Body | None) -> Surface | None:
        """Return the surface of a body at its current joint positions, if it is known."""
        surface = None if body is None else self._known.get(_kind(body))
        return (
            surface
            if surface is None or body is None
            else articulated(surface, joint_positions_of(body.joints))
        )

    def of_kind(self, model: str, size_m: Size) -> Surface | None:
        """Return the surface of a model at a size, if it is known."""
        return self._known.get((model, size_m))

    def wanted(self, bodies: Iterable[Body]) -> dict[str, Kind]:
        """Return one body of each kind that was not requested yet, and mark these as requested."""
        names: dict[str, Kind] = {}
        for body in bodies:
            if _kind(body) not in self._known:
                names[body.name] = _kind(body)
                self._known[_kind(body)] = None
        return names

    def take(self, kind: Kind, surface: Surface) -> None:
        """Store a surface from the simulator."""
        self._known[kind] = surface

    def reset_requests(self, kinds: Iterable[Kind]) -> None:
        """Mark kinds whose request failed as not requested."""
        for kind in kinds:
            if self._known.get(kind) is None:
                self._known.pop(kind, None)


def _kind(body: Body) -> Kind:
    return appearance_of(body), body.size_m
