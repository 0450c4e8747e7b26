"""Which entities of a map the words of a sentence mean."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from semmap.nodes.language.lexicon import Lexicon
from semmap.nodes.language.phrases import Phrase
from semmap.nodes.language.vocabulary import Vocabulary, spoken
from semmap.nodes.language.words import Word, based

_TELLING = ("noun", "adj", "pron", "num")


@dataclass(frozen=True, slots=True)
class Thing:
    """An entity as a listener knows it. at: metres, in the map; types: its inferred classes."""

    name: str
    class_name: str
    references: tuple[str, ...] = ()
    at: tuple[float, float, float] | None = None
    types: tuple[str, ...] = ()


Things = tuple[Thing, ...]


@dataclass(frozen=True, slots=True)
class Scene:
    """What there is to be spoken of, by what it is called."""

    called: Mapping[str, Things]  # reference or class, as it is said and in base forms
    of_class: Mapping[str, Things]  # class, its subclasses included
    only: Mapping[str, Things]  # class, without its subclasses
    vocabulary: Vocabulary
    things: Mapping[str, Thing]  # by name

    def kinds_of(self, name: str) -> frozenset[str]:
        """The classes of the entity of that name, superclasses and inferred ones too; none for no entity."""
        thing = self.things.get(name)
        if thing is None:
            return frozenset()
        above = self.vocabulary.above
        classes = (thing.class_name, *thing.types)
        return frozenset(classes).union(*(above.get(c, ()) for c in classes))


def scene(things: Iterable[Thing], known: Vocabulary, lexicon: Lexicon) -> Scene:
    """The things of a map, to be looked up. The order in which they come and are named does not matter."""
    named: dict[str, Thing] = {}
    called: dict[str, dict[Thing, None]] = {}
    of_class: dict[str, list[Thing]] = {}
    only: dict[str, list[Thing]] = {}
    for thing in things:
        named[thing.name] = thing
        for text in (*thing.references, thing.class_name):
            said = spoken(text)
            for form in (said, based(said, lexicon), said.replace(" ", "")):
                called.setdefault(form, {})[thing] = None
        name = known.class_of(spoken(thing.class_name)) or thing.class_name
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
    """Metres between two things over the ground, infinite where a place is not known."""
    if one.at is None or other.at is None:
        return math.inf
    return math.hypot(one.at[0] - other.at[0], one.at[1] - other.at[1])


def called(text: str, among: Scene, lexicon: Lexicon) -> Things:
    """The things that may be called so: by reference, class, subclass or superclass."""
    base = based(text, lexicon)
    for form in (text, base, text.replace(" ", ""), text.replace("-", "")):
        if form in among.called:
            return among.called[form]
    class_name = among.vocabulary.class_of(text) or among.vocabulary.class_of(base)
    if class_name is None:
        return ()
    if class_name in among.of_class:
        return among.of_class[class_name]
    above = among.vocabulary.nameable_above(class_name)
    return next((among.only[name] for name in above if name in among.only), ())


def meant(phrase: Phrase, said: Sequence[Word], among: Scene, lexicon: Lexicon) -> Things:
    """What a phrase may mean: by several of its words together, longest first, by its head, by the others."""
    words = [i for i in range(phrase.nominal, phrase.last + 1) if said[i].kind in _TELLING]
    for length in range(len(words), 1, -1):
        for start in range(len(words) - length + 1):
            found = called(" ".join(said[i].text for i in words[start : start + length]), among, lexicon)
            if found:
                return found
    for i in (phrase.head, *reversed(words)):
        found = called(said[i].text, among, lexicon)
        if found:
            return found
    return ()
