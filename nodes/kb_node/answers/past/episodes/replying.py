"""The reply of `understand` to questions about the past."""

from __future__ import annotations

from collections.abc import Sequence

from semmap.nodes.kb_node.answers.past.episodes.answering import answer
from semmap.nodes.kb_node.answers.past.episodes.resolved import ResolvedQuestion
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.language.words import split
from semmap.schemas.language import Language, Understood


def answer_questions(
    timeline: Timeline, text: str, language: Language, asked: Sequence[ResolvedQuestion]
) -> Understood:
    """Return the answers to the questions in a text. For any thread."""
    answers = tuple(answer(timeline, one) for one in asked)
    doubts = [f"'{words}' is not understood" for one in asked for words in one.question.doubts]
    return Understood(
        words=tuple(split(text)),
        frames=(),
        groundings=(),
        language=language,
        mood="question",
        question=" ".join(dict.fromkeys(text for one in asked for text in one.questions)),
        doubts=tuple(dict.fromkeys(doubts)),
        answer="; ".join(one.text for one in answers),
        past=answers,
    )
