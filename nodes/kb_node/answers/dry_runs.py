"""Dry runs: what a change would commit and infer, without changing the map."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import islice

from msgspec import structs

from semmap.nodes.kb_node.answers.answers import without_trivial
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.ontology import vocabulary as v
from semmap.ontology.entity_triples import find_earlier_names
from semmap.schemas.commits import Commit, Effects, Trial
from semmap.schemas.explanations import Term, Triple

_FEW = 50
"""Entities whose inferred facts are compared."""


def dry_run(
    semantic_map: SemanticMap,
    change: Callable[[], Commit | None],
    meanwhile: Callable[[], None] = lambda: None,
) -> Effects | None:
    """Return the effects that `change` would have, or None if it changes nothing.

    `meanwhile` is called while the map is in the changed state. Raises what `change` raises.
    """

    def inspect(commit: Commit) -> _After:
        meanwhile()
        return _After(semantic_map, commit)

    after = semantic_map.try_out(change, inspect)
    if after is None:
        return None
    asserted = _asserted(semantic_map, after.concerned)
    followed = _inferred(semantic_map, after.concerned)
    commit, names = after.commit, semantic_map.classes.qualified_names
    return structs.replace(
        Effects.of(commit, find_earlier_names(commit)),
        trial=Trial(
            inserted=len(commit.inserted),
            retracted=len(commit.retracted),
            changed=tuple(entity.name for entity in commit.changed),
            gained=_spoken(after.followed - followed - asserted, names),
            lost=_spoken(followed - after.followed - after.held, names),
        ),
    )


class _After:
    """What holds after a commit about the entities that it touches."""

    def __init__(self, semantic_map: SemanticMap, commit: Commit) -> None:
        self.commit = commit
        removed = filter(None, (semantic_map.find(departed.name) for departed in commit.removed))
        self.concerned = [v.iri(entity.iri) for entity in islice((*commit.changed, *removed), _FEW)]
        self.held = _asserted(semantic_map, self.concerned)
        self.followed = _inferred(semantic_map, self.concerned)


def _asserted(semantic_map: SemanticMap, iris: Iterable[Term]) -> set[Triple]:
    return {t for iri in iris for t in semantic_map.reasoner.asserted(iri)}


def _inferred(semantic_map: SemanticMap, iris: Iterable[Term]) -> set[Triple]:
    reasoner = semantic_map.reasoner
    return {t for iri in iris for t in without_trivial(reasoner.inferred(iri, None, None))}


def _spoken(triples: Iterable[Triple], names: Mapping[Term, str]) -> tuple[str, ...]:
    return tuple(v.to_words(triple, names) for triple in sorted(triples))
