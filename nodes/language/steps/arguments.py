"""The arguments of a verb: objects, prepositional phrases, particles and lists."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from semmap.nodes.language.steps.clause import Clause, Role
from semmap.nodes.language.steps.corrections import CorrectionReader
from semmap.nodes.language.steps.phrase import NounPhrase, PlacePhrase
from semmap.nodes.language.steps.times import starts_time

_MOVING: Final = ("Motion", "Arriving", "Guiding", "Bringing")


class ArgumentReader(CorrectionReader):
    """Reads the arguments of a clause."""

    def _arguments(self, clause: Clause, i: int) -> int:
        """Read the arguments of a clause; return where it ends."""
        g, words = self._g, self._words
        roles = g.frames[clause.frame].roles
        objects: list[NounPhrase] = []
        while i < len(words) and (self._corrects(i) > i or not self._ends_clause(i)):
            if (repair := self._corrects(i)) > i:
                return self._correct(clause, i, repair)
            if (end := self._condition(i)) > i:
                self._add_condition(clause, i, end)
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
            elif (j := self._after_then(i)) > i and self._is_receiver_gap(clause, j):
                return self._gapped(clause, j)
            elif (phrase := self._next_place(clause, j)) is not None:
                i = self._coordinate(clause, j - 1, phrase)
            elif words[i] in ("each", "apiece") and self._t.is_mark(i + 1):
                clause.roles.append(Role("Manner", i, i + 1, i))
                i += 1
            elif words[i] == "using" or words[i - 1 : i + 1] == (",", "whichever"):
                end = self._clause_end(i)
                self.found.unused.append(self._t.between(i, end))
                i = end
            elif words[i] == ",":
                i += 1
            elif (
                self._excludes(i)
                and objects
                and (excluded := self._np.read_excluded(i + self._np.exclusion(i)))
            ):
                objects[-1].exclude(excluded)
                i = self._excluded_end(clause, excluded)
            elif words[i] == "but" and (excluded := self._np.read_excluded(i + 1)):
                if objects and (
                    objects[-1].all_of
                    or objects[-1].determiner == "any"
                    or g.is_a(objects[-1].noun, "anything")
                    or (objects[-1].is_plural and excluded[0].noun in ("one", "ones"))
                ):
                    objects[-1].exclude(excluded)  # all cups but the red one
                elif self._is_negated:
                    return self._contrast(clause, i + 1)
                else:
                    self.found.unused.append(self._t.between(i, excluded[-1].end))
                i = excluded[-1].end
            elif words[i] == "but" and any(g.match(kind, words, i + 1) for kind in ("to", "from", "place")):
                if self._is_negated:
                    return self._contrast(clause, i + 1)
                end = self._clause_end(i + 1)  # not to Nora but to me
                self.found.unused.append(self._t.between(i, end))
                i = end
            elif (
                g.is_a(words[i], "and")
                and (phrase := self._np.read(i + 1)) is not None
                and not self._t.is_mark(i + 1)
            ):
                i = self._coordinate(clause, i, phrase)
            elif (phrase := self._other_place(clause, i)) is not None:
                i = phrase.end
            elif (length := g.match("here", words, i)) and (phrase := self._np.read(i)) is not None:
                if "to" in roles or "place" in roles:
                    role = roles.get("to") or roles["place"]
                    clause.roles.append(Role(role, i, phrase.end, phrase.head, [phrase]))
                i = phrase.end
            elif (length := g.match("manner", words, i)) and not self._quantifies(i, length):
                clause.roles.append(Role("Manner", i, i + length, i))
                i += length
            elif "direction" in roles and g.is_a(words[i], "direction"):
                clause.roles.append(Role("Direction", i, i + 1, i))
                i += 1
            elif self._is_bounded(clause, i, objects) and (phrase := self._object(clause, i)) is not None:
                objects.append(phrase)
                i = phrase.end
                self._add_object(clause, objects, phrase)
            elif (found := self._prepositional(clause, i)) is not None:
                i = found
            elif (particle := self._particle(clause, i)) is not None:
                i = particle
            elif (phrase := self._object(clause, i)) is not None:
                objects.append(phrase)
                i = phrase.end
                self._add_object(clause, objects, phrase)
            elif length := max(
                g.match("polite", words, i), g.match("then", words, i), g.match("loose_particle", words, i)
            ):
                i += length
            else:
                end = i + 1
                while (
                    end < len(words)
                    and not self._ends_clause(end)
                    and not self._subordinates(end)
                    and not g.match("place", words, end)
                    and not g.match("to", words, end)
                ):
                    end += 1
                self.found.unused.append(self._t.between(i, end))
                i = end
        self._finish(clause)
        return i

    def _excluded_end(self, clause: Clause, excluded: list[NounPhrase]) -> int:
        """Return where an exception ends; a source after it is its own: not the one FROM THE SHELF."""
        last = excluded[-1]
        length = self._g.match("from", self._words, last.end)
        other = self._np.read(last.end + length) if length and clause.role("Source") is not None else None
        if other is None:
            return last.end
        preposition = " ".join(self._words[last.end : other.first])
        last.places.append(PlacePhrase(preposition, other, last.end, other.end))
        last.end = other.end
        return last.end

    def _quantifies(self, i: int, length: int) -> bool:
        """Return whether an expression of manner at `i` is a determiner there: a little water."""
        phrase = self._np.read(i) if self._g.match("determiner", self._words, i) else None
        return phrase is not None and phrase.end > i + length

    def _next_goal(self, i: int) -> int:
        """Return the index of another goal after *then* at `i`, or 0: to the desk, then TO THE SHELF."""
        j = self._after_then(i)
        return j if j > i and self._g.match("to", self._words, j) else 0

    def _after_then(self, i: int) -> int:
        """Return the index after commas and words such as *then* at `i`."""
        while i < len(self._words) and (self._words[i] == "," or self._g.match("then", self._words, i)):
            i += max(1, self._g.match("then", self._words, i))
        return i

    def _object(self, clause: Clause, i: int) -> NounPhrase | None:
        phrase = self._np.read(i)
        is_particle = (
            phrase is not None and phrase.kind == "name" and self._g.is_a(self._words[i], "particle")
        )
        return None if phrase is None or phrase.end == i or is_particle else phrase

    def _is_bounded(self, clause: Clause, i: int, objects: list[NounPhrase]) -> bool:
        """Return whether the object begins with a bound like a preposition at `i`: UP TO two cups."""
        last = objects[-1] if objects else None
        is_open = last is None or last.kind in ("speaker", "pronoun") or self._is_person(last)
        return (
            is_open and "object" in self._g.frames[clause.frame].roles and self._np.read_bound(i) is not None
        )

    def _add_object(self, clause: Clause, objects: list[NounPhrase], phrase: NounPhrase) -> None:
        """Add an object: of two, the first is the receiver (bring me the cup)."""
        led = clause.role("Cotheme") if clause.frame == "Guiding" and len(objects) == 2 else None
        is_given = led is not None and phrase.kind == "thing" and not self._is_person(phrase)
        if led is not None and is_given and self._g.verbs.get((clause.verb.lower(),)) in self._g.persons:
            clause.frame, led.role = "Bringing", "Beneficiary"  # bring Anna and Ben a cup
            clause.roles.append(Role("Theme", phrase.first, phrase.end, phrase.head, [phrase]))
            return
        roles = self._g.frames[clause.frame].roles
        role = roles.get("object") or roles.get("place") or "Theme"
        if phrase.kind == "here" and ("object" not in roles or clause.role(role) is not None):
            to = roles.get("to") or roles.get("place") or "Goal"
            clause.roles.append(Role(to, phrase.first, phrase.end, phrase.head, [phrase]))
            return
        if clause.verb.lower() == "show" and phrase.noun == "way":
            self.found.structural.append(phrase.head)
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
            and (self._is_person(objects[0]) or objects[0].kind in ("pronoun", "speaker", "robot"))
            and (first := clause.role(role)) is not None
            and objects[0] in first.phrases
            and not (self._is_person(objects[0]) and self._is_person(phrase))
        ):
            first.role = roles["receiver"]
            if clause.frame == "Taking":  # get me a drink
                clause.frame = "Bringing"
        is_bare = phrase.kind == "name" and not self._t.tokens[phrase.first].is_capital
        if is_bare and clause.role(role) is not None and len(objects) > 1:
            self.found.unused.append(self._t.between(phrase.first, phrase.end))
            return
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
            and clause.role(self._g.frames[clause.frame].roles.get("object", "Theme")) is not None
        ):
            frame = self._g.verbs[both]
            old, new = self._g.frames[clause.frame].roles, self._g.frames[frame].roles
            for role in clause.roles:
                if role.role == old.get("object", "Theme"):
                    role.role = new.get("object", role.role)
            clause.frame, clause.verb = frame, " ".join(both)
            return i + 1
        return None

    def _coordinate(self, clause: Clause, i: int, phrase: NounPhrase) -> int:
        """Read *and* with a noun phrase: one more thing, or a clause without its verb (and a fork in it)."""
        last = clause.roles[-1] if clause.roles else None
        opens = last is None or (bool(last.phrases) and last.phrases[-1].kind in ("speaker", "pronoun"))
        if opens and self._words[i] == "or" and self._words[phrase.end : phrase.end + 1] == ("or",):
            return i + 1  # Italian "o il latte o l'acqua"
        if self._words[i] == "or" and self.starts_clause(i + 1):
            return self._unread(i + 1)  # or go to the kitchen
        if (before := self._coordinate_place(clause, phrase)) is not None:
            before.alternatives.append(phrase)
            if last is not None:
                last.end = last.phrases[-1].end = phrase.end
            return phrase.end
        if last is not None and last.phrases and last.phrases[-1].noun not in ("one", "ones"):
            self._complete_noun(last.phrases[-1], phrase)  # the red or the blue cup
        self._finish(clause)
        last = clause.roles[-1] if clause.roles else None
        if self._has_place(clause) and self._is_gap(clause, phrase):
            return self._gapped(clause, i + 1)
        if phrase.kind == "name" and not self._t.tokens[phrase.head].is_capital:
            return self._unread(i + 1)
        if last is None or not last.phrases:
            self.found.unused.append(self._t.between(i + 1, phrase.end))
            return phrase.end
        if self._words[i] == "or":
            last = clause.roles[-1] if self._has_place(clause) else last  # on the table or the desk
            last.phrases[-1].alternatives.append(phrase)
        else:
            last.phrases[-1].amount.total = None  # both cups and plates
            last.phrases.append(phrase)
        last.end = phrase.end
        return phrase.end

    def _coordinate_place(self, clause: Clause, phrase: NounPhrase) -> NounPhrase | None:
        """Return the place of an object to which *and* adds another: (the cup) in the kitchen AND THE HALL.

        None if the place will be a role of its own, or if a further object is added.
        """
        last = clause.roles[-1] if clause.roles else None
        if last is None or not last.phrases or not last.phrases[-1].places or phrase.places:
            return None
        other = last.phrases[-1].places[-1].other
        kinds = [self._kind_of(one) for one in (last.phrases[-1], other, phrase)]
        if kinds != ["thing", "place", "place"] or last.phrases[-1].places[-1].end != last.phrases[-1].end:
            return None
        if "place" in self._g.frames[clause.frame].roles:
            return None
        return other

    def _other_place(self, clause: Clause, i: int) -> NounPhrase | None:
        """Read *or* with a preposition as a choice of places: (on the table) OR ON THE DESK."""
        length = max(self._g.match(kind, self._words, i + 1) for kind in ("to", "from", "place"))
        phrase = self._np.read(i + 1 + length) if self._words[i] == "or" and length else None
        if phrase is None:
            return None
        self._finish(clause)
        last = clause.roles[-1] if clause.roles else None
        if last is None or not last.phrases or last.role == self._g.frames[clause.frame].roles.get("object"):
            return None
        last.phrases[-1].alternatives.append(phrase)
        last.end = phrase.end
        return phrase

    def _gapped(self, clause: Clause, i: int) -> int:
        """Read a clause without its verb, which is that of the clause before."""
        self._finish(clause)
        other = Clause(clause.frame, clause.verb, i, conditions=clause.conditions, times=clause.times)
        self.found.clauses.append(other)
        return self._arguments(other, i)

    def _is_receiver_gap(self, clause: Clause, i: int) -> bool:
        """Return whether another receiver with an object is at `i`: (give Nora milk and) ME WATER."""
        roles = self._g.frames[clause.frame].roles
        receiver, given = clause.role(roles.get("receiver", "")), clause.role(roles.get("object", ""))
        if receiver is None or given is None or receiver is given:
            return False
        to = self._np.read(i + self._g.match("to", self._words, i))
        if to is None or self._t.is_mark(to.end) or not (to.kind == "speaker" or self._is_person(to)):
            return False
        return self._np.read(to.end) is not None and not self._g.is_a(self._words[to.end], "and")

    def _contrast(self, clause: Clause, i: int) -> int:
        """Read what is to be done instead of a negated clause: (do not take the milk but) THE WATER."""
        self._finish(clause)
        other = Clause(clause.frame, clause.verb, i, conditions=clause.conditions, contrasts=True)
        self.found.clauses.append(other)
        self._is_negated = False
        end = self._arguments(other, i)
        known = {role.role for role in other.roles}
        other.roles = [*(role for role in clause.roles if role.role not in known), *other.roles]
        return end

    def _has_place(self, clause: Clause) -> bool:
        """Return whether another role than the object was read last, after an object."""
        last = clause.roles[-1] if clause.roles else None
        name = self._g.frames[clause.frame].roles.get("object", "")
        return last is not None and bool(last.phrases) and last.role != name and clause.role(name) is not None

    def _is_gap(self, clause: Clause, phrase: NounPhrase) -> bool:
        """Return whether a phrase is the object of a clause without its verb: (and) the cup TO NORA."""
        takes = "place" in self._g.frames[clause.frame].roles or clause.frame in ("Giving", "Bringing")
        kinds = ("to", "from", "place") if takes else ("to", "from")
        return bool(phrase.places) or any(self._g.match(kind, self._words, phrase.end) for kind in kinds)

    def _next_place(self, clause: Clause, i: int) -> NounPhrase | None:
        """Return the phrase at `i`, after a comma or *then*, if a list of objects or places goes on there."""
        before = self._words[i - 1]
        phrase = self._np.read(i) if before in (",", "then") and not self._t.is_mark(i) else None
        if phrase is None or not (phrase.key or phrase.amount.is_other or phrase.noun in ("one", "ones")):
            return None
        self._finish(clause)
        goes_on = self._has_place(clause) and (before == "," or self._is_gap(clause, phrase))
        return phrase if goes_on else None

    def _prepositional(self, clause: Clause, i: int) -> int | None:
        """Read a phrase with a preposition as a role; return its end."""
        g, words = self._g, self._words
        roles = g.frames[clause.frame].roles
        best = max(
            (g.match(kind, words, i), kind)
            for kind in ("to", "from", "place", "for", "about", "path", "with", "of")
        )
        length, kind = best
        if not length or self._is_infinitive(i):
            return None
        if self._subordinates(i + length) or starts_time(g, words, i + length):
            return None  # turn it off every time Anna leaves
        phrase = self._np.read(i + length)
        if phrase is None or phrase.end == i + length:
            return None
        if kind == "for" and clause.frame == "Perception_active":  # look in the kitchen for a cup
            clause.frame = "Locating"
            for other in clause.roles:
                other.role = "Ground" if other.role in ("Location", "Phenomenon") else other.role
            clause.roles.append(Role("Sought_entity", i, phrase.end, phrase.head, [phrase]))
            return phrase.end
        if (
            kind == "for"
            and phrase.kind == "speaker"
            and ("for" not in roles or roles["for"] == roles.get("object"))
        ):
            return phrase.end
        role = self._role(clause, kind, roles, phrase)
        if kind == "with" and role is not None:
            clause.roles.insert(0, Role(role, i, phrase.end, phrase.head, [phrase]))
            return phrase.end
        object_role = clause.role(roles.get("object", "")) if "object" in roles else None
        is_own = phrase.all_of or self._is_person(phrase)  # take a cup to everyone except Nora
        if phrase.excluded and not is_own and object_role is not None and object_role.phrases:
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
        if kind == "from" and is_person and self._t.is_translated and clause.frame in _MOVING:
            kind = "to"  # vai da Anna
        if kind == "to" and "receiver" in roles and (is_person or "to" not in roles):
            return roles["receiver"]
        if kind == "for" and not is_person and clause.frame != "Locating":
            return None
        if kind == "path":
            return "Path" if clause.frame in ("Motion", "Cotheme", "Guiding") else None
        return roles.get(kind)

    def _unread(self, i: int) -> int:
        """Note the words of a clause that cannot be read, if there are any; return where it ends."""
        if i == len(self._words):
            return i
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
