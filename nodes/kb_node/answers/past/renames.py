"""Earlier names of renamed entities, so that their past is found under the present name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set

from msgspec import structs

from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.trail_file import TrailLine

_OTHER = "{} (another entity)"


class Renames:
    """The names of some entities over time, which is counted in commits or in nanoseconds."""

    def __init__(self, names: Iterable[Sequence[tuple[int, str]]] = ()) -> None:
        """Create it from the names of each entity, newest first, each with the time since which it has it."""
        self._names = [entity for entity in names if len(entity) > 1]

    @classmethod
    def of(cls, past: HistoryReader, names: Iterable[str]) -> Renames:
        """Return the names by commit of entities that have these names now."""
        return cls(past.list_names(name) for name in names)

    def in_time(self, journal: Journal) -> Renames:
        """Return the same by the stamps of the commits [ns]."""
        return Renames(
            [(journal.stamps.of(seq) if seq else 0, name) for seq, name in entity] for entity in self._names
        )

    @property
    def present_names(self) -> Set[str]:
        """The present names of the entities that were renamed."""
        return {entity[0][1] for entity in self._names}

    def present(self, name: str, when: int) -> str:
        """Return the present name of the entity that had a name at a time.

        The name of another entity, which had one of the present names earlier, is returned with a mark.
        """
        for entity in self._names:
            if name == next(had for since, had in entity if since <= when):
                return entity[0][1]
        return _OTHER.format(name) if name in self.present_names else name

    def in_trail(self, lines: Iterable[TrailLine]) -> Iterator[TrailLine]:
        """Yield the lines of a trail with the present names of entities and places, by time."""
        for line in lines:
            yield structs.replace(
                line,
                name=self.present(line.name, line.ns) if line.name else "",
                places=tuple(self.present(place, line.ns) for place in line.places),
            )
