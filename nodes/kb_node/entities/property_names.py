"""The names of TBox properties: names, prefixed names, IRIs and labels."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from functools import cached_property

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v
from semmap.ontology.name_index import Ambiguous, Named, NameIndex
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors
from semmap.schemas.explanations import Term


class PropertyNames:
    """Converts words to properties. No other module does."""

    def __init__(self, reasoner: Reasoner, properties: Collection[Term], known_prefixes: Prefixes) -> None:
        self._reasoner = reasoner
        self._prefixes = known_prefixes
        self.names: dict[Term, str] = prefixes.names(
            [p for p in properties if p.startswith("<")], known_prefixes
        )
        """Property to name: its local name, with a prefix if several properties share it."""

    def find(self, word: str, *, among: Callable[[Term], bool] = lambda _: True) -> Term | None:
        """Return the property that `word` means; of several, the one that is `among` the wanted ones.

        Raises BadRequest for an ambiguous word.
        """
        try:
            name = self._index.find(word)
        except Ambiguous as error:
            wanted = [name for name in error.names if among(self._by_name[name])]
            if len(wanted) != 1:
                raise errors.BadRequest(f"'{word}' is ambiguous: {error}; say which property") from None
            name = wanted[0]
        return None if name is None else self._by_name[name]

    def did_you_mean(self, word: str, among: Callable[[Term], bool] = lambda _: True) -> str:
        """Return the most similar names of wanted properties, as a text, or ""."""
        return NameIndex(map(self._named, filter(among, self.names))).did_you_mean(word)

    def labels(self, term: Term) -> Iterable[str]:
        """Return the labels in every language."""
        return (v.lexical(o) for _, _, o in self._reasoner.asserted(term, v.RDFS_LABEL) if o.startswith('"'))

    @cached_property
    def _index(self) -> NameIndex:
        return NameIndex(map(self._named, self.names))

    @cached_property
    def _by_name(self) -> dict[str, Term]:
        return {name: p for p, name in self.names.items()}

    def _named(self, p: Term) -> Named:
        return Named(
            self.names[p], v.bare(p), prefixes.prefixed(p, self._prefixes), tuple(sorted(self.labels(p)))
        )
