"""Resolves the noun phrases of questions about the past, also those of entities that no longer exist."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from datetime import datetime
from typing import Final

from semmap.nodes.kb_node.answers.command_parser import MOST_WORDS
from semmap.nodes.kb_node.answers.entity_search import EntitySearch
from semmap.nodes.kb_node.answers.past.commit_selection import Authorship
from semmap.nodes.kb_node.answers.past.episodes.resolved import Referent, ResolvedQuestion
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.language.past.question import Claim, PastQuestion
from semmap.nodes.language.past.reading import read_questions
from semmap.nodes.language.words import split
from semmap.schemas import errors
from semmap.schemas.language import Language
from semmap.schemas.wording import few

_LANGUAGES: Final[tuple[Language, ...]] = ("english", "italian")
_FEW: Final = 5


class PastQuestionReader:
    """Reads questions about the past and resolves their words. Owned by the node's thread."""

    def __init__(
        self, semantic_map: SemanticMap, search: EntitySearch, journal: Journal, past: HistoryReader
    ) -> None:
        self._map, self._search, self._journal, self._past = semantic_map, search, journal, past
        self._authors: dict[str, str] = {}
        self._read = 0

    def read(self, text: str, language: Language | None) -> tuple[Language, list[ResolvedQuestion]]:
        """Return the questions about the past in a text; none if it is not one, or too long for a command."""
        if len(split(text)) > MOST_WORDS:
            return language or "english", []
        former = self._former_names()
        self._read_authors()
        names = {name.casefold() for name in former} | self._authors.keys()
        languages = _LANGUAGES if language is None else (language,)
        found, questions = read_questions(text, self._search.known(), names, datetime.now(), languages)
        resolved: list[ResolvedQuestion] = []
        it: tuple[str, ...] = ()
        for question in questions:
            one = self._resolve(question, found, former, it)
            resolved.append(one)
            subjects = [one.referents[text] for text in question.claim.subjects if text in one.referents]
            it = next((referent.names for referent in subjects if referent.names), it)
        return found, resolved

    def _former_names(self) -> Set[str]:
        """Return the names of entities that no longer exist."""
        touched = {name for name, _ in self._journal.last_touches(self._journal.last)}
        return (touched | self._past.initial_entities().keys()) - set(self._map.names)

    def _read_authors(self) -> None:
        """Read the authors of new commits."""
        first = max(self._read, self._journal.first - 1)
        for row in self._journal.rows(first):
            commit = body_encoding.decode(row.body, Authorship)
            self._authors.update({name.casefold(): name for name in (commit.source, commit.agent) if name})
            self._read = commit.seq

    def _resolve(
        self, question: PastQuestion, language: Language, former: Set[str], it: tuple[str, ...]
    ) -> ResolvedQuestion:
        referents: dict[str, Referent] = {}
        asks: list[str] = []
        agents = {claim.agent for claim in (question.claim, question.anchored) if claim is not None}
        for text in _phrases(question):
            if text in ("it", "") or text in referents:
                continue
            referents[text] = found = self._referent(text, former, is_agent=text in agents)
            is_kind = text == question.claim.kind or question.asked in ("what", "how_many")
            if len(found.names) > 1 and not found.is_plural and not is_kind:
                asks.append(self._search.question(found.names, language))
        if not it and question.anchored is not None:  # before cup1 was moved, where was it
            places = (text for _, text in question.claim.places)  # what was in it when it was closed
            others = (referents.get(text) for text in (*question.anchored.subjects, *places))
            it = next((found.names for found in others if found is not None and found.names), ())
        return ResolvedQuestion(question, referents, it, asks)

    def _referent(self, text: str, former: Set[str], *, is_agent: bool) -> Referent:
        """Return what a noun phrase denotes."""
        if text == "you":
            return self._robot()
        author = self._author(text, ())
        if self._map.find(text) is not None:
            return Referent(text, (text,), author=self._author(text, (text,)))
        by_name = {name.casefold(): name for name in (*former, *self._map.names)}
        plain = text.partition(" ")[2] if text.partition(" ")[0] in ("the", "il", "la", "lo", "l'") else text
        name = by_name.get(plain.replace(" ", "").casefold()) or by_name.get(
            plain.replace(" ", "_").casefold()
        )
        if name is not None:
            return Referent(text, (name,), author=self._author(text, (name,)))
        names, is_one = self._search.denoted(text)
        if not names:
            names = self._former(plain, former)
        if names:
            problem = "" if not is_one else f"'{text}' may be {few(names, _FEW)}"
            return Referent(
                text, names, problem, self._author(text, names), is_plural=not is_one and len(names) > 1
            )
        if author:
            return Referent(text, author=author)
        hint = errors.did_you_mean(plain, sorted(by_name))
        if is_agent:
            return Referent(text, problem=f"no commit is by '{text}'")
        return Referent(text, problem=f"'{text}' is not known, now or in the past{hint}")

    def _robot(self) -> Referent:
        """Return the robot that *you* means: the only one of the map."""
        robots = tuple(sorted(e.name for e in self._map.entities() if "Robot" in e.types))
        problem = f"'you' may be {few(robots, _FEW)}" if robots else "no robot is known"
        problem = "" if len(robots) == 1 else problem
        return Referent("you", robots, problem, self._author("you", robots))

    def _author(self, text: str, names: Sequence[str]) -> str:
        """Return the author of commits that is called so, or as one of these entities."""
        words = [text, *names]
        for name in names:
            if (entity := self._map.find(name)) is not None:
                words += [*filter(None, (entity.preferred_reference,)), *entity.alternative_references]
        found = (self._authors.get(word.casefold().removeprefix("the ")) for word in words)
        return next(filter(None, found), "")

    def _former(self, text: str, former: Set[str]) -> tuple[str, ...]:
        """Return the entities that no longer exist with a label or class that is this text."""
        found = []
        for name in sorted(former)[:1000]:
            entity = next(
                (
                    e
                    for seq in reversed(self._journal.touching(name))
                    for e in self._journal.commit(seq).changed
                    if e.name == name
                ),
                self._past.initial_entities().get(name),
            )
            if entity is None:
                continue
            labels = (
                entity.preferred_reference,
                *entity.alternative_references,
                *entity.other_names,
                entity.class_,
            )
            if text.casefold() in (label.casefold() for label in labels if label):
                found.append(name)
        return tuple(found)


def _phrases(question: PastQuestion) -> Iterator[str]:
    for claim in (question.claim, question.anchored):
        if claim is not None:
            yield from _claim_phrases(claim)


def _claim_phrases(claim: Claim) -> Iterator[str]:
    yield from claim.subjects
    yield claim.kind
    yield from (text for _, text in claim.places)
    if claim.agent:
        yield claim.agent
