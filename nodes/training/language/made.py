"""Commands generated from patterns, with matching maps."""

from __future__ import annotations

import random
import re
import tomllib
from importlib import resources
from typing import Final, NamedTuple

from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding.grounding import Thing
from semmap.nodes.language.vocabulary import Vocabulary
from semmap.nodes.training.language.corpus import Example, Filled, Role

_ITEM: Final = re.compile(r"\((\S+) ([^()]*)\)|(\S+)")
_DRAWN: Final = re.compile(r"\{(far_)?([\w:]+)\}")
_SIZE_M: Final = 15.0  # of a map: as in the corpus
_SPREAD_M: Final = 1.0  # how far from a thing is still near it
_MENTIONED: Final = ("Theme", "Ground", "Entity", "Sought_entity")
_WITH_PLACES, _IN_MAP, _POLITE = 0.6, 0.8, 0.12  # shares of the examples

_At = tuple[float, float, float]


def examples(times: int, known: Vocabulary, language: str = "english", seed: int = 0) -> list[Example]:
    """Return examples of every pattern of a language, with random words; reproducible for a seed."""
    folder = resources.files(__package__)
    patterns = [
        line
        for line in (folder / f"{language}.txt").read_text("utf-8").splitlines()
        if line and not line.startswith("#")
    ]
    maker = _Maker(tomllib.loads((folder / f"{language}.toml").read_text("utf-8")), known, language, seed)
    return [maker.make(pattern, f"{n}-{k}") for n, pattern in enumerate(patterns) for k in range(times)]


class _Open(NamedTuple):
    """A frame that is being built."""

    name: str
    verb: list[int]
    arguments: list[Role]


class _Maker:
    """Samples the words of patterns."""

    def __init__(self, table: dict[str, list[str]], known: Vocabulary, language: str, seed: int) -> None:
        self._table = table
        self._placed = table["placed"]
        self._known = known
        self._frames = lexicon.load(language).frames
        self._random = random.Random(seed)

    def make(self, pattern: str, name: str) -> Example:
        """One example of a pattern."""
        chance = self._random
        words: list[str] = []
        frames: list[_Open] = []
        ahead: list[tuple[int, Role]] = []  # index of the frame to come
        things: list[tuple[str, str, _At]] = []  # kind, words, place
        theme: _At | None = None
        if chance.random() < _POLITE:
            words.append(chance.choice(["please", "robot"]))
        chosen = re.sub(r"\[([^\]]*)\]", lambda found: chance.choice(found[1].split("|")), pattern)
        for roles, text, word in _ITEM.findall(chosen):
            if roles:
                first = len(words) + 1
                beside = theme if roles == "Source" else None
                for token in text.split():
                    said, kind, is_far = self._draw(chance.choice(token.split("|")))
                    if kind in self._placed:
                        at = self._somewhere(None if is_far or kind == "place" else beside)
                        beside = beside or at
                        things.append((kind, " ".join(said), at))
                        if theme is None and roles in _MENTIONED:
                            theme = at
                    words += said
                for role in roles.split("+"):
                    span = Role(role.lstrip(">"), first, len(words))
                    if role.startswith(">"):
                        ahead.append((len(frames) + role.count(">") - 1, span))
                    else:
                        frames[-1].arguments.append(span)
            elif word.startswith("*"):
                verbs, frame = word.replace("*", "").split("/")
                words += self._draw(chance.choice(verbs.split("|")))[0]
                if frame == "+":
                    frames[-1].verb.append(len(words))
                else:
                    early = [span for n, span in ahead if n == len(frames)]
                    frames.append(_Open(frame, [len(words)], early))
            else:
                words += self._draw(chance.choice(word.split("|")))[0]
        if chance.random() < _POLITE:
            words.append("please")
        filled = tuple(Filled(frame.name, tuple(frame.verb), tuple(frame.arguments)) for frame in frames)
        return Example(name, "made", tuple(words), filled, self._map(things))

    def _draw(self, token: str) -> tuple[list[str], str, bool]:
        """Return the words for a token of a pattern, the sampled entity, and whether it must be far away."""
        found = _DRAWN.fullmatch(token)
        if found is None:
            return [token], "", False
        kind = found[2]
        if kind.startswith("verb:"):
            frame = kind.removeprefix("verb:")
            verbs = [verb for verb, known in self._frames.items() if known[0] == frame and " " not in verb]
            return [self._random.choice(verbs)], kind, False
        return self._random.choice(self._table[kind]).split(), kind, found[1] is not None

    def _somewhere(self, beside: _At | None) -> _At:
        chance = self._random
        if beside is None:
            return chance.uniform(0.0, _SIZE_M), chance.uniform(0.0, _SIZE_M), 0.0
        x, y, z = beside
        return x + chance.uniform(-_SPREAD_M, _SPREAD_M), y + chance.uniform(-_SPREAD_M, _SPREAD_M), z

    def _map(self, things: list[tuple[str, str, _At]]) -> tuple[Thing, ...]:
        with_places = self._random.random() < _WITH_PLACES
        return tuple(
            Thing(f"thing{n}", self._class_of(kind, text), (text,), at if with_places else None)
            for n, (kind, text, at) in enumerate(things)
            if self._random.random() < _IN_MAP
        )

    def _class_of(self, kind: str, text: str) -> str:
        if kind == "person":
            return "Person"
        return self._known.class_of(text) or self._known.class_of(text.split()[-1]) or "Object"
