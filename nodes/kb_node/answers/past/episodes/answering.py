"""Answers resolved questions about the past."""

from __future__ import annotations

from typing import Final

from msgspec import structs

from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown
from semmap.nodes.kb_node.answers.past.episodes.resolved import ResolvedQuestion
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.kb_node.answers.past.episodes.verdicts import Verdicts
from semmap.schemas import errors
from semmap.schemas.episodes import PastAnswer
from semmap.schemas.wording import few

_MOST: Final = 100
_FEW: Final = 5


def answer(timeline: Timeline, resolved: ResolvedQuestion) -> PastAnswer:
    """Return the answer to a question, or why it is not known."""
    try:
        found = _Answering(timeline, resolved).answer()
    except NotKnown as unknown:
        return PastAnswer(asked=resolved.question.asked, text=str(unknown), is_known=False)
    except (errors.Refused, errors.UnknownName, errors.BadRequest) as error:
        return PastAnswer(asked=resolved.question.asked, text=str(error), is_known=False)
    return structs.replace(found, evidence=found.evidence[:_MOST])


class _Answering(Verdicts):
    """Answers any kind of question."""

    def answer(self) -> PastAnswer:
        """Return the answer, if it depends on all that the question states. Raises NotKnown."""
        if self._q.unused:
            raise NotKnown(f"'{few(self._q.unused, _FEW)}' is not understood in this question")
        found = self._answer()
        for referent in self._o.unused():
            raise NotKnown(referent.problem or f"'{referent.text}' is not understood in this question")
        return found

    def _answer(self) -> PastAnswer:
        match self._q.asked:
            case "where":
                return self._where()
            case "changed":
                return self._changed()
            case "missing":
                return self._missing()
            case "what":
                return self._what()
            case "how_many":
                found = self._what()
                return structs.replace(found, text=f"{found.count}: {found.text}")
            case "who":
                return self._who()
            case "whether":
                return self._whether()
        if not self._subjects:
            raise NotKnown("the question names no thing")
        match self._q.asked:
            case "when" | "until":
                return self._when()
            case "since":
                return self._since()
            case "how_long":
                return self._how_long()
        return self._how_often()
