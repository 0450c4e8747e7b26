"""The words for terms in a sentence: classes by their labels, properties as verb phrases.

English labels and labels without a language are used. A property's label is a verb phrase ("is on",
"supports", "has color") or a noun ("mass"), which is used with "has". The name of a property without a label
is split into words: `isOn`, `has_color`. Individuals and classes without a label keep their local names.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from typing import Final, Literal, NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import PREFIXES, TYPE, iri, iris, is_literal, is_named, literal

_LABEL: Final = iri("rdfs:label")
_DATA: Final = iri("owl:DatatypeProperty")
_HUMPS: Final = re.compile(r"[_\s.-]+|(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_LINKS: Final = frozenset(
    {"of", "in", "on", "at", "to", "by", "from", "with", "for", "near", "inside", "under", "as"}
)
"""A name without a verb that ends in one of these words gets an "is": `partOf` is "is part of"."""
PLACEHOLDER: Final = "\ue000"
"""The first character of the names in a sentence that are replaced by others."""
_PREPOSITIONS: Final = _LINKS | {
    *("about", "above", "across", "after", "against", "along", "around", "as", "before", "behind", "below"),
    *("beside", "between", "into", "like", "onto", "out", "over", "through", "up", "upon", "within"),
}
"""Last words of a verb phrase that are not a noun: "contains zone" is "contains it as zone"."""
_VERBS_OF_VALUES: Final = frozenset(
    (
        *("weighs", "costs", "measures", "lasts", "holds", "contains"),
        *("opens", "closes", "starts", "begins", "ends", "expires"),
    )
)
"""First words of data properties that are verbs: those of measures and of beginnings and ends.

A list, because neither the ending nor the TBox distinguishes them from plurals ("hours", "seats"), which are
more frequent in names of data properties. The verbs that take a value without a preposition are few.
"""
_NO_VERB: Final = ("ss", "us", "is", "as", "os")
"""Endings in s of words that are not verbs."""
_PLAIN_VALUES: Final = frozenset(
    term[1:-1]
    for term in iris(
        "xsd:float xsd:double xsd:decimal xsd:integer xsd:boolean xsd:int xsd:long xsd:short xsd:byte "
        "xsd:nonNegativeInteger xsd:positiveInteger xsd:unsignedInt xsd:unsignedByte xsd:unsignedShort"
    )
)
"""Datatypes whose values are written without quotation marks."""
_LETTERS: Final = re.compile(r"(?!true$|false$|INF$|NaN$)[^\W\d]|$")
"""Matches text that is not a number although its datatype is numeric."""
_UNCOUNTABLE: Final = frozenset(
    (
        *("bread", "butter", "cheese", "clothing", "crockery", "cutlery", "equipment", "flour", "food"),
        *("furniture", "juice", "luggage", "meat", "milk", "oil", "pasta", "rice", "salt", "sugar", "water"),
        *("coordinates", "headphones", "scissors", "stairs", "trousers"),
    )
)
"""Nouns without an article, also as the last word of a label. All nouns in -ware are uncountable, too."""
_LIKE_YOU: Final = re.compile(r"U[A-Z]|(?i:eu|uni(?![dmn])|u[^\Waeiounp][aeiou])")
"""The beginning of a noun that is spoken as "you": a unit, a utensil, a USB hub, but an umbrella."""
_BOOLEAN: Final = PREFIXES["xsd"] + "boolean"


class VerbPhrase(NamedTuple):
    """The verb phrase of a property."""

    kind: Literal["is", "has", "does"]
    rest: str
    """The words after "is" or "has". For other verbs the whole phrase, in the third person."""

    def with_object(self, object_: str) -> str:
        """Return the phrase with an object: "is on table1"."""
        return f"{self.rest if self.kind == 'does' else f'{self.kind} {self.rest}'} {object_}"

    def with_negation(self, object_: str) -> str:
        """Return the negated phrase: "does not support table1"."""
        start = {"is": "is not", "has": "does not have", "does": "does not"}[self.kind]
        return f"{start} {base_form(self.rest) if self.kind == 'does' else self.rest} {object_}"

    def with_pronoun(self, object_: str) -> str:
        """Return the phrase with a pronoun as object: "has another as part", "is on it"."""
        verb, _, rest = self.rest.partition(" ")
        if self.kind == "has":
            return f"has {object_} as {self.rest}"
        if self.kind == "does" and rest and rest.rpartition(" ")[2] not in _PREPOSITIONS:
            return f"{verb} {object_} as {rest}"
        return self.with_object(object_)

    def with_count(self, number: str, kind: str = "") -> str:
        """Return the phrase with a number: "is on at most one table", "has at most one color"."""
        if self.kind == "has":
            return f"has {number} {self.rest}" + (f" that is {article(kind)}" if kind else "")
        return self.with_object("nothing" if (number, kind) == ("no", "") else f"{number} {kind or 'thing'}")

    @property
    def plural(self) -> str:
        """The phrase for several subjects: "are on", "support", "have"."""
        return {"is": f"are {self.rest}", "has": f"have {self.rest}", "does": base_form(self.rest)}[self.kind]


class Words:
    """The labels of a graph, with names for terms without labels."""

    def __init__(self, labels: Mapping[Term, str], data_properties: frozenset[Term]) -> None:
        self._labels = dict(labels)
        self._data = data_properties
        self._verbs: dict[Term, VerbPhrase] = {}
        self.name_individual: Callable[[Term], str] = local_name
        """Returns the name of an individual with an IRI."""

    @classmethod
    def of(cls, triples: Iterable[Triple]) -> Words:
        """Read the labels of a graph."""
        labels: dict[Term, str] = {}
        data: set[Term] = set()
        for s, p, o in triples:
            if p == _LABEL and is_literal(o):
                text, _, language = literal(o)
                if language.lower().startswith("en") or (not language and s not in labels):
                    labels[s] = text
            elif p == TYPE and o == _DATA:
                data.add(s)
        return cls(labels, frozenset(data))

    def disambiguate(self, names: Mapping[Term, str]) -> None:
        """Use these names for classes whose labels are equal."""
        counts = Counter(map(self.cls, names))
        self._labels.update([(c, name) for c, name in names.items() if counts[self.cls(c)] > 1])

    def name(self, term: Term) -> str:
        """Return the name of an individual, or a value."""
        if is_literal(term):
            text, datatype, _ = literal(term)
            is_plain = datatype in _PLAIN_VALUES and not _LETTERS.match(text)
            return text if is_plain else f'"{text}"'
        if PLACEHOLDER in term:  # of the template of a sentence
            return local_name(term) if is_named(term) else term[2:]
        return self.name_individual(term) if is_named(term) else term

    def cls(self, term: Term) -> str:
        """Return the label of a class, or its local name."""
        return self._labels.get(term) or local_name(term)

    def verb_phrase(self, prop: Term) -> VerbPhrase:
        """Return the verb phrase of a property."""
        found = self._verbs.get(prop)
        if found is None:
            label = self._labels.get(prop) or _split_name(local_name(prop))
            if label[1:] == label[1:].lower():  # "Has part" in the middle of a sentence
                label = f"{label[:1].lower()}{label[1:]}"
            found = self._verbs[prop] = _verb(label, prop in self._data)
        return found

    def predicate_phrase(
        self, prop: Term, object_: Term, *, negated: bool = False, reflexive: bool = False
    ) -> str:
        """Return the predicate of a sentence: "is on table1", or for false "is not open"."""
        verb = self.verb_phrase(prop)
        truth = _truth(object_)
        if truth is not None and verb.kind == "is":
            return f"is {verb.rest}" if truth != negated else f"is not {verb.rest}"
        if reflexive and not negated:
            return verb.with_pronoun("itself")
        name = "itself" if reflexive else self.name(object_)
        return verb.with_negation(name) if negated else verb.with_object(name)

    def is_data(self, prop: Term) -> bool:
        """Return whether a property is declared as a data property."""
        return prop in self._data


def is_uncountable(noun: str) -> bool:
    """Return whether a noun takes neither "a" nor "every"."""
    last = noun.rpartition(" ")[2]
    return last in _UNCOUNTABLE or last.endswith("ware")


def article(noun: str) -> str:
    """Return a noun with "a" or "an"."""
    if not noun[:1].isalnum() or noun.startswith(("something ", "anything ", "a ", "an ", "one of ")):
        return noun
    if is_uncountable(noun):
        return noun
    begins_with_vowel = noun[0] in "aeiouAEIOU" and not _LIKE_YOU.match(noun)
    return f"{'an' if begins_with_vowel else 'a'} {noun}"


@lru_cache(maxsize=4096)
def local_name(term: Term) -> str:
    """Return the last part of an IRI."""
    return re.split(r"[#/]", term.strip("<>").rstrip("#/"))[-1] or term


def _truth(term: Term) -> bool | None:
    if not is_literal(term) or literal(term).datatype != _BOOLEAN:
        return None
    return {"true": True, "1": True, "false": False, "0": False}.get(literal(term).text)


def _split_name(name: str) -> str:
    """Split a name into words: `isOn` is "is on". Words in capitals are kept."""
    words = filter(None, _HUMPS.split(name))
    return " ".join(word if word.isupper() and len(word) > 1 else word.lower() for word in words) or name


def _verb(phrase: str, is_data: bool) -> VerbPhrase:
    first, _, rest = phrase.strip().partition(" ")
    if first in ("is", "has") and rest:
        return VerbPhrase("is", rest) if first == "is" else VerbPhrase("has", rest)
    last = phrase.rpartition(" ")[2]
    is_verb = first.endswith("s") and len(first) > 3 and not first.endswith(_NO_VERB)
    if is_verb and (not is_data or last in _LINKS or first in _VERBS_OF_VALUES):
        return VerbPhrase("does", phrase)
    if last in _LINKS:
        return VerbPhrase("is", phrase)
    return VerbPhrase("has", phrase)


def base_form(phrase: str) -> str:
    """Return a third-person verb phrase as it follows "does not"."""
    verb, blank, rest = phrase.partition(" ")
    if verb.endswith("ies"):
        verb = verb[:-3] + "y"
    elif verb.endswith(("ches", "shes", "sses", "xes", "zes", "oes")):
        verb = verb[:-2]
    else:
        verb = verb.removesuffix("s")
    return verb + blank + rest
