"""Corrections that a speaker makes: take the red cup, no, the blue one."""

from __future__ import annotations

from semmap.nodes.language.steps.clause import Clause, Role
from semmap.nodes.language.steps.frame_completion import FrameCompletion
from semmap.nodes.language.steps.phrase import NounPhrase


class CorrectionReader(FrameCompletion):
    """Reads words that replace what was said before them."""

    def _arguments(self, clause: Clause, i: int) -> int:
        raise NotImplementedError

    def _corrects(self, i: int) -> int:
        """Return the index after an expression of correction at `i` (no, wait, I mean), or `i`.

        *no* before a noun without an article is a determiner: something to drink, no wine.
        """
        g, words = self._g, self._words
        j, is_sure, last = i, False, ""
        while j < len(words):
            if length := g.match("correction", words, j):
                is_sure = True
            else:
                length = g.match("weak_correction", words, j)
            if not length and not (words[j] == "," and (j > i or i > 0)):
                break
            last = words[j] if length else last
            j += length or 1
        if not last or self._t.is_mark(j) or words[j] in ("and", "then"):
            return i
        if last == "no" and words[j - 1] == "no" and not self._opens_repair(j):
            return i
        is_apart = i == 0 or self._t.is_mark(i) or self._t.is_mark(i - 1) or words[i] == "or"
        if i == 0 or not is_apart or not (is_sure or self._opens_repair(j)):
            return i
        if self._t.ends_sentence(i - 1) and (not is_sure or g.match("polite", words, j)):
            return i  # sorry, could you also take the milk
        if not is_sure and last in ("wait", "hold", "hang") and words[j - 1] != ",":
            return i  # go to the kitchen, wait for Anna
        return j

    def _opens_repair(self, i: int) -> bool:
        """Return whether what replaces other words may begin at `i`: an article, a preposition, a name."""
        kinds = ("to", "from", "place", "for", "about", "determiner", "all")
        return self._opens_phrase(i) or any(self._g.match(kind, self._words, i) for kind in kinds)

    def _correct(self, clause: Clause, first: int, i: int) -> int:
        """Read from `i` what replaces a role of a clause, after the marker at `first`; return its end."""
        if self._g.verb(self._words, i)[0] and not self._opens_repair(i):
            return self._replace(clause, first, i)
        end = self._condition(i, is_fronted=True)
        end += self._words[end : end + 1] == (",",)
        if end > i and self._g.verb(self._words, end)[0]:
            return self._replace(clause, first, i)  # no, if Anna is there, take the plate
        self._finish(clause)
        other = Clause(clause.frame, clause.verb, i)
        end = self._arguments(other, i)
        roles = [role for role in other.roles if role.end > role.first and role.role != "Manner"]
        if not roles and not other.conditions and not other.times:
            self.found.unused.append(self._t.between(first, end))
        for role in roles:
            self._replace_role(clause, role)
        clause.roles += (role for role in other.roles if role not in roles)
        clause.conditions += other.conditions
        clause.times += other.times
        return end

    def _replace(self, clause: Clause, first: int, i: int) -> int:
        """Take a clause back: what follows `first` is said instead of it."""
        if clause in self.found.clauses:
            self.found.clauses.remove(clause)
            while self._t.is_mark(first - 1):
                first -= 1
            after = self._t.between(i, self._clause_end(i + 1))
            self.found.corrected.append((self._t.between(clause.first, first), after))
        return i

    def _replace_role(self, clause: Clause, role: Role) -> None:
        """Replace the role of a clause that a corrected phrase stands for: the last one of its kind."""
        old = self._replaced(clause, role)
        if old is None:
            clause.roles.append(role)
            return
        self.found.corrected.append(
            (self._t.between(old.first, old.end), self._t.between(role.first, role.end))
        )
        if role.phrases and old.phrases:
            self._complete_noun(role.phrases[0], old.phrases[-1])
        role.role = old.role
        clause.roles[next(k for k, one in enumerate(clause.roles) if one is old)] = role

    def _replaced(self, clause: Clause, role: Role) -> Role | None:
        same = [old for old in clause.roles if old.role == role.role]
        phrase = role.phrases[0] if role.phrases else None
        if phrase is None or phrase.first > role.first or phrase.noun in ("one", "ones"):
            return same[-1] if same else None  # it has a preposition
        kind = self._kind_of(phrase)
        with_phrases = [old for old in clause.roles if old.phrases]
        alike = [old for old in with_phrases if self._kind_of(old.phrases[-1]) == kind]
        return next(reversed(alike or with_phrases), None)

    def _kind_of(self, phrase: NounPhrase) -> str:
        """Return whether a phrase denotes a person, a place or a thing to take."""
        if phrase.kind == "speaker" or self._is_person(phrase):
            return "person"
        classes = {*self._nouns.classes.get(phrase.key, ())}
        above = classes.union(*(self._above.get(name, frozenset()) for name in classes))
        return "place" if above & {"Location", "Furniture", "Fixture"} else "thing"

    def _complete_noun(self, phrase: NounPhrase, like: NounPhrase) -> None:
        """Give a correction without a noun that of what it replaces: THE BLUE ONE, BLUE."""
        is_quality = phrase.kind in ("name", "thing") and phrase.noun in self._nouns.qualities
        if phrase.noun in ("one", "ones") or (is_quality and not phrase.key):
            if is_quality:
                phrase.attributes.append(phrase.noun)
                phrase.kind, phrase.name, phrase.determiner = "thing", "", like.determiner
            phrase.noun = self._words[like.head]
            phrase.key = self._np.key(like.head, like.head + 1)
