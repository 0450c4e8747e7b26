"""Commands in words, resolved against the current map: the command `understand`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import Final

from msgspec import structs

from semmap.nodes.kb_node.answers.entity_search import EntitySearch
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.language import lexicon
from semmap.nodes.language.steps.reading import read_steps
from semmap.nodes.language.understanding.grounding import Scene, Thing, scene
from semmap.nodes.language.understanding.interpretation import shipped
from semmap.nodes.language.vocabulary import Vocabulary, vocabulary
from semmap.nodes.language.words import split
from semmap.schemas import errors
from semmap.schemas.commands import Understand
from semmap.schemas.entities import Entity
from semmap.schemas.language import SemanticFrame, Understood

MOST_WORDS: Final = 200
"""The most words of a command: a minute of speech."""


class CommandParser:
    """Parses commands and resolves them against the map. Owned by the node's thread."""

    def __init__(
        self, semantic_map: SemanticMap, search: EntitySearch, seen: Callable[[str], str] = lambda name: ""
    ) -> None:
        """Create a parser.

        `search` resolves descriptions and formulates clarification questions. `seen` returns in words when an
        entity was last seen.
        """
        self._map, self._search, self._seen = semantic_map, search, seen
        self._lexicon = lexicon.load()
        self._classes: ClassTable | None = None
        self._vocabulary: Vocabulary | None = None
        self._scene: tuple[int, Scene] | None = None

    def parse(self, query: Understand) -> Understood:
        """Return the frames of a command and clarification questions.

        Raises BadRequest for no words or too many.
        """
        words = split(query.text)
        if not words:
            raise errors.BadRequest("the command contains no words")
        if len(words) > MOST_WORDS:
            raise errors.BadRequest(f"the command has {len(words)} words; the maximum is {MOST_WORDS}")
        found = shipped().understand(query.text, self._there(), query.language, self._search.described)
        open_still = dict.fromkeys(
            argument.candidates
            for frame in found.frames
            for argument in frame.arguments
            if argument.ambiguous
        )
        questions = (self._search.question(names, found.language) for names in open_still)
        doubts = dict.fromkeys(doubt for frame in found.frames for doubt in self._doubts(frame))
        found = structs.replace(found, question=" ".join(questions), doubts=tuple(doubts))
        return self._with_steps(query.text, found)

    def _with_steps(self, text: str, found: Understood) -> Understood:
        """Add the steps; if there are any, doubts, unknown verbs and questions are about them."""
        scene = self._there()
        with self._search.world(scene.vocabulary.above, self._seen) as world:
            read = read_steps(text, world, None if found.language == "english" else scene)
        if found.mood == "past" and not (read.steps and read.commands):
            return found
        if not read.steps:
            return structs.replace(
                found,
                doubts=tuple(dict.fromkeys((*found.doubts, *read.doubts))),
                unknown=tuple(dict.fromkeys((*found.unknown, *read.unknown))),
            )
        questions = (self._search.question(names, found.language) for names in dict.fromkeys(read.ambiguous))
        return structs.replace(
            found,
            steps=tuple(read.steps),
            question=" ".join(questions),
            doubts=tuple(read.doubts),
            unknown=tuple(read.unknown),
            answer="; ".join(read.answers),
            **({"mood": "question", "frames": (), "groundings": ()} if read.asks else {"mood": "command"}),
        )

    def _doubts(self, frame: SemanticFrame) -> Iterator[str]:
        """Yield the parts of a frame that do not match the map."""
        for argument in frame.arguments:
            there = len(argument.candidates) or int(argument.entity is not None)
            if argument.number is not None and there < argument.number:
                yield f"'{argument.text}': there {'is' if there == 1 else 'are'} only {there}"
        sources = [a.entity for a in frame.arguments if a.role == "Source" and a.entity]
        things = [a.entity for a in frame.arguments if a.role == "Theme" and a.entity]
        for thing, source in product(things, sources):
            if thing != source and not self._search.is_at(thing, source):
                where = self._search.where(thing)
                yield f"{thing} is not on or in {source}" + (f"; it is {where}" if where else "")

    def _there(self) -> Scene:
        """Return the scene after the last commit."""
        if self._classes is not self._map.classes:
            self._classes, self._scene = self._map.classes, None
            self._vocabulary = _named(self._map.classes, self._lexicon)
        if self._vocabulary is None:
            raise errors.InternalError("the vocabulary of the map was not read")
        if self._scene is None or self._scene[0] != self._map.seq:
            things = map(_thing, self._map.entities())
            self._scene = (self._map.seq, scene(things, self._vocabulary, self._lexicon))
        return self._scene[1]


def _named(classes: ClassTable, known: lexicon.Lexicon) -> Vocabulary:
    rows = classes.rows
    labels = [(row.name, text) for row in rows for text in (*row.labels.values(), *row.also, row.name)]
    return vocabulary(labels, ((row.name, above) for row in rows for above in row.parents), known)


def _thing(entity: Entity) -> Thing:
    references = filter(
        None,
        (entity.preferred_reference, *entity.alternative_references, *entity.other_names, entity.name),
    )
    at = None if entity.pose is None else entity.pose.position_m
    return Thing(entity.name, entity.class_, tuple(references), at, entity.types)
