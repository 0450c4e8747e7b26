"""Body surfaces, requested from the simulator once for each model and size, or body of the world's own."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from semmap.nodes.drawing.articulation import articulated, joint_positions_of
from semmap.schemas.entities import Size
from semmap.schemas.scenes import Body, Surface

Kind = tuple[str, Size]
_OWN: Final = "body:"


def appearance_of(body: Body) -> str:
    """What a body looks like: the name of its model, or its own, for one that comes with the world."""
    return body.model or f"{_OWN}{body.name}"


class SurfaceCache:
    """Surfaces by model and size."""

    def __init__(self) -> None:
        self._known: dict[Kind, Surface | None] = {}

    def of(self, body: Body | None) -> Surface | None:
        """The surface of a body with its joints as they stand, if it is known."""
        surface = None if body is None else self._known.get(_kind(body))
        return (
            surface
            if surface is None or body is None
            else articulated(surface, joint_positions_of(body.joints))
        )

    def of_kind(self, model: str, size_m: Size) -> Surface | None:
        """The surface of a model at a size, if it is known."""
        return self._known.get((model, size_m))

    def wanted(self, bodies: Iterable[Body]) -> dict[str, Kind]:
        """One body of each kind that was never asked for; they count as asked for from now on."""
        names: dict[str, Kind] = {}
        for body in bodies:
            if _kind(body) not in self._known:
                names[body.name] = _kind(body)
                self._known[_kind(body)] = None
        return names

    def take(self, kind: Kind, surface: Surface) -> None:
        """Remember what the simulator told."""
        self._known[kind] = surface

    def give_up(self, kinds: Iterable[Kind]) -> None:
        """What was asked for in vain may be asked for again."""
        for kind in kinds:
            if self._known.get(kind) is None:
                self._known.pop(kind, None)


def _kind(body: Body) -> Kind:
    return appearance_of(body), body.size_m
