"""Clauses of telling, asking and answering."""

from __future__ import annotations

from semmap.nodes.language.steps.clause import Clause, Role
from semmap.nodes.language.steps.phrase import NounPhrase
from semmap.nodes.language.steps.questions import QuestionReader
from semmap.nodes.language.steps.times import starts_time


class MessageReader(QuestionReader):
    """Reads clauses with a message."""

    def _tell(self, clause: Clause, i: int) -> int:
        """Read *tell me ...*: to whom, what, and of what."""
        words = self._words
        if clause.verb.lower() in ("inform", "notify") or not self._g.match("question", words, i):
            phrase = self._np.read_recipient(i)
            if (
                phrase is not None
                and clause.verb.lower()
                not in (
                    "describe",
                    "say",
                    "report",
                    "recite",
                    "explain",
                    "mention",
                    "state",
                    "announce",
                    "name",
                )
                and (phrase.kind == "speaker" or self._is_person(phrase) or phrase.kind == "pronoun")
                and phrase.kind != "robot"
                and not (
                    phrase.noun in ("it", "that", "this") and words[phrase.end : phrase.end + 1] == ("to",)
                )
                and self._words[i : i + 1] not in (("what",), ("which",))
            ):
                i = self._add_recipients(clause, i, phrase)
            elif words[i : i + 1] == ("to",) and (to := self._np.read_recipient(i + 1)) is not None:
                i = self._add_recipients(clause, i, to)
        if clause.verb.lower() == "let" and words[i : i + 1] in (("know",), ("hear",)):
            i += 1
        while words[i : i + 1] == ("about",) or (words[i : i + 1] == ("know",)):
            i += 1
        return self._told(clause, i)

    def _add_recipients(self, clause: Clause, i: int, phrase: NounPhrase) -> int:
        """Add the recipient of a message, and those after *and* or *or*; return the index after them."""
        found, end = [phrase], phrase.end
        while end < len(self._words) and self._g.is_a(self._words[end], "and") and not self._ends_clause(end):
            other = self._np.read_recipient(end + 1)
            if other is None or not (other.kind == "speaker" or self._is_person(other)):
                break
            (phrase.alternatives if self._words[end] == "or" else found).append(other)
            end = other.end
        clause.roles.append(Role("Addressee", i, end, phrase.head, found))
        return end

    def _told(self, clause: Clause, i: int) -> int:
        """Read what is to be told: a question, a property of a thing, a thing, or words."""
        g, words = self._g, self._words
        if i >= len(words) or self._ends_clause(i):
            return i
        if (end := self._condition(i)) > i and words[i] not in ("if", "whether", "when"):
            self._add_condition(clause, i, end)
            return self._told(clause, end)
        if words[i] == "," and (inserted := self._inserted(clause, i)) > i:
            return self._told(clause, inserted)
        if words[i] == "," and not self.starts_clause(i):
            return self._told(clause, i + 1)
        if (length := starts_time(g, words, i)) and self._ends_clause(i + length):
            clause.times.append(self._t.between(i, i + length))
            return i + length
        if g.match("question", words, i) or words[i] in ("if",):
            return self._question(clause, i)
        to = i + (words[i : i + 2] == ("not", "to"))
        if words[to] == "to" and clause.role("Addressee") is not None and g.verb(words, to + 1)[0]:
            clause.frame = "Request"  # tell Anna to come, not to come
            end = self._message_end(self._requested(to + 1))
            clause.roles.append(Role("Message", i, end, to + 1))
            return self._addressed(clause, end)
        if words[i] == "back":
            return self._told(clause, i + 1)
        if words[i] == "to" and clause.role("Addressee") is None:
            return self._addressed(clause, i)
        if words[i] == "that":
            end = self._message_end(i)
            clause.roles.append(Role("Message", i, end, i))
            return self._addressed(clause, end)
        return self._told_of(clause, i)

    def _requested(self, i: int) -> int:
        """Return the index after a verb at `i` that would begin a clause elsewhere: ask Anna to BRING it."""
        return i + self._g.verb(self._words, i)[0] if self._ends_clause(i) else i

    def _inserted(self, clause: Clause, i: int) -> int:
        """Read a condition between commas at `i` (tell Anna, if she is there, to come); return its end."""
        if self._words[i : i + 1] != (",",) or not self._inserts(i + 1):
            return i
        end = self._condition(i + 1)
        self._add_condition(clause, i + 1, end)
        return end + 1

    def _ask(self, clause: Clause, i: int) -> int:
        """Read *ask her to leave* as a Request and *ask her where she is from* as Questioning."""
        words = self._words
        if self._t.is_translated and words[i : i + 1] == ("to",):  # chiedi a Anna
            i += 1
        phrase = self._np.read_recipient(i)
        if (
            phrase is not None
            and words[i : i + 1] != ("for",)
            and (self._is_person(phrase) or phrase.kind in ("pronoun", "speaker"))
        ):
            i = self._add_recipients(clause, i, phrase)
        elif (
            phrase is not None
            and phrase.key == ""
            and phrase.owner is not None
            and self._is_person(phrase.owner)
        ):
            pass
        i = self._inserted(clause, i)
        if i >= len(words) or (self._ends_clause(i) and words[i] != ","):
            return i
        if words[i] in ("to", "not"):
            clause.frame = "Request"
        is_infinitive = words[i : i + 2] == ("not", "to")
        end = self._requested(i + 1 + is_infinitive) if clause.frame == "Request" else i + 1
        while end < len(words) and not self._ends_clause(end):
            if starts_time(self._g, words, end) and words[end] in ("at", "in"):
                break
            if clause.frame == "Request" and self._delays(end):
                break
            end += 1
        head = i + 1 if words[i] == "to" and end > i + 1 else i
        if (words[i] == "for" and (thing := self._np.read(i + 1)) is not None) or (
            words[i] not in ("to",)
            and not self._g.match("question", words, i)
            and (thing := self._np.read(i)) is not None
            and thing.end <= end
        ):
            head = thing.head
        elif words[i : i + 1] == ("how",):
            head = min(i + 1, end - 1)
        clause.roles.append(Role("Message", i, end, head))
        if clause.frame == "Questioning":  # ask Anna where her keys are and bring THEM
            self._mention_all(i, end)
        return self._addressed(clause, end)

    def _answer(self, clause: Clause, i: int) -> int:
        """Read *answer the question of Anna*, *answer her question*, *answer Anna's question*."""
        words = self._words
        if words[i : i + 1] == ("to",):  # answer to the question
            i += 1
        if words[i : i + 1] in (("whatever",), ("what",), ("everything",)):  # answer whatever she asks
            end = self._message_end(i)
            clause.roles.append(Role("Trigger", i, end, i))
            return self._addressed(clause, end)
        phrase = self._np.read(i, with_places=False)
        if phrase is None:
            return self._arguments(clause, i)
        if (
            self._is_person(phrase)
            and not self._g.is_a(words[phrase.head], "asked")
            and phrase.kind != "pronoun"
        ):
            full = self._np.read(i) or phrase
            clause.roles.append(Role("Addressee", i, full.end, full.head, [full]))
            return self._addressed(clause, full.end)
        if phrase.owner is not None and phrase.owner.kind not in ("speaker", "pronoun"):
            clause.roles.append(Role("Trigger", phrase.head, phrase.head + 1, phrase.head))
            clause.roles.append(
                Role("Addressee", phrase.owner.first, phrase.owner.end, phrase.owner.head, [phrase.owner])
            )
            return self._addressed(clause, phrase.end)
        end = phrase.end if phrase.of is None else phrase.of.first - 1
        if phrase.of is not None:
            of = self._np.read(phrase.of.first) or phrase.of
            clause.roles.append(Role("Trigger", i, end, phrase.head))
            clause.roles.append(Role("Addressee", end, of.end, of.head, [of]))
            return self._addressed(clause, of.end)
        clause.roles.append(Role("Trigger", i, end, phrase.head))
        if (
            phrase.owner is not None
            and phrase.owner.kind == "pronoun"
            and phrase.owner.noun not in ("your", "its")
        ):
            clause.roles.append(Role("Addressee", i, i + 1, i, [phrase.owner]))
        if (
            words[end : end + 1] in (("from",), ("of",), ("by",))
            and not self._subordinates(end)
            and (asker := self._np.read(end + 1)) is not None
        ):
            clause.roles.append(Role("Addressee", end, asker.end, asker.head, [asker]))
            end = asker.end
        return self._addressed(clause, end)
