"""Clauses of commands: verbs with their arguments, conditions, times and negation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.reference_resolution.map_index import Nouns
from semmap.nodes.language.steps.noun_phrase import NounPhrase, NounPhraseReader, PlacePhrase, starts_time
from semmap.nodes.language.steps.tokens import Text

_SKIPPED: Final = ("then", "polite")
_PLACED: Final = (
    "Locating",
    "Placing",
    "Being_located",
    "Motion",
    "Arriving",
    "Inspecting",
    "Pouring",
    "Perception_active",
)
"""Frames of which a place after the object is a role of its own."""


@dataclass(slots=True)
class Role:
    """The filler of a role: noun phrases, or only words with a head."""

    role: str
    first: int
    end: int
    head: int
    phrases: list[NounPhrase] = field(default_factory=list)


@dataclass(slots=True)
class Clause:
    """A frame with its roles, as the words say it."""

    frame: str
    verb: str
    first: int
    roles: list[Role] = field(default_factory=list)
    negated: bool = False
    conditions: list[str] = field(default_factory=list)
    times: list[str] = field(default_factory=list)
    asks: bool = False

    def role(self, name: str) -> Role | None:
        """Return the first filler of a role."""
        return next((role for role in self.roles if role.role == name), None)


@dataclass(slots=True)
class Parsed:
    """The clauses of a text, the verbs that are unknown and the words that no clause uses."""

    clauses: list[Clause] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)
    context: list[tuple[int, NounPhrase]] = field(default_factory=list)
    """Persons that a part which is not understood mentions, each with the number of clauses before it."""


class ClauseReader:
    """Reads the clauses of one text."""

    def __init__(self, text: Text, grammar: Grammar, nouns: Nouns, is_person: Callable[[NounPhrase], bool],
                 above: Mapping[str, frozenset[str]]) -> None:  # fmt: skip
        """Read clauses of `text`. `is_person` tells whether a phrase denotes a person."""
        self._t, self._g, self._words = text, grammar, text.words
        self._is_person = is_person
        self._np = NounPhraseReader(text, grammar, nouns, self.starts_clause, above)
        self._nouns = nouns
        self.found = Parsed()

    def read(self) -> Parsed:
        """Return the clauses of the text, in order."""
        i, first_of_sentence = 0, 0
        negated = False
        conditions: list[str] = []
        times: list[str] = []
        front: tuple[str, PlacePhrase] | None = None
        while i < len(self._words):
            if self._t.ends_sentence(i):
                self._close(first_of_sentence, conditions)
                first_of_sentence, conditions, times, negated = len(self.found.clauses), [], [], False
                i += 1
            elif self._t.is_mark(i):
                i += 1
            elif (end := self._condition(i)) > i:
                conditions.append(self._t.between(i, end))
                self._mention(i + self._g.match("condition", self._words, i))
                i = end
            elif length := starts_time(self._g, self._words, i):
                times.append(self._t.between(i, i + length))
                i += length
            elif length := self._g.match("negation", self._words, i):
                negated = True
                i += length
            elif self._words[i : i + 2] == ("there", "you"):
                i += 1  # there you will find Anna
            elif wish := self._wish(i):
                i = self._wished(i, wish)
                self.found.clauses[-1].times += times
                times, negated = [], False
            elif self._asks(i) or self._found_at(i):
                i = self._special(i, conditions, times)
            elif (
                length := max(self._g.match(kind, self._words, i) for kind in _SKIPPED)
            ) and length >= self._g.verb(self._words, i)[0]:
                i += length
            elif (
                self._words[i] in ("go", "come")
                and self._g.verb(self._words, i)[0] == 1
                and self._g.verb(self._words, i + 1)[0]
            ):
                i += 1  # go get the milk
            elif (fronted := self._fronted(i)) is not None:
                front, i = fronted, fronted[1].end
            elif self._g.verb(self._words, i)[0] or self._lets_know(i):
                before = len(self.found.clauses)
                i = self._clause(i)
                for clause in self.found.clauses[before:]:
                    clause.negated = negated
                    clause.times += times
                if front is not None:
                    self._add_front(self.found.clauses[before], *front)
                times, negated, front = [], False, None
            else:
                i = self._unread(i)
        self._close(first_of_sentence, conditions)
        if front is not None:
            self.found.unused.append(self._t.between(front[1].first, front[1].end))
        if times and self.found.clauses:
            self.found.clauses[-1].times += times
        elif times:
            self.found.unused += times
        if conditions and not self.found.clauses:
            self.found.unused += conditions
        return self.found

    def _fronted(self, i: int) -> tuple[str, PlacePhrase] | None:
        """Return the kind and the phrase of a place before the verb: in the kitchen, find Anna."""
        for kind in ("from", "place"):
            if length := self._g.match(kind, self._words, i):
                phrase = self._np.read(i + length)
                if (
                    phrase is not None
                    and phrase.end > i + length
                    and (self._t.is_mark(phrase.end) or self.starts_clause(phrase.end))
                ):
                    return kind, PlacePhrase(" ".join(self._words[i : i + length]), phrase, i, phrase.end)
        return None

    def _add_front(self, clause: Clause, kind: str, place: PlacePhrase) -> None:
        """Add a place that stands before the verb to a clause: as a role, or to its object."""
        roles = self._g.frames[clause.frame].roles
        role = roles.get(kind) if kind == "from" or clause.frame == "Locating" else None
        main = clause.role(roles.get("object", "")) or clause.role("Topic")
        if role is not None and clause.role(role) is None:
            clause.roles.append(Role(role, place.first, place.end, place.other.head, [place.other]))
        elif main is not None and main.phrases and main.phrases[-1].kind != "pronoun":
            main.phrases[-1].places.append(place)
        else:
            self.found.unused.append(self._t.between(place.first, place.end))

    def _wish(self, i: int) -> int:
        """Return the number of words of a wish at `i`: I need, I would like, can I have; or 0."""
        length = self._g.match("wish", self._words, i)
        return 0 if self._words[i + length : i + length + 1] in (("to",), ("you",)) else length

    def _wished(self, i: int, length: int) -> int:
        """Read a wish for a thing: it is to be brought to the speaker."""
        speaker = i + next(k for k, word in enumerate(self._words[i:]) if word in ("i", "we"))
        clause = Clause("Bringing", self._t.between(i, i + length), i)
        phrase = NounPhrase(speaker, speaker + 1, speaker, "speaker", self._words[speaker])
        clause.roles.append(Role("Beneficiary", speaker, speaker + 1, speaker, [phrase]))
        self.found.clauses.append(clause)
        return self._arguments(clause, i + length)

    def _lets_know(self, i: int) -> bool:
        """Return whether *let me know* begins at `i`."""
        if self._words[i] != "let":
            return False
        phrase = self._np.read(i + 1)
        return phrase is not None and self._words[phrase.end : phrase.end + 1] in (("know",), ("hear",))

    def _close(self, first: int, conditions: list[str]) -> None:
        """Give the conditions of a sentence to all of its clauses."""
        clauses = self.found.clauses[first:]
        every = list(
            dict.fromkeys((*conditions, *(text for clause in clauses for text in clause.conditions)))
        )
        for clause in clauses:
            clause.conditions = list(every)
        if conditions and not clauses:
            if self.found.clauses:
                self.found.clauses[-1].conditions += conditions
            else:
                self.found.unused += conditions

    # Where clauses begin

    def starts_clause(self, i: int) -> bool:
        """Return whether a new clause begins at `i`, possibly after *and then*."""
        g, words = self._g, self._words
        j = i
        while j < len(words) and (
            length := 1 if words[j] == "," else max(g.match("then", words, j), g.match("polite", words, j))
        ):
            if words[j] == "you" or g.verb(words, j)[0] >= length:
                break
            j += length
        if self._t.is_mark(j):
            return True
        if self._wish(j):
            return True
        if (
            g.match("negation", words, j)
            or g.match("condition", words, j)
            or self._found_at(j)
            or self._asks(j)
        ):
            return True
        length, _ = g.verb(words, j)
        if self._lets_know(j) or (g.is_a(words[j], "untaught") and not self._np.is_known(j, j + 1)):
            return True
        if not length or self._is_gerund(j):
            return False
        if length > 1:
            return True
        following = words[j + 1] if j + 1 < len(words) else ""
        if self._np.is_known(j, j + 1) and not self._opens_phrase(j + 1):
            return False
        return following not in ("of", "is", "are", "'s")

    def _is_gerund(self, i: int) -> bool:
        return self._words[i].endswith("ing") and (self._words[i],) not in self._g.verbs

    def _opens_phrase(self, i: int) -> bool:
        words, g = self._words, self._g
        if i >= len(words):
            return False
        return any(
            g.match(kind, words, i) for kind in ("determiner", "pronoun", "possessive", "speaker", "all")
        ) or (self._t.tokens[i].is_capital)

    def _asks(self, i: int) -> bool:
        """Return whether a question begins at `i`: how many cups are there, where is Anna."""
        is_yes_no = self._g.is_a(self._words[i], "be") and self._words[i] in ("is", "are")
        if not self._g.match("question", self._words, i) and not is_yes_no:
            return False
        if is_yes_no and i and self._words[i - 1] not in (".", "?", "!", ";", "robot"):
            return False
        if i and self._words[i - 1] not in (
            ",",
            ".",
            "?",
            "!",
            ";",
            "and",
            "then",
            "robot",
            "please",
            "hey",
            "hello",
            "hi",
            "also",
            "so",
            "okay",
            "ok",
            "but",
        ):
            return False
        if self._wish(i):
            return False
        return self._words[i] not in ("when", "whether") or (
            i + 1 < len(self._words) and self._words[i + 1] in ("is", "was", "did")
        )

    def _found_at(self, i: int) -> bool:
        """Return whether a clause about a place begins at `i`: you find him at the bed; there is a cup."""
        words, g = self._words, self._g
        if words[i : i + 1] == ("you",) and i + 2 < len(words):
            return (
                words[i + 1] in ("can", "may", "might", "will", "should", "could", "'ll")
                and words[i + 2] in ("find", "meet", "see", "spot", "probably", "likely", "also", "surely")
            ) or (words[i + 1] in ("find",))
        if words[i : i + 1] == ("there",) and i + 2 < len(words):
            return g.is_a(words[i + 1 + g.is_a(words[i + 1], "modal")], "be")
        if self._states_place(i):
            return True
        subject = i < len(words) and (
            words[i] in ("he", "she", "they", "it")
            or (self._t.tokens[i].is_capital and not g.verb(words, i)[0] and i + 1 < len(words))
        )
        if not subject:
            return False
        j = i + 1
        while j < len(words) and (
            g.is_a(words[j], "modal") or words[j] in ("probably", "usually", "likely", "currently", "most")
        ):
            j += 1
        return (
            j < len(words)
            and g.is_a(words[j], "be")
            and g.match(
                "place",
                words,
                j
                + 1
                + (
                    words[j + 1 : j + 2]
                    in (
                        ("located",),
                        ("standing",),
                        ("sitting",),
                        ("waiting",),
                        ("lying",),
                        ("probably",),
                        ("usually",),
                    )
                ),
            )
            > 0
        )

    def _states_place(self, i: int) -> bool:
        """Return whether a statement about a person begins at `i`, as in "someone is waving"."""
        if i >= len(self._words) or not (
            self._g.match("determiner", self._words, i) or self._words[i].startswith(("some", "any", "every"))
        ):
            return False
        if i and self._words[i - 1] not in (",", ".", "!", ";", "?", "and", "then"):
            return False
        phrase = self._np.read(i)
        if phrase is None or phrase.kind != "person" or phrase.end + 1 >= len(self._words):
            return False
        behind = phrase.end + 1
        return self._g.is_a(self._words[phrase.end], "be") and bool(
            self._g.is_a(self._words[behind], "posture") or self._g.match("place", self._words, behind)
        )

    def _condition(self, i: int) -> int:
        """Return the end of a subordinate clause that begins at `i`, or `i`."""
        length = self._g.match("condition", self._words, i)
        if (
            not length
            or self._g.match("then", self._words, i) >= length
            or starts_time(self._g, self._words, i)
        ):
            return i
        j = i + length
        while j < len(self._words) and not self._t.ends_sentence(j):
            if self._words[j] == "," and (self.starts_clause(j + 1) or not self._continues(j + 1)):
                return j
            if self._words[j] == "then":
                return j
            if (
                j > i + length + 1
                and self._words[j - 1]
                not in (
                    "to",
                    "not",
                    "n't",
                    "and",
                    "or",
                    "'s",
                    "the",
                    "a",
                    "i",
                    "you",
                    "we",
                    "they",
                    "he",
                    "she",
                    "it",
                    "my",
                    "your",
                )
                and (
                    not self._g.is_a(self._words[j - 1], "modal")
                    and not self._g.is_a(self._words[j - 1], "be")
                    and not self._g.is_a(self._words[j - 1], "determiner")
                )
            ):
                verb, _ = self._g.verb(self._words, j)
                if (
                    verb
                    and not self._is_gerund(j)
                    and self._opens_phrase(j + verb)
                    and self._has_verb(i + length, j)
                ):
                    return j
                if self._words[j] in ("please", "could", "can") and self._g.match("polite", self._words, j):
                    return j
            j += 1
        return j

    def _continues(self, i: int) -> bool:
        """Return whether a list goes on at `i`, so that a comma before it ends no clause."""
        return self._words[i : i + 1] in (("or",), ("and",))

    def _has_verb(self, first: int, end: int) -> bool:
        """Return whether a subordinate clause has its verb."""
        return any(
            self._g.is_a(word, "be")
            or self._g.is_a(word, "have")
            or self._g.is_a(word, "modal")
            or (word.endswith(("s", "ed", "ing")) and not self._np.is_known(k, k + 1))
            for k, word in enumerate(self._words[first:end], first)
        )

    def _ends_clause(self, i: int) -> bool:
        """Return whether the clause ends at `i`."""
        if self._t.ends_sentence(i):
            return True
        word = self._words[i]
        if self._excludes(i):
            return False
        if word == "," or self._g.is_a(word, "and") or self._g.match("then", self._words, i):
            return self.starts_clause(i)
        return self._found_at(i) and word not in ("there", "it") and not self._t.tokens[i].is_capital

    def _excludes(self, i: int) -> bool:
        """Return whether an exception begins at `i`: but not the milk."""
        length = self._g.match("exclude", self._words, i)
        has_noun = self._opens_phrase(i + length) or (length == 2 and self._words[i + 1] == "no")
        return bool(length) and has_noun and not self._g.verb(self._words, i + length)[0]

    def _unread(self, i: int) -> int:
        """Note the words of a clause that cannot be read; return where it ends."""
        end = i + 1
        while end < len(self._words) and not self._t.is_mark(end):
            if (
                self._g.is_a(self._words[end], "and") or self._g.match("then", self._words, end)
            ) and self.starts_clause(end):
                break
            end += 1
        text = self._t.between(i, end)
        takes = self._opens_phrase(i + 1) or i + 1 == end or self._np.is_known(i + 1, i + 2)
        is_verb = (
            takes and not self._opens_phrase(i) and not self._np.is_known(i, i + 1) and not self._is_gerund(i)
        )
        if is_verb and not any(
            self._g.match(kind, self._words, i) for kind in ("to", "from", "place", "with", "for")
        ):
            self.found.unknown.append(self._words[i])
        if self._g.match("polite", self._words, i) < end - i:
            self.found.unused.append(text)
        self._mention_all(i, end)
        return end

    def _mention_all(self, i: int, end: int) -> None:
        """Note the things and persons from `i` to before `end`, to which a later pronoun may refer."""
        while i < end:
            phrase = self._np.read(i)
            if phrase is None or phrase.end <= i:
                i += 1
                continue
            if phrase.kind == "person" or (phrase.key and phrase.determiner):
                self.found.context.append((len(self.found.clauses), phrase))
            i = phrase.end

    def _mention(self, i: int) -> None:
        """Note the person at `i`, to whom a later pronoun may refer."""
        phrase = self._np.read(i)
        if phrase is not None and (
            phrase.kind == "person" or (self._is_person(phrase) and self._t.tokens[phrase.head].is_capital)
        ):
            self.found.context.append((len(self.found.clauses), phrase))

    # One clause

    def _clause(self, i: int) -> int:
        length, frame = self._g.verb(self._words, i) if not self._lets_know(i) else (1, "Telling")
        clause = Clause(frame, self._t.between(i, i + length), i)
        self.found.clauses.append(clause)
        j = i + length
        match frame:
            case "Telling":
                return self._tell(clause, j)
            case "Questioning":
                return self._ask(clause, j)
            case "Communication_response":
                return self._answer(clause, j)
            case "Counting" if (
                self._words[j : j + 2] == ("how", "many") and (counted := self._np.read(j + 2)) is not None
            ):
                counted = self._predicate(counted)
                clause.roles.append(Role("Theme", j + 2, counted.end, counted.head, [counted]))
                return self._arguments(clause, counted.end)
            case "Inspecting" | "Telling" if (
                self._g.match("question", self._words, j) and self._words[j] != "whether"
            ):
                clause.frame = "Telling"  # check how many cups there are
                return self._told(clause, j)
            case "Inspecting" if j < len(self._words) and self._words[j] in ("if", "whether", "that"):
                end = self._clause_end(j)
                clause.roles.append(Role("Desired_state", j, end, j))
                return end
        return self._arguments(clause, j)

    def _arguments(self, clause: Clause, i: int) -> int:
        """Read the arguments of a clause; return where it ends."""
        g, words = self._g, self._words
        roles = g.frames[clause.frame].roles
        objects: list[NounPhrase] = []
        while i < len(words) and not self._ends_clause(i):
            if (end := self._condition(i)) > i:
                clause.conditions.append(self._t.between(i, end))
                i = end
            elif length := starts_time(g, words, i):
                clause.times.append(self._t.between(i, i + length))
                i += length
            elif clause.frame == "Motion" and clause.role("Goal") is not None and (to := self._next_goal(i)):
                further = Clause(
                    clause.frame, clause.verb, to, conditions=clause.conditions, times=list(clause.times)
                )
                self.found.clauses.append(further)
                return self._arguments(further, to)
            elif words[i] == ",":
                i += 1
            elif (
                self._excludes(i)
                and objects
                and (other := self._np.read(i + g.match("exclude", words, i))) is not None
            ):
                objects[-1].excluded.append(other)
                i = other.end
            elif (
                g.is_a(words[i], "and")
                and (phrase := self._np.read(i + 1)) is not None
                and not self._t.is_mark(i + 1)
            ):
                i = self._coordinate(clause, i, phrase)
            elif (length := g.match("here", words, i)) and (phrase := self._np.read(i)) is not None:
                if "to" in roles or "place" in roles:
                    role = roles.get("to") or roles["place"]
                    clause.roles.append(Role(role, i, phrase.end, phrase.head, [phrase]))
                i = phrase.end
            elif length := g.match("manner", words, i):
                clause.roles.append(Role("Manner", i, i + length, i))
                i += length
            elif "direction" in roles and g.is_a(words[i], "direction"):
                clause.roles.append(Role("Direction", i, i + 1, i))
                i += 1
            elif (found := self._prepositional(clause, i)) is not None:
                i = found
            elif (particle := self._particle(clause, i)) is not None:
                i = particle
            elif (phrase := self._object(clause, i)) is not None:
                objects.append(phrase)
                i = phrase.end
                self._add_object(clause, objects, phrase)
            elif length := max(
                g.match("polite", words, i), g.match("then", words, i), g.match("particle", words, i)
            ):
                i += length
            else:
                end = i + 1
                while (
                    end < len(words)
                    and not self._ends_clause(end)
                    and not g.match("place", words, end)
                    and not g.match("to", words, end)
                ):
                    end += 1
                self.found.unused.append(self._t.between(i, end))
                i = end
        self._finish(clause)
        return i

    def _next_goal(self, i: int) -> int:
        """Return the index of another goal after *then* at `i`, or 0: to the desk, then TO THE SHELF."""
        j = i
        while j < len(self._words) and (self._words[j] == "," or self._g.match("then", self._words, j)):
            j += max(1, self._g.match("then", self._words, j))
        return j if j > i and self._g.match("to", self._words, j) else 0

    def _object(self, clause: Clause, i: int) -> NounPhrase | None:
        phrase = self._np.read(i)
        return None if phrase is None or phrase.end == i else phrase

    def _add_object(self, clause: Clause, objects: list[NounPhrase], phrase: NounPhrase) -> None:
        """Add an object: of two, the first is the receiver (bring me the cup)."""
        roles = self._g.frames[clause.frame].roles
        role = roles.get("object") or roles.get("place") or "Theme"
        if (phrase.kind == "here" and "object" in roles and clause.role(role) is not None) or (
            phrase.kind == "here" and "object" not in roles
        ):
            clause.roles.append(
                Role(
                    roles.get("to") or roles.get("place") or "Goal",
                    phrase.first,
                    phrase.end,
                    phrase.head,
                    [phrase],
                )
            )
            return
        if clause.verb.lower() == "show" and phrase.noun == "way":
            return  # show Anna the way to the kitchen
        first = clause.role(role)
        if (
            len(objects) == 2
            and first is not None
            and first.phrases[0].kind == "speaker"
            and "receiver" not in roles
        ):
            clause.roles.remove(first)  # find me a cup
        if clause.frame == "Motion" and self._is_person(phrase) and clause.verb.lower() in ("walk", "drive"):
            clause.frame, role = "Guiding", "Cotheme"  # walk Anna to the sofa
        if phrase.kind == "robot" and clause.frame not in ("Introducing",) and "object" in roles:
            return
        if (
            len(objects) == 2
            and "receiver" in roles
            and (first := clause.role(role)) is not None
            and first.phrases[-1] is objects[0]
        ):
            first.role = roles["receiver"]
            if clause.frame == "Taking":  # get me a drink
                clause.frame = "Bringing"
        if (first := clause.role(role)) is not None and len(objects) > 1:
            first.phrases.append(phrase)  # a list without "and"
            first.end = phrase.end
            return
        clause.roles.append(Role(role, phrase.first, phrase.end, phrase.head, [phrase]))

    def _particle(self, clause: Clause, i: int) -> int | None:
        """Read a particle apart from its verb: pick the cup up, turn it off."""
        if not self._g.is_a(self._words[i], "particle"):
            return None
        both = (*clause.verb.lower().split(), self._words[i])
        if (
            both in self._g.verbs
            and clause.role(self._g.frames[clause.frame].roles.get("object", "")) is not None
        ):
            frame = self._g.verbs[both]
            old, new = self._g.frames[clause.frame].roles, self._g.frames[frame].roles
            for role in clause.roles:
                if role.role == old.get("object"):
                    role.role = new.get("object", role.role)
            clause.frame, clause.verb = frame, " ".join(both)
            return i + 1
        return None

    def _coordinate(self, clause: Clause, i: int, phrase: NounPhrase) -> int:
        """Read *and* with a noun phrase: one more thing, or a clause without its verb (and a fork in it)."""
        self._finish(clause)
        last = clause.roles[-1] if clause.roles else None
        roles = self._g.frames[clause.frame].roles
        if (
            last is not None
            and last.phrases
            and last.role != roles.get("object")
            and clause.role(roles.get("object", ""))
        ):
            is_gap = (
                bool(phrase.places)
                or self._g.match("to", self._words, phrase.end)
                or self._g.match("from", self._words, phrase.end)
            )
            if is_gap or (
                clause.frame in ("Giving", "Bringing") and self._g.match("place", self._words, phrase.end)
            ):
                other = Clause(
                    clause.frame, clause.verb, i + 1, conditions=clause.conditions, times=clause.times
                )
                self.found.clauses.append(other)
                return self._arguments(other, i + 1)
        if phrase.kind == "name" and not self._t.tokens[phrase.head].is_capital:
            return self._unread(i + 1)
        if last is None or not last.phrases:
            self.found.unused.append(self._t.between(i + 1, phrase.end))
            return phrase.end
        last.phrases.append(phrase)
        last.end = phrase.end
        return phrase.end

    def _prepositional(self, clause: Clause, i: int) -> int | None:
        """Read a phrase with a preposition as a role; return its end."""
        g, words = self._g, self._words
        roles = g.frames[clause.frame].roles
        best = max(
            (g.match(kind, words, i), kind)
            for kind in ("to", "from", "place", "for", "about", "path", "with", "of")
        )
        length, kind = best
        if not length:
            return None
        phrase = self._np.read(i + length)
        if phrase is None or phrase.end == i + length:
            return None
        if kind == "for" and clause.frame == "Perception_active":  # look in the kitchen for a cup
            clause.frame = "Locating"
            for other in clause.roles:
                other.role = "Ground" if other.role in ("Location", "Phenomenon") else other.role
            clause.roles.append(Role("Sought_entity", i, phrase.end, phrase.head, [phrase]))
            return phrase.end
        if kind == "for" and phrase.kind == "speaker" and "for" not in roles:
            return phrase.end
        role = self._role(clause, kind, roles, phrase)
        object_role = clause.role(roles.get("object", "")) if "object" in roles else None
        if phrase.excluded and object_role is not None and object_role.phrases:
            object_role.phrases[-1].excluded += phrase.excluded  # any drink from the table but not the milk
            phrase.excluded = []
        if role is None:
            if kind == "place" and object_role is not None and object_role.phrases:
                object_role.phrases[-1].places.append(
                    PlacePhrase(" ".join(words[i : i + length]), phrase, i, phrase.end)
                )
                object_role.end = max(object_role.end, phrase.end)
                return phrase.end
            self.found.unused.append(self._t.between(i, phrase.end))
            return phrase.end
        if (
            kind == "for"
            and clause.frame == "Locating"
            and (first := clause.role("Sought_entity")) is not None
        ):
            first.role = "Ground"  # search the kitchen for a cup
        both = [phrase]
        end = phrase.end
        if (
            words[i] == "between"
            and words[end : end + 1] == ("and",)
            and (second := self._np.read(end + 1)) is not None
        ):
            both, end = [phrase, second], second.end
        clause.roles.append(Role(role, i, end, phrase.head, both))
        return end

    def _role(self, clause: Clause, kind: str, roles: Mapping[str, str], phrase: NounPhrase) -> str | None:
        is_person = self._is_person(phrase) or phrase.kind == "speaker"
        if kind == "to" and "receiver" in roles and (is_person or "to" not in roles):
            return roles["receiver"]
        if kind == "for" and not is_person and clause.frame != "Locating":
            return None
        if kind == "path":
            return "Path" if clause.frame in ("Motion", "Cotheme", "Guiding") else None
        return roles.get(kind)

    def _finish(self, clause: Clause) -> None:
        """Give places after the object their role, and the frame its name for a person."""
        roles = self._g.frames[clause.frame].roles
        main = clause.role(roles.get("object", "")) if "object" in roles else None
        if main is not None and main.phrases and clause.frame in _PLACED and "place" in roles:
            phrase = main.phrases[-1]
            is_last = phrase.places and phrase.end == phrase.places[-1].end and not phrase.places[-1].negated
            if is_last and clause.role(roles["place"]) is None:
                place = phrase.places.pop()
                phrase.end = main.end = place.first
                both = [place.other] if place.other.second is None else [place.other, place.other.second]
                clause.roles.append(Role(roles["place"], place.first, place.end, place.other.head, both))
        given = clause.role("Theme")
        if (
            clause.frame == "Giving"
            and given is not None
            and given.phrases
            and self._g.is_a(self._words[given.head], "property")
        ):
            self._tells(clause, given)
        if clause.frame == "Taking" and clause.role("Goal") is not None:
            clause.frame = "Bringing"
        if clause.frame == "Taking" and clause.role("Beneficiary") is not None:
            clause.frame = "Bringing"
        theme = clause.role("Theme")
        if (
            clause.frame in self._g.persons
            and theme is not None
            and theme.phrases
            and self._is_person(theme.phrases[0])
        ):
            clause.frame, theme.role = self._g.persons[clause.frame], "Cotheme"
            for role in clause.roles:
                role.role = "Goal" if role.role == "Beneficiary" else role.role
        if (
            clause.frame == "Closure"
            and (opened := clause.role("Containing_object")) is not None
            and opened.phrases
        ) and (
            any(name in ("Door", "Window") for name in self._nouns.classes.get(opened.phrases[0].key, ()))
            or opened.phrases[0].noun.endswith("door")
        ):
            opened.role = "Container_portal"

    def _tells(self, clause: Clause, given: Role) -> None:
        """Make Telling of *give me the name of the person*."""
        of = given.phrases[0].of
        clause.frame, given.role = "Telling", "Message"
        for role in clause.roles:
            role.role = "Addressee" if role.role == "Recipient" else role.role
        if of is not None:
            end, given.end, given.phrases = given.end, given.head + 1, []
            clause.roles.append(Role("Topic", given.head + 1, end, of.head, [of]))

    def _clause_end(self, i: int) -> int:
        while i < len(self._words) and not self._ends_clause(i):
            i += 1
        return i

    # Telling, asking and answering

    def _tell(self, clause: Clause, i: int) -> int:
        """Read *tell me ...*: to whom, what, and of what."""
        words = self._words
        if clause.verb.lower() in ("inform", "notify") or not self._g.match("question", words, i):
            phrase = self._np.read(i)
            following = phrase is not None and phrase.end
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
                and self._words[i : i + 1] not in (("what",), ("which",))
            ):
                clause.roles.append(Role("Addressee", i, phrase.end, phrase.head, [phrase]))
                i = int(following or i)
            elif words[i : i + 1] == ("to",) and (to := self._np.read(i + 1)) is not None:
                clause.roles.append(Role("Addressee", i, to.end, to.head, [to]))
                i = to.end
        if clause.verb.lower() == "let" and words[i : i + 1] in (("know",), ("hear",)):
            i += 1
        while words[i : i + 1] == ("about",) or (words[i : i + 1] == ("know",)):
            i += 1
        return self._told(clause, i)

    def _told(self, clause: Clause, i: int) -> int:
        """Read what is to be told: a question, a property of a thing, a thing, or words."""
        g, words = self._g, self._words
        if i >= len(words) or self._ends_clause(i):
            return i
        if (end := self._condition(i)) > i and words[i] not in ("if", "whether", "when"):
            clause.conditions.append(self._t.between(i, end))
            return self._told(clause, end)
        if words[i] == "," and not self.starts_clause(i):
            return self._told(clause, i + 1)
        if (length := starts_time(g, words, i)) and self._ends_clause(i + length):
            clause.times.append(self._t.between(i, i + length))
            return i + length
        if g.match("question", words, i) or words[i] in ("if",):
            return self._question(clause, i)
        if words[i] == "to" and clause.role("Addressee") is not None and g.verb(words, i + 1)[0]:
            clause.frame = "Request"  # tell Anna to come
            end = self._message_end(i + 1)
            clause.roles.append(Role("Message", i, end, i + 1))
            return self._addressed(clause, end)
        if words[i] == "back":
            return self._told(clause, i + 1)
        if words[i] == "to" and clause.role("Addressee") is None:
            return self._addressed(clause, i)
        if words[i] == "that":
            end = self._message_end(i)
            clause.roles.append(Role("Message", i, end, i))
            return self._addressed(clause, end)
        prop = i + g.match("determiner", words, i)
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
            if j > i and words[j] in ("if", "unless", "when", "until", "before", "after", "please"):
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
                clause.conditions.append(self._t.between(i, end))
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
                    (phrase := self._np.read(i + 1)) is not None and clause.roles and clause.roles[-1].phrases
                ):
                    clause.roles[-1].phrases.append(phrase)
                    clause.roles[-1].end = end = phrase.end
                else:
                    self.found.unused.append(self._t.between(i, end))
            i = end
        return i

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
                return self._told(clause, j + 1)  # what is the name of the person
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

    def _ask(self, clause: Clause, i: int) -> int:
        """Read *ask her to leave* as a Request and *ask her where she is from* as Questioning."""
        words = self._words
        phrase = self._np.read(i)
        if (
            phrase is not None
            and words[i : i + 1] != ("for",)
            and (self._is_person(phrase) or phrase.kind in ("pronoun", "speaker"))
        ):
            clause.roles.append(Role("Addressee", i, phrase.end, phrase.head, [phrase]))
            i = phrase.end
        elif (
            phrase is not None
            and phrase.key == ""
            and phrase.owner is not None
            and self._is_person(phrase.owner)
        ):
            pass
        if i >= len(words) or (self._ends_clause(i) and words[i] != ","):
            return i
        if words[i] in ("to", "not"):
            clause.frame = "Request"
        end = i + 1
        while end < len(words) and not self._ends_clause(end):
            if starts_time(self._g, words, end) and words[end] in ("at", "in"):
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
        return self._addressed(clause, end)

    def _answer(self, clause: Clause, i: int) -> int:
        """Read *answer the question of Anna*, *answer her question*, *answer Anna's question*."""
        words = self._words
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
            and (asker := self._np.read(end + 1)) is not None
        ):
            clause.roles.append(Role("Addressee", end, asker.end, asker.head, [asker]))
            end = asker.end
        return self._addressed(clause, end)

    # Other clauses

    def _special(self, i: int, conditions: list[str], times: list[str]) -> int:
        """Read a question, or where something can be found."""
        before = len(self.found.clauses)
        if self._asks(i):
            clause = Clause("Telling", self._words[i], i, asks=True)
            self.found.clauses.append(clause)
            end = (
                self._question(clause, i)
                if self._g.match("question", self._words, i)
                else self._yes_no(clause, i)
            )
        else:
            end = self._being_located(i)
        for clause in self.found.clauses[before:]:
            clause.times += times
        if self.found.clauses[before:] and clause.asks and clause.role("Topic") is None:  # how are you
            self.found.clauses.pop()
            self.found.unused.append(self._t.between(i, end))
        return max(end, i + 1)

    def _yes_no(self, clause: Clause, i: int) -> int:
        """Read *is the milk on the desk*."""
        j = i + 1 + (self._words[i + 1 : i + 2] == ("there",))
        phrase = self._np.read(j)
        clause.roles.append(Role("Message", i, j, i))
        if phrase is None:
            return self._unread(j)
        self._np.continue_phrase(phrase, after_be=True)
        clause.roles.append(Role("Topic", phrase.first, phrase.end, phrase.head, [phrase]))
        return self._addressed(clause, phrase.end)

    def _being_located(self, i: int) -> int:
        words, g = self._words, self._g
        clause = Clause("Being_located", "", i)
        j = i
        if words[i] == "you":
            j += 1
            while j < len(words) and (
                g.is_a(words[j], "modal")
                or words[j] in ("probably", "likely", "also", "surely", "'ll", "most")
            ):
                j += 1
            clause.verb, j = words[j], j + 1
        elif words[i] == "there":
            j = i + 2 + g.is_a(words[i + 1], "modal")
            clause.verb = self._t.between(i, j)
        phrase = self._np.read(j)
        if phrase is None:
            return self._unread(i)
        j = phrase.end
        role = Role("Theme", phrase.first, phrase.end, phrase.head, [phrase])
        clause.roles.append(role)
        if (
            phrase.kind == "person"
            and j + 1 < len(words)
            and g.is_a(words[j], "be")
            and g.is_a(words[j + 1], "posture")
        ):
            clause.verb = clause.verb or words[j]
            phrase = self._predicate(phrase)
            role.end = j = phrase.end
        while j < len(words) and (
            g.is_a(words[j], "be")
            or g.is_a(words[j], "modal")
            or words[j]
            in (
                "probably",
                "usually",
                "likely",
                "currently",
                "most",
                "located",
                "standing",
                "sitting",
                "waiting",
                "lying",
            )
        ):
            clause.verb = clause.verb or words[j]
            j += 1
        self.found.clauses.append(clause)
        return self._arguments(clause, j)
