"""Direct and embedded questions: what is asked (Message) and of what (Topic)."""

from __future__ import annotations

from typing import Final

from semmap.nodes.language.steps.clause import Clause, Role
from semmap.nodes.language.steps.phrase import NounPhrase, PlacePhrase
from semmap.nodes.language.steps.times import starts_time
from semmap.nodes.language.steps.yes_no_questions import YesNoReader

_REASONS: Final = ("because", "since", "so", "instead", "without", "although", "though", "wherever")
"""First words of subordinate clauses that belong to a message."""


class QuestionReader(YesNoReader):
    """Reads questions, their topics and the recipient of the answer."""

    def _question(self, clause: Clause, i: int) -> int:
        """Read an embedded question as Message and Topic, or as a Message in words."""
        g, words = self._g, self._words
        length = g.match("question", words, i) or 1
        j = i + length
        text = " ".join(words[i:j])
        if text in ("how many", "how much"):
            topic = self._np.read(j)
            if topic is not None:
                clause.roles.append(Role("Message", i, j, j - 1))
                topic = self._predicate(topic)
                clause.roles.append(Role("Topic", j, topic.end, topic.head, [topic]))
                return self._addressed(clause, topic.end)
        if text == "which" and words[j : j + 1] == ("of",) and (topic := self._np.read(j + 1)) is not None:
            clause.roles.append(Role("Message", i, j, i))
            topic = self._predicate(topic)
            if topic.superlative:  # which of the two cups is the biggest
                topic.is_plural, topic.all_of, topic.quantity = False, False, None
            clause.roles.append(Role("Topic", j, topic.end, topic.head, [topic]))
            return self._addressed(clause, topic.end)
        if (
            text in ("which", "what")
            and not self._t.is_mark(j)
            and not g.is_a(words[j], "be")
            and not g.is_a(words[j], "property")
        ):  # which drinks are on the desk
            topic = self._np.read(j)
            if topic is not None and self._is_topic(topic):
                clause.roles.append(Role("Message", i, j, i))
                topic = self._predicate(topic)
                clause.roles.append(Role("Topic", j, topic.end, topic.head, [topic]))
                return self._addressed(clause, topic.end)
        if text == "who" and j < len(words) and g.is_a(words[j], "be"):
            topic = self._predicate(NounPhrase(i, j, i, "person", "who", determiner="the", is_plural=True))
            if topic.places or topic.attributes:
                clause.roles.append(Role("Message", i, j, i))
                clause.roles.append(Role("Topic", i, topic.end, i, [topic]))
                return self._addressed(clause, topic.end)
        if text in ("what", "which", "who", "where") and j < len(words) and g.is_a(words[j], "be"):
            topic = self._np.read(j + 1)
            if (
                topic is not None
                and topic.key
                and topic.kind == "thing"
                and g.is_a(words[topic.head], "property")
                and topic.of is not None
            ):
                topic = None if not self._is_topic(topic.of) else topic
            prop = j + 1 + g.match("determiner", words, j + 1)
            if (
                prop < len(words)
                and g.is_a(words[prop], "property")
                and words[prop + 1 : prop + 2] == ("of",)
            ):
                return self._told_of(clause, j + 1)  # what is the name of the person
            if topic is not None and words[topic.end : topic.end + 1] in (("called",), ("named",)):
                clause.roles.append(Role("Message", topic.end, topic.end + 1, topic.end))
                clause.roles.append(Role("Topic", j + 1, topic.end, topic.head, [topic]))
                return self._addressed(clause, topic.end + 1)
            is_good = topic is not None and (
                self._is_topic(topic) and (text != "what" or topic.superlative or topic.places or topic.key)
            )
            if (
                topic is not None
                and is_good
                and (self._ends_clause(topic.end) or words[topic.end] in ("to", "called"))
            ):
                clause.roles.append(Role("Message", i, j + 1, i))
                clause.roles.append(Role("Topic", j + 1, topic.end, topic.head, [topic]))
                return self._addressed(clause, topic.end)
            if (place := self._np.read_place(j + 1)) and text in ("what", "which"):  # what is on the table
                phrase = NounPhrase(i, place.end, i, "thing", "object", places=[place], is_plural=True)
                clause.roles.append(Role("Message", i, j + 1, i))
                clause.roles.append(Role("Topic", i, place.end, i, [phrase]))
                return self._addressed(clause, place.end)
        if text == "where" and not self._t.is_mark(j):  # where the cup is
            topic = self._np.read(j)
            if (
                topic is not None
                and self._is_topic(topic)
                and topic.end < len(words)
                and g.is_a(words[topic.end], "be")
            ):
                clause.roles.append(Role("Message", i, j, i))
                clause.roles.append(Role("Topic", j, topic.end, topic.head, [topic]))
                return self._addressed(clause, topic.end + 1)
        if text in ("how", "what") and words[j : j + 1] in (("does",), ("do",)):  # what does Anna look like
            topic = self._np.read(j + 1)
            if topic is not None and self._is_topic(topic) and not self._ends_clause(topic.end):
                end = self._message_end(topic.end)
                clause.roles.append(Role("Message", topic.end, end, topic.end))
                clause.roles.append(Role("Topic", j + 1, topic.end, topic.head, [topic]))
                return self._addressed(clause, end)
        if text in ("how", "what") and not self._t.is_mark(j):  # how the person at the sink looks
            topic = self._np.read(j)
            if (
                topic is not None
                and self._is_topic(topic)
                and not self._t.is_mark(topic.end)
                and topic.kind != "pronoun"
            ):
                last = topic.end
                is_verb = words[last] in (
                    "looks",
                    "look",
                    "feels",
                    "is",
                    "are",
                    "does",
                    "wears",
                    "weighs",
                ) or words[last].endswith("s")
                if is_verb:
                    end = (
                        last
                        + 1
                        + (
                            words[last + 1 : last + 2]
                            in (("like",), ("wearing",), ("doing",), ("called",), ("named",))
                        )
                    )
                    clause.roles.append(Role("Message", last, end, last))
                    clause.roles.append(Role("Topic", j, topic.end, topic.head, [topic]))
                    return self._addressed(clause, end)
            kind = j
            if text == "what" and g.is_a(words[kind], "property"):
                topic = self._np.read(kind + 1)  # what color the cup is
                if topic is not None and topic.end < len(words) and g.is_a(words[topic.end], "be"):
                    clause.roles.append(Role("Message", i, kind + 1, kind))
                    clause.roles.append(Role("Topic", kind + 1, topic.end, topic.head, [topic]))
                    return self._addressed(clause, topic.end + 1)
            if (
                text == "what"
                and g.is_a(words[kind], "property")
                and kind + 1 < len(words)
                and g.is_a(words[kind + 1], "be")
            ):
                topic = self._np.read(kind + 2)  # what color is the cup
                if topic is not None and self._is_topic(topic):
                    clause.roles.append(Role("Message", i, kind + 1, kind))
                    clause.roles.append(Role("Topic", kind + 2, topic.end, topic.head, [topic]))
                    return self._addressed(clause, topic.end)
        end = self._message_end(i)
        if text in ("if", "whether"):
            self._mention_all(j, end)
        clause.roles.append(Role("Message", i, max(end, i + 1), min(i + length - 1, end) if end > i else i))
        return self._addressed(clause, max(end, i + 1))

    def _predicate(self, phrase: NounPhrase) -> NounPhrase:
        """Add the predicate of the counted things: people in the office ARE pointing to the right."""
        g, words = self._g, self._words
        while phrase.end < len(words):
            i = phrase.end
            j = i
            if words[j : j + 1] == ("there",):
                j += 1
            if j < len(words) and (
                g.is_a(words[j], "be") or g.is_a(words[j], "have") or words[j] in ("do", "does", "can")
            ):
                j += 1
                while j < len(words) and g.is_a(words[j], "after_auxiliary"):
                    j += 1
            if j == i:
                return phrase
            phrase.end = j
            before = phrase.end
            self._np.continue_phrase(phrase, after_be=g.is_a(words[j - 1], "be") or words[j - 1] == "there")
            if phrase.end == before:
                return phrase
        return phrase

    def _is_topic(self, phrase: NounPhrase) -> bool:
        """Return whether a phrase denotes a thing or person, and not a subject of conversation."""
        if phrase.kind in ("speaker", "robot", "here", "pronoun"):
            return phrase.kind == "pronoun" and phrase.noun not in ("that", "this")
        if phrase.kind == "name":
            return self._t.tokens[phrase.head].is_capital
        is_any = self._g.is_a(self._nouns.describing.base(self._words[phrase.head]), "anything")
        if is_any and phrase.noun in ("something", "anything", "everything"):
            return bool(phrase.places)
        return (
            self._is_person(phrase)
            or bool(phrase.key)
            or (is_any and bool(phrase.places or phrase.superlative))
        )

    def _delays(self, i: int) -> bool:
        """Return whether a condition begins at `i` that is not a part of a message, as a reason is."""
        is_reason = self._words[i] in _REASONS or self._words[i : i + 2] == ("in", "order")
        return self._subordinates(i) > 0 and not is_reason

    def _message_end(self, i: int) -> int:
        """Return the end of a message in words: before its addressee, or the end of the clause."""
        words = self._words
        j = i
        while j < len(words) and not self._ends_clause(j):
            if (
                j > i
                and words[j] in ("to", "for")
                and (phrase := self._np.read(j + 1)) is not None
                and (phrase.kind == "speaker" or self._is_person(phrase) or phrase.kind == "pronoun")
            ):
                break
            if j > i and starts_time(self._g, words, j) and words[j] in ("at", "in", "every"):
                break
            if j > i and (words[j] == "please" or self._delays(j)):
                break
            j += 1
        return j

    def _addressed(self, clause: Clause, i: int) -> int:
        """Read the recipient of a message, after the message; then the rest of the clause."""
        words = self._words
        if i < len(words) and words[i] in ("to", "for") and not self._ends_clause(i):
            phrase = self._np.read(i + 1)
            if phrase is not None and clause.role("Addressee") is None:
                clause.roles.append(Role("Addressee", i, phrase.end, phrase.head, [phrase]))
                i = phrase.end
        while i < len(words) and not self._ends_clause(i):
            if (end := self._condition(i)) > i:
                self._add_condition(clause, i, end)
            elif length := starts_time(self._g, words, i):
                clause.times.append(self._t.between(i, end := i + length))
            elif words[i] == "," or self._g.match("polite", words, i):
                end = i + max(1, self._g.match("polite", words, i))
            elif (
                self._g.match("place", words, i)
                and clause.role("Topic") is not None
                and (phrase := self._np.read(i + self._g.match("place", words, i))) is not None
            ):
                topic = clause.role("Topic")
                if topic is not None and topic.phrases:
                    preposition = " ".join(words[i : i + self._g.match("place", words, i)])
                    topic.phrases[-1].places.append(PlacePhrase(preposition, phrase, i, phrase.end))
                    topic.end = phrase.end
                end = phrase.end
            else:
                end = self._clause_end(i)
                if not self._g.is_a(words[i], "and"):
                    self.found.unused.append(self._t.between(i, end))
                elif (
                    (phrase := self._other_topic(clause, i + 1)) is not None
                    and clause.roles
                    and clause.roles[-1].phrases
                ):
                    if clause.roles[-1].phrases[-1].asked:  # is the fridge open and the oven off
                        self._read_state(phrase)
                    clause.roles[-1].phrases.append(phrase)
                    clause.roles[-1].end = end = phrase.end
                else:
                    self.found.unused.append(self._t.between(i, end))
            i = end
        return i

    def _told_of(self, clause: Clause, i: int) -> int:
        """Read a property of a thing, a thing, or a message in words."""
        g, words = self._g, self._words
        prop = i + g.match("determiner", words, i)
        if words[prop + 1 : prop + 2] != ("of",) and words[prop + 2 : prop + 3] == ("of",):
            prop += 1  # the shirt colour of the person
        if (
            prop < len(words)
            and g.is_a(words[prop], "property")
            and (
                words[prop + 1 : prop + 2] == ("of",)
                and (topic := self._np.read(prop + 2)) is not None
                and self._is_topic(topic)
            )
        ):
            clause.roles.append(Role("Message", i, prop + 1, prop))
            clause.roles.append(Role("Topic", prop + 1, topic.end, topic.head, [topic]))
            return self._addressed(clause, topic.end)
        phrase = self._np.read(i)
        if (
            phrase is not None
            and phrase.owner is not None
            and phrase.owner.kind not in ("speaker", "pronoun")
            and g.is_a(words[phrase.head], "property")
            and self._is_topic(phrase.owner)
        ):
            clause.roles.append(
                Role("Message", phrase.head, phrase.head + 1, phrase.head)
            )  # the person's name
            clause.roles.append(
                Role("Topic", phrase.first, phrase.owner.end, phrase.owner.head, [phrase.owner])
            )
            return self._addressed(clause, phrase.end)
        if phrase is not None and self._is_topic(phrase) and phrase.owner is None:
            clause.roles.append(Role("Topic", i, phrase.end, phrase.head, [phrase]))
            return self._addressed(clause, phrase.end)
        end = self._message_end(i)
        if end == i:
            return self._addressed(clause, i)
        head = self._np.read(i)
        clause.roles.append(Role("Message", i, end, head.head if head is not None and head.end <= end else i))
        return self._addressed(clause, end)
