"""Handler for the shapes of the bodies of a world, which the simulator sends when it has opened the world."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path

import msgspec

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import body_shapes
from semmap.ontology.model_shapes import WorldShapes, world
from semmap.schemas import errors, wording
from semmap.schemas.bridge import ShapeBodies
from semmap.schemas.calls import Handler, by_verb
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
        return by_verb(ShapeBodies.answered_by(self.on_shapes))

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
