"""A sentence told with English words one by one, and what was understood of it told back in its own words.

What was learnt of English so holds of a language of which there is nothing to learn from.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from msgspec.structs import replace

from semmap.nodes.language.words import PartOfSpeech
from semmap.schemas.language import Argument, Grounded, Language, Understood


@dataclass(frozen=True, slots=True)
class Glossed:
    """An English word that stands for words of a sentence, counted from 1; first > last: nobody says it."""

    text: str
    first: int
    last: int
    head: int  # the word that it is about
    kind: PartOfSpeech | None = None  # where it is known
    is_plural: bool = False  # which the English word does not tell


@dataclass(frozen=True, slots=True)
class Gloss:
    """A sentence and the English words for it, which may stand in another order."""

    said: tuple[str, ...]
    words: tuple[Glossed, ...]

    @property
    def texts(self) -> tuple[str, ...]:
        """The English words."""
        return tuple(word.text for word in self.words)

    @property
    def kinds(self) -> tuple[PartOfSpeech | None, ...]:
        """Their parts of speech, None where the words around are to tell."""
        return tuple(word.kind for word in self.words)

    def said_by_words(self, first: int, last: int) -> str:
        """The sentence's own words for the English ones from index `first` to `last`."""
        tokens = self._said_by(range(first + 1, last + 2))
        return " ".join(self.said[tokens[0] - 1 : tokens[-1]]) if tokens else ""

    def told_back(self, understood: Understood, language: Language) -> Understood:
        """What was understood of the English words as of the sentence's own; what nobody said is left out."""
        frames = tuple(
            replace(
                frame,
                verb=self._said_by(frame.verb),
                arguments=tuple(told for a in frame.arguments if (told := self._argument(a)) is not None),
            )
            for frame in understood.frames
        )
        groundings = {
            token: found.entity for found in understood.groundings for token in self._said_by((found.token,))
        }
        return Understood(
            self.said,
            frames,
            tuple(Grounded(token, name) for token, name in sorted(groundings.items())),
            understood.unknown,
            language,
            understood.mood,
        )

    def _said_by(self, tokens: Sequence[int]) -> tuple[int, ...]:
        words = (self.words[token - 1] for token in tokens)
        return tuple(sorted({n for word in words for n in range(word.first, word.last + 1)}))

    def _argument(self, argument: Argument) -> Argument | None:
        said = self._said_by(range(argument.span[0], argument.span[1] + 1))
        if not said:
            return None
        first, last = said[0], said[-1]
        head = min(max(self.words[argument.head - 1].head, first), last)
        inside = self.words[argument.span[0] - 1 : argument.span[1]]
        return replace(
            argument,
            text=" ".join(self.said[first - 1 : last]),
            span=(first, last),
            head=head,
            ambiguous=argument.ambiguous and not any(word.is_plural for word in inside[:2]),
        )
