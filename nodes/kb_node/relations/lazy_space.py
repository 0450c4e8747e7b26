"""The space of a map, updated on access."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas.entities import Entity


class LazySpace:
    """A space that is updated when it is read.

    Commits only record which entities they touched. The first access builds the space of the whole map.
    """

    def __init__(
        self,
        entities: Callable[[], Iterable[Entity]],
        find: Callable[[str], Entity | None],
        limits: Callable[[], Thresholds] = Thresholds,
    ) -> None:
        """Read entities with `entities()` (all) and `find(name)` (one).

        `limits()` returns the thresholds of the TBox.
        """
        self._entities = entities
        self._find = find
        self._limits = limits
        self._space: Space | None = None
        self._touched: set[str] = set()

    def mark_changed(self, names: Iterable[str]) -> None:
        """Record that these entities were added, changed or removed."""
        if self._space is not None:
            self._touched.update(names)

    def space(self) -> Space:
        """Return the space with all recorded changes applied."""
        limits = self._limits()
        if self._space is None or self._space.limits != limits:
            self._space = Space(self._entities(), limits)
        for name in self._touched:
            entity = self._find(name)
            if entity is None:
                self._space.remove(name)
            else:
                self._space.put(entity)
        self._touched.clear()
        self._space.pop_shifted()
        return self._space
