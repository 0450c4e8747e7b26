"""Body surfaces, requested from the simulator once for each model and size, or digest."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from semmap.schemas.entities import Size
from semmap.schemas.scenes import Body, Surface

Kind = tuple[str, Size]
_OWN: Final = "body:"


def appearance_of(body: Body) -> str:
    """Return the key of a body's surface: its model, or the digest of the surface of a world's body.

    So equal bodies share one surface, and a body of another world is not drawn like one of the same name. A
    body without either, such as a box, has a key of its own.
    """
    return body.model or body.surface or f"{_OWN}{body.name}"


class SurfaceCache:
    """Surfaces by model and size."""

    def __init__(self) -> None:
        self._known: dict[Kind, Surface | None] = {}

    def of(self, body: Body | None) -> Surface | None:
        """Return the surface of a body with all joints at 0, if it is known."""
        return None if body is None else self._known.get(_kind(body))

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

    def take_reply(self, kinds: Mapping[str, Kind], surfaces: Mapping[str, Surface]) -> bool:
        """Store the surfaces of a reply, by body, and return whether it is complete.

        A body that was removed before the reply has no surface; another body of its kind is wanted then. A
        body with neither model nor digest may be invisible.
        """
        missing = []
        for name, kind in kinds.items():
            if name in surfaces:
                self.take(kind, surfaces[name])
            elif not kind[0].startswith(_OWN):
                missing.append(kind)
        self.reset_requests(missing)
        return not missing

    def reset_requests(self, kinds: Iterable[Kind]) -> None:
        """Mark kinds whose request failed as not requested."""
        for kind in kinds:
            if self._known.get(kind) is None:
                self._known.pop(kind, None)


def _kind(body: Body) -> Kind:
    return appearance_of(body), body.size_m
