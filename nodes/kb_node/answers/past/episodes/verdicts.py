"""Answers with yes or no, or with before or after."""

from __future__ import annotations

from dataclasses import replace

from msgspec import structs

from semmap.nodes.kb_node.answers.past.episodes import texts
from semmap.nodes.kb_node.answers.past.episodes.change_answers import ChangeAnswers
from semmap.nodes.kb_node.answers.past.episodes.inquiry import Span
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown
from semmap.schemas.episodes import PastAnswer


class Verdicts(ChangeAnswers):
    """Answers whether something was so."""

    def _whether(self) -> PastAnswer:
        if not self._subjects:
            return self._whether_any()
        if self._q.anchor == "compare":
            return self._compare()
        if self._claim.agent and self._is_event():
            return self._whether_by()
        episodes = self._episodes()
        is_so = len(episodes) > self._q.is_repeated
        if self._q.is_current and self._q.period.since is not None and not self._claim.event:
            is_so = self._q.is_repeated and is_so  # has it been open since 10:00: without a break
            is_so = is_so or any(e.since_ns <= self._span.first_ns and e.until_ns is None for e in episodes)
        if self._q.is_negated:
            verdict, word = not is_so, "no" if is_so else "yes"
        else:
            verdict, word = is_so, "yes" if is_so else "no"
        if episodes:
            parts = [f"at {texts.begin(e)}" if self._is_event() else texts.span(e) for e in episodes]
            text = f"{word}: {episodes[0].subject} was {episodes[0].what} {texts.listed(parts)}"
        else:
            text = f"{word}: {self._never()}"
        evidence = tuple(episodes)
        return PastAnswer(asked="whether", text=text, verdict=verdict, count=len(episodes), evidence=evidence)

    def _whether_by(self) -> PastAnswer:
        """Return whether an author did something, with who did it last."""
        author = self._o.author(self._claim)
        own = self._episodes()
        self._claim.agent = ""
        every = self._episodes()
        if not every:
            return PastAnswer(asked="whether", text=f"no: {self._never()}", verdict=False, count=0)
        last = every[-1]
        is_so = last.by.casefold() == author.casefold() if self._q.is_last else bool(own)
        if is_so and self._q.is_last and self._claim.state:  # was it Anna who left it open
            is_so = any(
                e.until_ns is None for e in self._o.of(replace(self._claim, event=""), self._subjects)
            )
        shown = own if is_so and not self._q.is_last else [last]
        parts = [f"at {texts.begin(e)}" for e in shown]
        verdict = is_so != self._q.is_negated
        text = f"{'yes' if verdict else 'no'}: {last.subject} was {last.what} {texts.listed(parts)}"
        return PastAnswer(
            asked="whether",
            text=text,
            verdict=verdict,
            names=(last.by,),
            count=len(own),
            evidence=tuple(shown),
        )

    def _compare(self) -> PastAnswer:
        """Return whether something was before or after something else."""
        episodes = self._o.of(self._claim, self._subjects)
        if not episodes:
            raise NotKnown(self._never())
        one, other = episodes[-1], self._anchor(Span())
        word = "before" if one.since_ns < other.since_ns else "after"
        parts = [f"{e.subject} was {e.what} at {texts.begin(e)}" for e in (one, other)]
        text = f"{word}: {parts[0]}, and {parts[1]}"
        return PastAnswer(asked="whether", text=text, verdict=word == "before", evidence=(one, other))

    def _whether_any(self) -> PastAnswer:
        found = self._who_was_there() if self._claim.is_anyone and not self._claim.event else self._what()
        is_so = bool(found.names)
        verdict = is_so != self._q.is_negated
        text = f"{'yes' if verdict else 'no'}: {found.text}"
        return structs.replace(found, asked="whether", verdict=verdict, text=text)
