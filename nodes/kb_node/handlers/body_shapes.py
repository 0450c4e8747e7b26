"""Handlers for shapes: those of a world's bodies, which the simulator sends, and queries for shapes."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path

import msgspec

from semmap.nodes.kb_node.relations.geometry.fitting import fit_model
from semmap.nodes.kb_node.relations.geometry.opening import Positions, open_shape, positions_of
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import body_shapes
from semmap.ontology.model_shapes import WorldShapes, model_in_world, own_size_m, world
from semmap.schemas import errors, wording
from semmap.schemas.bridge import FoundShapes, ShapeBodies, ShapesOf
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.entities import Size
from semmap.schemas.replies import Done


class ShapeHandlers:
    """Stores the shapes of bodies, and lets the relations follow them."""

    def __init__(
        self, semantic_map: SemanticMap, file: Path, on_changed: Callable[[Collection[str]], None]
    ) -> None:
        """Store shapes in `file`. After each change, `on_changed` is called with the concerned entities."""
        self._map, self._file, self._on_changed = semantic_map, file, on_changed

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(ShapeBodies.answered_by(self.on_shapes), ShapesOf.answered_by(self.on_shapes_of))

    def on_shapes(self, message: ShapeBodies) -> Done:
        """Store the shapes, and compute the relations of entities again whose shapes have changed.

        Raises BadRequest for invalid content, Refused if the file cannot be written.
        """
        try:
            sent = msgspec.json.decode(message.content, type=WorldShapes)
            now = world().followed_by(sent)
        except (msgspec.DecodeError, KeyError, ValueError) as error:
            raise errors.BadRequest(f"the shapes of the world's bodies are invalid: {error}") from None
        if now != world():
            body_shapes.write(self._file, now)
            self._on_changed(self._map.exchange_shapes(now))
        return Done(text=f"shapes of {wording.bodies(len(sent.bodies))}")

    def on_shapes_of(self, query: ShapesOf) -> FoundShapes:
        """Return the shapes of entities. Equal entities share one."""
        found: dict[tuple[str, Size, Positions], str] = {}
        of: dict[str, tuple[str, ...]] = {}
        for key in query.keys:
            model = model_in_world(key.name, key.model, key.size_m)
            if size_m := key.size_m or (own_size_m(model) if model else None):
                joints = positions_of(model, size_m, dict(key.joints))
                of[key.name] = (found.setdefault((model, size_m, joints), str(len(found))),)
        shapes = {
            number: open_shape(fit_model(model, size_m), joints)
            for (model, size_m, joints), number in found.items()
        }
        return FoundShapes(content=msgspec.json.encode(WorldShapes(shapes, of)))
