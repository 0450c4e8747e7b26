"""Sentences of commands: clauses in order, with their conditions, times and negation."""

from __future__ import annotations

from typing import Final

from semmap.nodes.language.steps import quantities
from semmap.nodes.language.steps.clause import Clause, Parsed, Role
from semmap.nodes.language.steps.messages import MessageReader
from semmap.nodes.language.steps.phrase import NounPhrase, PlacePhrase
from semmap.nodes.language.steps.times import starts_time

_SKIPPED: Final = ("then", "polite")
_AFTER_A_NOUN: Final = ("but", "and", "not", "rather")
"""The first words of exceptions that do not stand before a verb."""


class ClauseReader(MessageReader):
    """Reads the clauses of one text."""

    def read(self) -> Parsed:
        """Return the clauses of the text, in order."""
        i, first_of_sentence = 0, 0
        negated = False
        conditions: list[str] = []
        times: list[str] = []  # of the clauses after it, up to the next time
        has_time = False
        front: tuple[str, PlacePhrase] | None = None
        excluded: list[NounPhrase] = []  # before the verb
        manner: Role | None = None
        while i < len(self._words):
            if self._t.ends_sentence(i):
                self._close(first_of_sentence, conditions)
                self._keep_times(first_of_sentence, [] if has_time else times)
                self.found.unused += (self._t.between(other.first, other.end) for other in excluded)
                excluded = []
                self._unused = len(self.found.unused)
                first_of_sentence, conditions, times, negated = len(self.found.clauses), [], [], False
                i += 1
            elif self.found.clauses and (repair := self._corrects(i)) > i:
                i = self._correct(self.found.clauses[-1], i, repair)
                first_of_sentence = min(first_of_sentence, len(self.found.clauses))
            elif self._t.is_mark(i):
                i += 1
            elif (end := self._condition(i, is_fronted=self._is_fronted(i, first_of_sentence))) > i:
                if first_of_sentence < len(self.found.clauses) and self._holds_from(i, end, bool(conditions)):
                    self._close(first_of_sentence, conditions)
                    if self._words[i - 1] == ",":  # if it is cold take it, if it is hot leave it
                        conditions = []
                    first_of_sentence = len(self.found.clauses)
                if self._g.match("contrary", self._words, i) and self._anaphoric(i):
                    conditions = self._contrary(self._t.between(i, end), conditions)
                else:
                    conditions.append(self._subordinate(i, end))
                self._mention_all(i + self._subordinates(i), end)
                i = end
            elif length := starts_time(self._g, self._words, i):
                times, has_time = [*([] if has_time else times), self._t.between(i, i + length)], False
                i += length
            elif (length := self._g.match("negation", self._words, i)) and (
                length >= self._g.match("polite", self._words, i)  # do n't forget to
            ):
                negated = True
                i += length
            elif self._words[i : i + 2] == ("there", "you"):
                i += 1  # there you will find Anna
            elif self._is_infinitive(i):
                i += 1
            elif self._g.is_a(self._words[i], "attention") and self._words[i + 1 : i + 2] == (",",):
                i += 2
            elif (topic := self._dislocated(i)) is not None:
                self.found.context.append((len(self.found.clauses), topic))
                i = topic.end + 1
            elif wish := self._wish(i):
                self._is_negated = negated
                before = len(self.found.clauses)
                i = self._wished(i, wish)
                for clause in self.found.clauses[before:]:  # none if it was taken back
                    clause.negated = negated
                    clause.times += times
                has_time, negated = True, False
            elif self._asks(i) or self._found_at(i) or self._declares(i):
                before = len(self.found.clauses)
                i = self._special(i, conditions, times)
                if front is not None and self.found.clauses[before:]:
                    self._add_front(self.found.clauses[before], *front)  # on the desk there is a cup
                    front = None
                has_time = has_time or len(self.found.clauses) > before
            elif (
                length := max(self._g.match(kind, self._words, i) for kind in _SKIPPED)
            ) and length >= self._g.verb(self._words, i)[0]:
                i += length
            elif (
                self._words[i] in ("go", "come")
                and self._g.verb(self._words, i)[0] == 1
                and self._g.verb(self._words, i + 1)[0]
            ):
                self.found.structural.append(i)
                i += 1  # go get the milk
            elif self._words[i] == "only" and self._g.verb(self._words, i + 1)[0]:
                self.found.structural.append(i)
                i += 1  # only go there if it is open
            elif length := self._fronted_manner(i):
                manner, i = Role("Manner", i, i + length, i), i + length
            elif (fronted := self._fronted(i)) is not None:
                front, i = fronted, fronted[1].end
            elif others := self._fronted_exception(i):
                excluded, i = [*excluded, *others], others[-1].end
            elif phase := self._phase(i):
                i += phase
            elif (self._g.verb(self._words, i)[0] or self._lets_know(i) > 0) and not (
                self._belongs_to_question(i) and not conditions
            ):
                before = len(self.found.clauses)
                self._is_negated = negated
                i = self._clause(i)
                made = self.found.clauses[before:]  # none if it was taken back
                for clause in made:
                    clause.negated = negated and not clause.contrasts
                    clause.times += times
                if made and manner is not None:
                    made[0].roles.append(manner)
                    manner = None
                if made and front is not None:
                    self._add_front(made[0], *front)
                    front = None
                if made and self._except(made[0], excluded):
                    excluded = []
                has_time, negated = True, False
            else:
                negated = negated and self._t.is_mark(i - 1)  # not the red one, take the blue one
                start, i = i, self._unread(i)
                if waits := self._waits(start, i):
                    self._close(first_of_sentence, conditions)
                    first_of_sentence, conditions = len(self.found.clauses), conditions + waits
        self._close(first_of_sentence, conditions)
        if front is not None:
            self.found.unused.append(self._t.between(front[1].first, front[1].end))
        self.found.unused += (self._t.between(other.first, other.end) for other in excluded)
        self._keep_times(first_of_sentence, [] if has_time else times)
        if conditions and not self.found.clauses:
            self.found.unused += conditions
        return self.found

    def _belongs_to_question(self, i: int) -> bool:
        """Return whether a verb at `i` is in a question with *is*, and not in a request after it.

        Nothing is done because of such a question: *is it off and rather clean?*, but *can you clean it?*
        """
        words = self._words
        first = max((j + 1 for j in range(i) if self._t.ends_sentence(j)), default=0)
        end = next(j for j in range(i, len(words) + 1) if self._t.ends_sentence(j))
        clauses = self.found.clauses
        is_asked = bool(clauses) and clauses[-1].asks and words[end : end + 1] == ("?",)
        begins = words[first] in ("is", "are") or self._declares(first) > 0
        return is_asked and begins and words[i - 1] not in ("you", "please")

    def _keep_times(self, first: int, times: list[str]) -> None:
        """Give times at the end of a sentence to its last clause."""
        if self.found.clauses[first:]:
            self.found.clauses[-1].times += times
        else:
            self.found.unused += times

    def _holds_from(self, i: int, end: int, is_further: bool) -> bool:
        """Return whether a condition from `i` to before `end` is only one of the clauses after it.

        It is one of what was said before (otherwise), or stands before its clause and after *and*, or it
        `is_further`: a clause with a condition is before it.
        """
        if self._anaphoric(i):
            return True
        is_next = self._follows_and(i) or is_further or bool(self.found.clauses[-1].conditions)
        j = end
        while self._words[j : j + 1] == (",",) or self._g.match("then", self._words, j):
            if self._words[j] == "and" and not self._follows_and(i):
                return False
            j += self._g.match("then", self._words, j) or 1
        return is_next and not self._t.is_mark(j) and self._g.verb(self._words, j)[0] > 0

    def _follows_and(self, i: int) -> bool:
        """Return whether *and*, *but* or *then* is before `i`."""
        before = i - 1 - (self._words[i - 1] == ",")
        is_but = self._words[before] == "but" and self._words[i] != "only"
        return is_but or self._g.is_a(self._words[before], "and") or self._words[before] == "then"

    def _is_fronted(self, i: int, first: int) -> bool:
        """Return whether a condition at `i` stands before its clause; clause `first` begins the sentence."""
        is_next = first == len(self.found.clauses) or self._follows_and(i)
        return is_next and self._words[i] != "wait"

    def _contrary(self, text: str, conditions: list[str]) -> list[str]:
        """Return the conditions of what follows *otherwise*: those of the clause before do not hold."""
        before = conditions
        if self.found.clauses and (not conditions or self.found.clauses[-1].conditions):
            before = self.found.clauses[-1].conditions
        denied = [one for one in before if one in self._denied]
        others = [one for one in before if one not in self._denied]
        added = f"{text}: not ({'; '.join(others)})" if others else text
        self._denied.add(added)
        return [*denied, added]

    def _waits(self, i: int, end: int) -> list[str]:
        """Return the conditions among words from `i` to before `end` that are not understood."""
        for j in range(i, end):
            if self._subordinates(j):
                text = self._subordinate(j, end)
                return [f"not ({text})" if text in self._ending else text]
        return []

    def _dislocated(self, i: int) -> NounPhrase | None:
        """Return the object before its clause, which has a pronoun for it: the towel, bring IT to Anna."""
        is_verb = self._g.verb(self._words, i)[0] > 0 and not self._np.is_known(i, i + 1)
        if (i and not self._t.is_mark(i - 1)) or is_verb:  # meet Anna, ask her to leave
            return None
        phrase = self._np.read(i)
        if phrase is None or not phrase.key or self._words[phrase.end : phrase.end + 1] != (",",):
            return None
        end = self._clause_end(phrase.end + 2)
        has_pronoun = any(
            self._g.match("pronoun", self._words, j) == 1 and self._words[j] in ("it", "them", "him", "her")
            for j in range(phrase.end + 1, end)
        )
        return phrase if has_pronoun and self._g.verb(self._words, phrase.end + 1)[0] else None

    def _fronted_manner(self, i: int) -> int:
        """Return the number of words of an expression of manner before a verb at `i`: CAREFULLY take it."""
        is_adverb = self._words[i].endswith("ly") and not self._np.is_known(i, i + 1)
        length = self._g.match("manner", self._words, i) or int(is_adverb)
        return length if length and self._g.verb(self._words, i + length)[0] else 0

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

    def _fronted_exception(self, i: int) -> list[NounPhrase]:
        """Return the phrases of an exception before the verb: EXCEPT FOR THE CUP, take all of them."""
        length = self._np.exclusion(i)
        if not length or self._words[i] in _AFTER_A_NOUN:
            return []
        found = self._np.read_excluded(i + length)
        is_apart = found and (self._t.is_mark(found[-1].end) or self.starts_clause(found[-1].end))
        return found if is_apart else []

    def _except(self, clause: Clause, others: list[NounPhrase]) -> bool:
        """Add an exception before the verb to the things of a clause; return whether there are several."""
        main = clause.role(self._g.frames[clause.frame].roles.get("object", ""))
        phrase = main.phrases[-1] if main is not None and main.phrases else None
        if phrase is None or not (phrase.all_of or phrase.is_plural):
            return False
        phrase.exclude(others)
        return True

    def _add_front(self, clause: Clause, kind: str, place: PlacePhrase) -> None:
        """Add a place that stands before the verb to a clause: as a role, or to its object."""
        roles = self._g.frames[clause.frame].roles
        role = roles.get(kind) if kind == "from" or clause.frame in ("Locating", "Being_located") else None
        main = clause.role(roles.get("object", "")) or clause.role("Topic")
        if role is not None and clause.role(role) is None:
            clause.roles.append(Role(role, place.first, place.end, place.other.head, [place.other]))
        elif main is not None and main.phrases and main.phrases[-1].kind != "pronoun":
            main.phrases[-1].places.append(place)
        else:
            self.found.unused.append(self._t.between(place.first, place.end))

    def _wished(self, i: int, length: int) -> int:
        """Read a wish for a thing: it is to be brought to the speaker."""
        speaker = i + next(k for k, word in enumerate(self._words[i:]) if word in ("i", "we"))
        clause = Clause("Bringing", self._t.between(i, i + length), i)
        phrase = NounPhrase(speaker, speaker + 1, speaker, "speaker", self._words[speaker])
        clause.roles.append(Role("Beneficiary", speaker, speaker + 1, speaker, [phrase]))
        self.found.clauses.append(clause)
        return self._arguments(clause, i + length)

    def _close(self, first: int, conditions: list[str]) -> None:
        """Give the conditions of a sentence to all of its clauses."""
        clauses = self.found.clauses[first:]
        every = list(
            dict.fromkeys((*conditions, *(text for clause in clauses for text in clause.conditions)))
        )
        over: set[str] = set()  # conditions that do not hold for later clauses
        for clause in clauses:
            ending = self._ending.intersection(clause.conditions)
            clause.conditions = [f"not ({text})" if text in over else text for text in every]
            over |= ending
        if conditions and not clauses:
            is_added = len(self.found.unused) == self._unused  # take the milk. If it is cold.
            if self.found.clauses and is_added and not self._denied.intersection(conditions):
                self.found.clauses[-1].conditions += conditions
            else:
                self.found.unused += conditions

    def _clause(self, i: int) -> int:
        length, frame = self._g.verb(self._words, i)
        if quantities.read_bound(self._g, self._words, i + length - 1):  # pick UP TO three cups
            length, frame = self._g.verb(self._words[: i + length - 1], i)
        if knows := self._lets_know(i):
            length, frame = 1, "Telling"
            self.found.structural.append(knows)
        if activity := self._ended(i):
            return self._end_activity(i, activity)
        clause = Clause(frame, " ".join(self._words[i : i + length]), i)
        self.found.clauses.append(clause)
        self._np.is_negated = self._is_negated
        self._np.takes_that = frame in ("Telling", "Questioning")
        self._np.takes_with = "with" in self._g.frames[frame].roles
        j = i + length
        match frame:
            case "Telling":
                return self._tell(clause, j)
            case "Cause_to_perceive" if self._shows_question(clause, j):
                clause.frame = "Telling"  # show Anna where the bathroom is
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
            case "Inspecting" if (state := self._stated(j)) is not None:  # make sure the fridge is closed
                end = self._clause_end(state.end)
                if state.amount.is_none:  # make sure no person is there
                    clause.roles.append(Role("Desired_state", j, end, j))
                    return end
                clause.roles.append(Role("Ground", j, state.end, state.head, [state]))
                clause.roles.append(Role("Desired_state", state.end, end, state.end))
                return end
            case "Inspecting" | "Perception_active" if j < len(self._words) and self._words[j] in (
                "if",
                "whether",
                "that",
            ):
                clause.frame = "Inspecting"
                end = self._clause_end(j)
                self._mention_all(j, end)
                clause.roles.append(Role("Desired_state", j, end, j))
                return end
        return self._arguments(clause, j)

    def _ended(self, i: int) -> int:
        """Return the index of the verb of an activity that a verb at `i` ends: stop FOLLOWING Nora; or 0."""
        length, frame = self._g.verb(self._words, i)
        if frame != "Activity_stop" and self._words[i : i + length] != ("stop",):
            return 0
        return self._activity(i + length)

    def _end_activity(self, i: int, j: int) -> int:
        """Read a clause that ends an activity: its roles are those of the verb at `j`."""
        before, ended = (
            len(self.found.clauses),
            " ".join(self._words[i : i + self._g.verb(self._words, i)[0]]),
        )
        end = self._clause(j)
        for clause in self.found.clauses[before:]:
            verb = clause.first + len(clause.verb.split())
            clause.roles.insert(0, Role("Activity", clause.first, verb, clause.first))
            clause.frame, clause.verb, clause.first = "Activity_stop", ended, i
        return end

    def _stated(self, i: int) -> NounPhrase | None:
        """Return the phrase at `i` of which the following words state something."""
        phrase = self._np.read(i)
        if phrase is None or phrase.end >= len(self._words):
            return None
        word = self._words[phrase.end]
        return phrase if any(self._g.is_a(word, kind) for kind in ("be", "have", "modal")) else None

    def _shows_question(self, clause: Clause, i: int) -> bool:
        """Return whether a question is shown to a person: show Anna how many cups there are."""
        phrase = self._np.read(i) if clause.verb.lower() == "show" else None
        return phrase is not None and bool(self._g.match("question", self._words, phrase.end))

    def _special(self, i: int, conditions: list[str], times: list[str]) -> int:
        """Read a question, or where something can be found."""
        before = len(self.found.clauses)
        declared = self._declares(i)
        if declared or self._asks(i):
            clause = Clause("Telling", self._words[declared or i], i, asks=True)
            self.found.clauses.append(clause)
            if declared:
                end = self._declared(clause, i, declared)
            elif self._g.match("question", self._words, i):
                end = self._question(clause, i)
            else:
                end = self._yes_no(clause, i)
        else:
            end = self._being_located(i)
        for clause in self.found.clauses[before:]:
            clause.times += times
        if self.found.clauses[before:] and clause.asks and clause.role("Topic") is None:  # how are you
            self.found.clauses.pop()
            self.found.unused.append(self._t.between(i, end))
        return max(end, i + 1)

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
            g.is_a(words[j], "be") or g.is_a(words[j], "modal") or g.is_a(words[j], "stated")
        ):
            clause.verb = clause.verb or words[j]
            j += 1
        self.found.clauses.append(clause)
        return self._arguments(clause, j)
