"""Word-by-word translation to English, and mapping of the result back to the original words.

So the models that were trained on English can be used for languages without a training corpus.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from msgspec.structs import replace

from semmap.nodes.language.words import PartOfSpeech
from semmap.schemas.language import Argument, Grounded, Language, Understood


@dataclass(frozen=True, slots=True)
class Glossed:
    """An English word for words `first` to `last` of a sentence, from 1; first > last: it has no original."""

    text: str
    first: int
    last: int
    head: int  # the head of these words
    kind: PartOfSpeech | None = None  # if it is known
    is_plural: bool = False  # the original is plural, which the English word does not show


@dataclass(frozen=True, slots=True)
class Gloss:
    """A sentence and its English words, possibly in another order."""

    original: tuple[str, ...]
    words: tuple[Glossed, ...]

    @property
    def texts(self) -> tuple[str, ...]:
        """The English words."""
        return tuple(word.text for word in self.words)

    @property
    def kinds(self) -> tuple[PartOfSpeech | None, ...]:
        """Their parts of speech, None if the tagger has to determine them."""
        return tuple(word.kind for word in self.words)

    def original_words(self, first: int, last: int) -> str:
        """Return the original words for the English ones from index `first` to `last`."""
        tokens = self._original_tokens(range(first + 1, last + 2))
        return " ".join(self.original[tokens[0] - 1 : tokens[-1]]) if tokens else ""

    def map_back(self, understood: Understood, language: Language) -> Understood:
        """Map a result for the English words back to the original words, without inserted words."""
        frames = tuple(
            replace(
                frame,
                verb=self._original_tokens(frame.verb),
                arguments=tuple(mapped for a in frame.arguments if (mapped := self._argument(a)) is not None),
            )
            for frame in understood.frames
        )
        groundings = {
            token: found.entity
            for found in understood.groundings
            for token in self._original_tokens((found.token,))
        }
        return Understood(
            self.original,
            frames,
            tuple(Grounded(token, name) for token, name in sorted(groundings.items())),
            understood.unknown,
            language,
            understood.mood,
        )

    def _original_tokens(self, tokens: Sequence[int]) -> tuple[int, ...]:
        words = (self.words[token - 1] for token in tokens)
        return tuple(sorted({n for word in words for n in range(word.first, word.last + 1)}))

    def _argument(self, argument: Argument) -> Argument | None:
        tokens = self._original_tokens(range(argument.span[0], argument.span[1] + 1))
        if not tokens:
            return None
        first, last = tokens[0], tokens[-1]
        head = min(max(self.words[argument.head - 1].head, first), last)
        inside = self.words[argument.span[0] - 1 : argument.span[1]]
        return replace(
            argument,
            text=" ".join(self.original[first - 1 : last]),
            span=(first, last),
            head=head,
            ambiguous=argument.ambiguous and not any(word.is_plural for word in inside[:2]),
        )
