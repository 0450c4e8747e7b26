"""Grounding: the entities of the map that the words of a sentence denote."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from semmap.nodes.language.lexicon import Lexicon
from semmap.nodes.language.phrases import Phrase
from semmap.nodes.language.vocabulary import Vocabulary, to_words
from semmap.nodes.language.words import Word, to_base_forms

_CONTENT = ("noun", "adj", "pron", "num")


@dataclass(frozen=True, slots=True)
class Thing:
    """An entity with its labels, position `at` [m, map frame] and inferred classes `types`."""

    name: str
    class_name: str
    references: tuple[str, ...] = ()
    at: tuple[float, float, float] | None = None
    types: tuple[str, ...] = ()


Things = tuple[Thing, ...]


@dataclass(frozen=True, slots=True)
class Scene:
    """The entities of the map by label and class."""

    by_label: Mapping[str, Things]  # label or class, as written and in base form
    of_class: Mapping[str, Things]  # class, its subclasses included
    only: Mapping[str, Things]  # class, without its subclasses
    vocabulary: Vocabulary
    things: Mapping[str, Thing]  # by name

    def kinds_of(self, name: str) -> frozenset[str]:
        """Return the asserted and inferred classes of a named entity with their superclasses, or none."""
        thing = self.things.get(name)
        if thing is None:
            return frozenset()
        above = self.vocabulary.above
        classes = (thing.class_name, *thing.types)
        return frozenset(classes).union(*(above.get(c, ()) for c in classes))


def scene(things: Iterable[Thing], known: Vocabulary, lexicon: Lexicon) -> Scene:
    """Return the index of a map's entities. The order of the entities does not matter."""
    named: dict[str, Thing] = {}
    called: dict[str, dict[Thing, None]] = {}
    of_class: dict[str, list[Thing]] = {}
    only: dict[str, list[Thing]] = {}
    for thing in things:
        named[thing.name] = thing
        for text in (*thing.references, thing.class_name):
            words = to_words(text)
            for form in (words, to_base_forms(words, lexicon), words.replace(" ", "")):
                called.setdefault(form, {})[thing] = None
        name = known.class_of(to_words(thing.class_name)) or thing.class_name
        only.setdefault(name, []).append(thing)
        for above in known.above.get(name, (name,)):
            of_class.setdefault(above, []).append(thing)
    return Scene(
        {text: tuple(found) for text, found in called.items()},
        {name: tuple(found) for name, found in of_class.items()},
        {name: tuple(found) for name, found in only.items()},
        known,
        named,
    )


def distance(one: Thing, other: Thing) -> float:
    """Return the horizontal distance of two things [m], infinite if a position is unknown."""
    if one.at is None or other.at is None:
        return math.inf
    return math.hypot(one.at[0] - other.at[0], one.at[1] - other.at[1])


def find_by_label(text: str, among: Scene, lexicon: Lexicon) -> Things:
    """Return the things that a text may denote: by label, class, subclass or superclass."""
    base = to_base_forms(text, lexicon)
    for form in (text, base, text.replace(" ", ""), text.replace("-", "")):
        if form in among.by_label:
            return among.by_label[form]
    class_name = among.vocabulary.class_of(text) or among.vocabulary.class_of(base)
    if class_name is None:
        return ()
    if class_name in among.of_class:
        return among.of_class[class_name]
    above = among.vocabulary.nameable_above(class_name)
    return next((among.only[name] for name in above if name in among.only), ())


def find_candidates(phrase: Phrase, words: Sequence[Word], among: Scene, lexicon: Lexicon) -> Things:
    """Return what a phrase may denote: by several words (longest first), its head, or any other word."""
    content = [i for i in range(phrase.nominal, phrase.last + 1) if words[i].kind in _CONTENT]
    for length in range(len(content), 1, -1):
        for start in range(len(content) - length + 1):
            text = " ".join(words[i].text for i in content[start : start + length])
            found = find_by_label(text, among, lexicon)
            if found:
                return found
    for i in (phrase.head, *reversed(content)):
        found = find_by_label(words[i].text, among, lexicon)
        if found:
            return found
    return ()
