"""The space of a map, brought up to date when somebody asks."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.schemas.entities import Entity


class LazySpace:
    """Commits only note whom they touched; the first question costs as much as the map is large."""

    def __init__(
        self,
        entities: Callable[[], Iterable[Entity]],
        find: Callable[[str], Entity | None],
        limits: Callable[[], Thresholds] = Thresholds,
    ) -> None:
        """`entities()` are all that there are now, `find(name)` is one; `limits()` are the TBox's."""
        self._entities = entities
        self._find = find
        self._limits = limits
        self._space: Space | None = None
        self._touched: set[str] = set()

    def mark_changed(self, names: Iterable[str]) -> None:
        """These entities came, went, or are otherwise now."""
        if self._space is not None:
            self._touched.update(names)

    def space(self) -> Space:
        """The solids as they are now."""
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
