"""The property table: the properties that can be set on an entity, computed once per TBox."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Set
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

from semmap.nodes.kb_node.entities import property_values
from semmap.nodes.kb_node.entities.aligned_values import LABELS
from semmap.nodes.kb_node.entities.property_names import PropertyNames
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.data_ranges import DataRange, read_common
from semmap.nodes.kb_node.reasoner.terms import is_reserved
from semmap.nodes.kb_node.sparql.queries.text import query_prefixes
from semmap.ontology import vocabulary as v
from semmap.ontology.model_choice import require_model
from semmap.schemas import errors
from semmap.schemas.changes import value_in_words
from semmap.schemas.entities import PropertyInfo, Value
from semmap.schemas.explanations import Term

_FEW = 12
_DEEPEST = 3
"""Depth to which the parts of a nameless value are shown."""

About = Callable[[Term], Mapping[Term, Sequence[Term]]]
"""A lookup of the asserted objects of a subject by predicate."""
STRUCTURAL: Mapping[Term, str] = {
    v.HAS_POSITION: "update {name} --at X Y Z",
    v.HAS_SIZE: "update {name} --size X Y Z",
    v.HAS_PREFERRED_REFERENCE: "update {name} --ref TEXT",
    v.HAS_ALTERNATIVE_REFERENCE: "update {name} --alt TEXT",
    v.CONFLICTING_OBSERVATION: "update {name} --conflict TEXT",
    v.TRACKED_FROM: "track {name}",
    v.ENTITY_NAME: "rename {name} NEW",
    v.RDF_TYPE: "update {name} --class CLASS",
}
"""Properties with command options of their own."""
_FIELDS: Mapping[str, str] = {
    **dict.fromkeys(("label", "ref", "preflabel"), "update {name} --ref TEXT"),
    **dict.fromkeys(("alias", "alt", "altlabel"), "update {name} --alt TEXT"),
    **dict.fromkeys(("at", "pose", "position", "location"), "update {name} --at X Y Z"),
    **dict.fromkeys(("yaw", "rotation", "orientation"), "update {name} --yaw ANGLE"),
    "size": "update {name} --size X Y Z",
    "extent": "update {name} --extent WKT",
    "name": "rename {name} NEW",
}
"""Words for what is not a property, in lower case, with the commands that change it."""
EQUALITY = frozenset((v.OWL_SAME_AS, v.iri(f"{v.OWL}differentFrom")))
"""Properties that no command changes."""
_TYPE = frozenset(("type", "class"))
_UNTYPED = v.PROPERTY_KINDS[-1]
"""rdf:Property: a data or object property, which its range determines."""
_TEXT = frozenset((v.XSD_STRING,))
_OF_A_STAR = frozenset((v.LEXICAL_REFERENCE, *v.COORDINATE_XYZ, *v.ORIENTATION_WXYZ, *v.SIZE_XYZ))


class Property(NamedTuple):
    """A data or object property. `ranges` includes those of its superproperties.

    `data_range` are the values that a data property may have; None if they are not limited.
    """

    iri: Term
    name: str
    is_data: bool
    functional: bool
    ranges: frozenset[Term]
    data_range: DataRange | None = None
    is_open: bool = False
    """Whether its values may be individuals and literals: it is only an rdf:Property, without a range."""


class PropertyTable:
    """The data and object properties of a TBox, by IRI, local name and label, and its individuals.

    The annotation `dm:model` of classes and entities is included.
    """

    def __init__(
        self,
        reasoner: Reasoner,
        names: PropertyNames,
        class_names: Mapping[Term, str] = MappingProxyType({}),
        known_prefixes: Mapping[str, str] = MappingProxyType({}),
        edges: Set[Term] = frozenset(),
    ) -> None:
        """Read the table. `edges` are further properties that are not set by name."""
        self._reasoner = reasoner
        self._names = names
        self._class_names = class_names
        self._prefixes = query_prefixes(known_prefixes)
        typed = [(s, o) for s, _, o in reasoner.asserted(None, v.RDF_TYPE) if s.startswith("<")]
        classes = {s for s, o in typed if o in (v.OWL_CLASS, v.RDFS_CLASS)}
        self._of_the_tbox = {s for s, o in typed if o == v.OWL_NAMED_INDIVIDUAL or o in classes}
        declared = {
            p: kind
            for kind in reversed(v.PROPERTY_KINDS)  # the more specific ones count
            for p, _, _ in reasoner.asserted(None, v.RDF_TYPE, kind)
            if p.startswith("<") and p not in _OF_A_STAR
        }
        if v.MODEL in names.names:
            declared[v.MODEL] = v.OWL_DATATYPE_PROPERTY
        self._structural = STRUCTURAL.keys() | edges | frozenset(LABELS) | {v.HAS_EXTENT, v.MODEL}
        self.by_iri: dict[Term, Property] = {}
        for p, kind in sorted(declared.items()):
            if p in STRUCTURAL or p in edges or kind == v.OWL_ANNOTATION_PROPERTY or is_reserved(p):
                continue
            ranges = _TEXT if p == v.MODEL else self.ranges(p)
            of_classes = (
                any(o in classes for o in ranges) if kind == _UNTYPED else kind == v.OWL_OBJECT_PROPERTY
            )
            is_data = not of_classes
            self.by_iri[p] = Property(
                iri=p,
                name=names.names[p],
                is_data=is_data,
                functional=self.is_functional(p),
                ranges=ranges,
                data_range=read_common(ranges, reasoner.asserted) if is_data else None,
                is_open=kind == _UNTYPED and not ranges,
            )

    def read_values(self, asserted: Mapping[Term, Iterable[Term]]) -> dict[str, property_values.Stated]:
        """Return the properties by name of an individual with these assertions; functional as scalars."""
        known = asserted.keys() & self.by_iri.keys()
        if not known:
            return {}
        to_value = property_values.to_json_value
        return dict(sorted(_shown(self.by_iri[p], map(to_value, asserted[p])) for p in known))

    def read_others(self, about: About, subject: Term) -> dict[str, property_values.Stated]:
        """Return the asserted values of the properties that are not in the table, by name.

        These are annotations, and properties that only the map declares or uses. The properties that have
        commands of their own are not included. A nameless value is written with its content.
        """
        others = about(subject).keys() - self.by_iri.keys() - self._structural
        found: dict[str, property_values.Stated] = {}
        for p in sorted(others):
            name = v.local_name(p)
            if name in found or name in self._taken:
                name = p
            found[name] = tuple(sorted((_content(about, o, ()) for o in about(subject)[p]), key=str))
        return found

    def read_nameless(self, about: About, subject: Term) -> dict[str, property_values.Stated]:
        """Return the values of properties in the table with nameless ones among them, with their content."""
        asserted = about(subject)
        return {
            name: stated
            for p in asserted.keys() & self.by_iri.keys()
            if any(o.startswith("_:") for o in asserted[p])
            for name, stated in [_shown(self.by_iri[p], (_content(about, o, ()) for o in asserted[p]))]
        }

    def find(self, word: str, name: str = "NAME") -> Property:
        """Return the property that `word` means: a name, an IRI in <>, a prefixed name or a label.

        Raises BadRequest with the most similar names, or with the command for a property that has one.
        """
        if _fold(word) in _TYPE:
            p: Term | None = v.RDF_TYPE
        elif (p := self._term(word)) is None:
            p = self._names.find(word, among=self._is_known)
        if p is not None and p in STRUCTURAL:
            how = STRUCTURAL[p].format(name=name)
            raise errors.BadRequest(f"{v.local_name(p)} is changed with: semmap {how}")
        if p in self.by_iri:
            return self.by_iri[p]
        if p is None and (how := _FIELDS.get(_fold(word), "")):
            raise errors.BadRequest(f"{word} is changed with: semmap {how.format(name=name)}")
        if p in EQUALITY or _fold(word) in ("sameas", "differentfrom"):
            raise errors.BadRequest(
                f"'{word}' is not changed by commands, but by files: semmap load FILE.ttl with the statement"
                f" <IRI of {name}> owl:{word.rpartition(':')[2]} <IRI>; semmap undo COMMIT takes it back"
            )
        hint = self._names.did_you_mean(word, self.by_iri.__contains__) or "; see: semmap properties"
        raise errors.BadRequest(f"unknown property '{word}'{hint}")

    def term(
        self,
        prop: Property,
        text: str,
        named: Callable[[str], Term | None],
        names: Collection[str],
        find_other: Callable[[str], Term | None] = lambda word: None,
    ) -> Term:
        """Return the value that `text` denotes; `named` finds individuals of the map, among `names`.

        If neither that nor the TBox has one, `find_other` finds individuals that are not in space.

        Raises BadRequest for a literal outside the range or an unknown model, and UnknownName for an
        individual that does not exist.
        """
        if prop.iri == v.MODEL:
            require_model(text)
        if not prop.is_data or prop.is_open:
            term = self._term(text)
            if term is not None:
                if any(self._reasoner.asserted(term)):
                    return term
            elif (found := named(text) or self._individual(prop, text)) is not None:
                return found
            if (other := find_other(text)) is not None:
                return other
        if prop.is_data:
            return property_values.literal(prop.name, prop.data_range, text)
        allowed = sorted(v.entity_name(i) for i in self._allowed(prop))
        hint = errors.did_you_mean(text, (*allowed, *names))
        if not hint and 0 < len(allowed) <= _FEW:
            hint = f"; {prop.name} takes {', '.join(allowed)}"
        elif not hint:
            hint = "; see: semmap list --all"
        raise errors.UnknownName(f"no individual is named '{text}'{hint}")

    def ranges(self, p: Term) -> frozenset[Term]:
        """Return the ranges of a property, known or not, and of its superproperties."""
        asserted = self._reasoner.asserted
        return frozenset(o for q in self._above(p) for _, _, o in asserted(q, v.RDFS_RANGE, None))

    def is_functional(self, p: Term) -> bool:
        """Return whether a property, known or not, or one of its superproperties is functional."""
        return p == v.MODEL or any(self._is(q, v.OWL_FUNCTIONAL_PROPERTY) for q in self._above(p))

    def rows(self) -> Iterator[PropertyInfo]:
        """Yield one row per property, by name."""
        for prop in sorted(self.by_iri.values(), key=lambda p: p.name):
            domains = {
                o for q in self._above(prop.iri) for _, _, o in self._reasoner.asserted(q, v.RDFS_DOMAIN)
            }
            comments = sorted(o for _, _, o in self._reasoner.asserted(prop.iri, v.RDFS_COMMENT))
            yield PropertyInfo(
                name=prop.name,
                iri=v.bare(prop.iri),
                kind="data" if prop.is_data else "object",
                functional=prop.functional,
                domain=self._called(domains),
                range=self._called(prop.ranges) or ((prop.data_range.text,) if prop.data_range else ()),
                datatypes=tuple(map(v.local_name, prop.data_range.datatypes)) if prop.data_range else (),
                labels=self._labels(prop.iri),
                comment=v.lexical(comments[0]) if comments else "",
                values={v.entity_name(i): _label(self._labels(i)) for i in sorted(self._allowed(prop))},
            )

    def _called(self, classes: Iterable[Term]) -> tuple[str, ...]:
        """Return the names of classes and datatypes, without those that follow from others."""
        named = [c for c in classes if c.startswith("<")]
        narrow = [c for c in named if not any(self._is_below(d, c) for d in named)]
        return tuple(sorted(self._class_names.get(c) or v.local_name(c) for c in narrow))

    def _is_below(self, narrow: Term, wide: Term) -> bool:
        """Return whether a class is a proper subclass of another."""
        holds, sub_class_of = self._reasoner.holds, v.RDFS_SUB_CLASS_OF
        return (
            narrow != wide and holds((narrow, sub_class_of, wide)) and not holds((wide, sub_class_of, narrow))
        )

    def _individual(self, prop: Property, word: str) -> Term | None:
        """Return the TBox individual of this name or label; of several, the one in the range."""
        found = self._individuals.get(_fold(word), set())
        if len(found) > 1:
            found = found & self._allowed(prop) or found
        return min(found, default=None)

    def _allowed(self, prop: Property) -> set[Term]:
        """Return the TBox individuals that are in all classes of the range; none without a range."""
        if prop.is_data or not prop.ranges:
            return set()
        return self._of_the_tbox.intersection(*(self._reasoner.instances(c) for c in prop.ranges))

    @cached_property
    def _taken(self) -> frozenset[str]:
        """The names of the properties."""
        return frozenset(prop.name for prop in self.by_iri.values())

    def _is_known(self, p: Term) -> bool:
        return p in self.by_iri or p in STRUCTURAL

    @cached_property
    def _individuals(self) -> dict[str, set[Term]]:
        """The names and labels of the individuals that the TBox declares."""
        words: dict[str, set[Term]] = {}
        for i in self._of_the_tbox:
            self._note(words, i)
        return words

    def _term(self, word: str) -> Term | None:
        """Return a term that is written as an IRI or with a known prefix, or None for another word."""
        prefix, colon, name = word.partition(":")
        if word.startswith("<") and word.endswith(">"):
            return word
        if name.startswith("//"):
            return v.iri(word)
        return v.iri(self._prefixes[prefix] + name) if colon and prefix in self._prefixes else None

    def _note(self, words: dict[str, set[Term]], term: Term) -> None:
        for word in (v.entity_name(term), v.local_name(term), *self._labels(term).values()):
            words.setdefault(_fold(word), set()).add(term)

    def _labels(self, term: Term) -> dict[str, str]:
        asserted = sorted(o for _, _, o in self._reasoner.asserted(term, v.RDFS_LABEL) if o.startswith('"'))
        return {v.language_of(o) or "": v.lexical(o) for o in asserted}

    def _is(self, p: Term, kind: Term) -> bool:
        return any(self._reasoner.asserted(p, v.RDF_TYPE, kind))

    def _above(self, p: Term) -> set[Term]:
        """Return the property and its superproperties."""
        found, level = {p}, [p]
        while level:
            level = [
                o
                for q in level
                for _, _, o in self._reasoner.asserted(q, v.RDFS_SUB_PROPERTY_OF)
                if o not in found and not found.add(o)  # type: ignore[func-returns-value]
            ]
        return found


def _content(about: About, value: Term, above: tuple[Term, ...]) -> Value:
    """Return a value as JSON; a nameless one as text: `[width 0.05]`, or `(cup1 cup2)` for a list."""
    if not value.startswith("_:"):
        return property_values.to_json_value(value)
    if value in above or len(above) == _DEEPEST:
        return "[...]"

    def text(node: Term) -> str:
        return value_in_words(_content(about, node, (*above, value)))

    items: list[str] = []
    rest = value
    while (first := about(rest).get(v.RDF_FIRST)) and len(items) < _FEW:
        items.append(text(first[0]))
        rest = next(iter(about(rest).get(v.RDF_REST, ())), v.RDF_NIL)
    if items:
        return f"({' '.join(items)}{'' if rest == v.RDF_NIL else ' ...'})"
    edges = [(p, o) for p, objects in sorted(about(value).items()) for o in objects]
    parts = sorted(f"{v.local_name(p)} {text(o)}" for p, o in edges[:_FEW])
    return f"[{', '.join(parts)}{', ...' if edges[_FEW:] else ''}]"


def _shown(prop: Property, values: Iterable[Value]) -> tuple[str, property_values.Stated]:
    values = tuple(sorted(values, key=str))
    return prop.name, values[0] if prop.functional and len(values) == 1 else values


def _label(labels: Mapping[str, str]) -> str:
    return labels.get("en") or labels.get("") or next(iter(labels.values()), "")


def _fold(word: str) -> str:
    return "".join(word.split()).replace("_", "").casefold()
