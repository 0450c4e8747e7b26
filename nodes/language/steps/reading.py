"""Converts a command to steps: its roles are resolved in the map, and pronouns in the earlier steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from msgspec import structs

from semmap.nodes.language.lexicon import commands
from semmap.nodes.language.steps import quantities, tokens
from semmap.nodes.language.steps.answers import answer, answer_states
from semmap.nodes.language.steps.clause import Clause, Role
from semmap.nodes.language.steps.clauses import ClauseReader
from semmap.nodes.language.steps.coverage import find_unused
from semmap.nodes.language.steps.entity_tests import Meaning, Names, World
from semmap.nodes.language.steps.exclusions import (
    PLACES,
    Mention,
    except_things,
    keep_mentioned,
    leave_mentioned,
)
from semmap.nodes.language.steps.meaning import Meanings
from semmap.nodes.language.steps.phrase import Amount, NounPhrase, PlacePhrase
from semmap.nodes.language.steps.translation import translate
from semmap.nodes.language.understanding.grounding import Scene
from semmap.nodes.language.understanding.pronouns import AFFORDANCES
from semmap.schemas.language import Antecedent, CommandStep, Filler, PlaceRelation

_LOCATED_BY: Final = {
    **dict.fromkeys(("Taking", "Bringing", "Giving", "Removing", "Placing", "Pouring"), "Source"),
    "Locating": "Ground",
}
"""Frames with the role that states where their object is."""
_CARRYING: Final = frozenset(("Taking", "Bringing", "Giving", "Placing", "Removing", "Releasing"))
_WORDS_ONLY: Final = frozenset(("Message", "Trigger", "Desired_state", "Manner", "Direction", "Activity"))
_PEOPLE: Final = frozenset(
    ("Cotheme", "Guiding", "Make_acquaintance", "Greeting", "Introducing", "Being_located", "Locating")
)
"""Frames whose object is a person, if a pronoun may refer to one."""


@dataclass(slots=True)
class Steps:
    """The steps of a command, the sets of entities of which one is meant, doubts and answers."""

    steps: list[CommandStep] = field(default_factory=list)
    ambiguous: list[Names] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    answers: list[str] = field(default_factory=list)
    commands: bool = False
    """Whether the text begins as a command does: with a verb, a wish or a condition."""
    asks: bool = False
    """Whether all of the steps are direct questions."""


def read_steps(text: str, world: World, scene: Scene | None = None) -> Steps:
    """Return the steps of a command in English, or in Italian if the labels of a `scene` are given."""
    return _StepReader(tokens.read(text) if scene is None else translate(text, scene), world).read()


class _StepReader:
    def __init__(self, text: tokens.Text, world: World) -> None:
        self._t, self._world = text, world
        self._g = commands.load()
        self._meanings = Meanings(text, self._g, world)
        self._mentions: list[Mention] = []
        self._found = Steps()

    def read(self) -> Steps:
        """Return the steps."""
        nouns = self._world.index.nouns["english"]
        parsed = ClauseReader(self._t, self._g, nouns, self._meanings.is_person, self._world.above).read()
        found = self._found
        for number, clause in enumerate(parsed.clauses):
            for _, phrase in (mention for mention in parsed.context if mention[0] == number):
                meaning = self._meanings.of(phrase, may_be_none=True)
                filler = Filler(
                    self._t.between(phrase.first, phrase.end),
                    self._t.word(phrase.head),
                    meaning.names,
                    meaning.description,
                )
                mention = Mention(
                    0, "", filler, meaning.is_person, phrase.is_plural, meaning.is_place, phrase
                )
                self._mentions.append(mention)
            found.steps.append(self._step(clause, len(found.steps) + 1))
        conditions = [text for clause in parsed.clauses for text in clause.conditions]
        is_condition = any(self._t.text.startswith(text) for text in conditions)
        is_condition = is_condition or bool(self._g.match("condition", self._t.words, 0))
        first = self._g.match("polite", self._t.words, 0)
        negation = self._g.match("negation", self._t.words, 0)
        first = max(first, negation)
        is_wish = any(self._g.match("wish", self._t.words, i) for i in (0, first))
        found.commands = is_condition or is_wish or negation > 1 or self._g.verb(self._t.words, 0)[0] > 0
        found.asks = bool(parsed.clauses) and all(clause.asks for clause in parsed.clauses)
        found.unknown = list(dict.fromkeys(parsed.unknown))
        for condition in dict.fromkeys(conditions):
            if condition.startswith("not (") and condition[5:-1] in conditions:
                continue
            found.doubts.append(f"'{condition}' is a condition; it is not checked")
        for time in dict.fromkeys(text for clause in parsed.clauses for text in clause.times):
            found.doubts.append(f"'{time}' is a time; nothing is done then by itself")
        found.doubts += [f"'{text}' is not understood" for text in parsed.unused]
        found.doubts += [f"'{old}' is corrected to '{new}'" for old, new in parsed.corrected]
        unused = find_unused(self._t, self._g, parsed, (*found.doubts, *found.unknown))
        found.doubts += [f"'{text}' is not understood" for text in unused]
        found.doubts = list(dict.fromkeys(found.doubts))
        return found

    def _step(self, clause: Clause, number: int) -> CommandStep:
        roles: dict[str, tuple[Filler, ...]] = {}
        mentions: list[Mention] = []
        where = self._where(clause)
        self._guide(clause)
        for role in clause.roles:
            fillers = tuple(self._fillers(clause, role, number, where, mentions))
            roles[role.role] = (*roles.get(role.role, ()), *fillers)
        self._mentions += mentions
        step = CommandStep(
            clause.frame,
            self._t.word(clause.first) if self._t.is_translated else clause.verb.lower(),
            roles,
            clause.negated,
            "; ".join(dict.fromkeys(clause.conditions)),
            "; ".join(dict.fromkeys(clause.times)),
        )
        return self._except(clause, step)

    def _except(self, clause: Clause, step: CommandStep) -> CommandStep:
        """Read *leave the blue one* and *do not take it* after *the cups* as an exception of them."""
        is_left = clause.verb.lower() == "leave" and clause.frame == "Placing"
        is_but = is_left and clause.first > 0 and self._t.words[clause.first - 1] == "but"
        step, changed = except_things(self._found.steps, step, is_left, is_but)
        for before, after in changed:
            text = after.description.excluded[-1] if after.description is not None else after.text
            self._found.doubts.append(f"'{text}' is read as an exception")
            for mention in self._mentions:
                mention.filler = after if mention.filler is before else mention.filler
        return step

    def _compare_mentioned(self, phrase: NounPhrase, meaning: Meaning, now: list[Mention]) -> None:
        """Compare the meaning of *another cup* or *the same cup* with what was mentioned."""
        mentions = [m for m in (*self._mentions, *now) if m.is_person == meaning.is_person and not m.is_place]
        compare = keep_mentioned if phrase.amount.is_same else leave_mentioned
        compare(meaning, mentions, self._t.between(phrase.first, phrase.end))

    def _guide(self, clause: Clause) -> None:
        """Change the frame of *take them to the kitchen* if a pronoun refers to a person."""
        theme = clause.role("Theme")
        if clause.frame not in self._g.persons or theme is None or not theme.phrases:
            return
        phrase = theme.phrases[0]
        if phrase.kind == "pronoun" and not self._g.is_a(phrase.noun, "person_pronoun"):
            antecedent = self._antecedent(phrase, clause, theme, [])
            if (
                antecedent is not None
                and antecedent.is_person
                and (clause.role("Goal") or clause.role("Source"))
            ):
                clause.frame, theme.role = self._g.persons[clause.frame], "Cotheme"

    def _where(self, clause: Clause) -> list[PlacePhrase]:
        """Return where the object of a clause is, by its Source or Ground."""
        role = clause.role(_LOCATED_BY.get(clause.frame, ""))
        if role is None or not role.phrases:
            return []
        other = role.phrases[0]
        preposition = " ".join(self._t.words[role.first : other.first])
        before = self._antecedent(other, clause, role, []) if other.kind == "pronoun" else None
        names = () if before is None else before.filler.entities
        return [PlacePhrase(preposition or "in", other, role.first, role.end, names=names)]

    def _fillers(
        self, clause: Clause, role: Role, number: int, where: list[PlacePhrase], mentions: list[Mention]
    ) -> Iterator[Filler]:
        if role.role in _WORDS_ONLY or not role.phrases:
            yield Filler(self._t.between(role.first, role.end), self._t.word(role.head))
            return
        is_object = role.role == self._g.frames[clause.frame].roles.get("object") or role.role in ("Cotheme",)
        for k, phrase in enumerate(role.phrases):
            first = role.first if k == 0 else phrase.first
            end = role.end if k == len(role.phrases) - 1 else phrase.end
            text, head = self._t.between(first, end), self._t.word(phrase.head)
            if phrase.noun == "there" and role.role in PLACES:
                yield self._there(text, head, number)
                continue
            if phrase.kind in ("speaker", "robot", "here"):
                yield Filler(text, head)
                continue
            if phrase.kind == "pronoun":
                filler = self._pronoun(phrase, text, head, clause, role, number, mentions)
                if phrase.asked and filler.entities:  # is it open
                    verdicts = self._meanings.verdicts(phrase, filler.entities)
                    self._found.answers.append(answer_states(phrase, verdicts, self._world))
                yield self._part(phrase, filler, clause, mentions)
                continue
            self._complete(phrase, mentions)
            for other in (*phrase.excluded, *phrase.alternatives):
                if other.noun in ("one", "ones"):  # any cup but not the red one
                    self._take_noun(other, phrase)
            places = where if is_object and role.role not in PLACES else []
            owner = self._owner(phrase)
            meaning = self._meanings.of(
                phrase,
                places,
                may_be_none=role.role == "Topic"
                or clause.frame in ("Counting", "Being_located", "Removing")
                or (clause.negated and phrase.amount.at_least is not None),  # never take more than two
                as_place=role.role in PLACES,
                owner=owner,
            )
            if phrase.amount.is_other or phrase.amount.is_same:
                self._compare_mentioned(phrase, meaning, mentions)
            if phrase.amount.is_none and clause.frame not in ("Telling", "Counting"):
                # take none of the cups; neither the cup nor the plate
                is_all = len(role.phrases) == 1 or self._t.words[role.phrases[0].first] == "neither"
                clause.negated = clause.negated or is_all
                meaning.doubts += [] if is_all else [f"'{text}' is not meant"]
            if phrase.amount.is_none and role.role == "Topic" and meaning.description is not None:
                meaning.description = structs.replace(meaning.description, at_most=0)  # are there no cups
            filler = Filler(text, head, meaning.names, meaning.description)
            self._note(meaning)
            if role.role == "Topic" and (message := clause.role("Message")) is not None:
                asked = " ".join(self._t.words[message.first : message.end])
                asked_of = self._t.words[message.head]
                self._found.answers.append(answer(asked, asked_of, text, phrase, meaning, self._world))
            mentions.append(
                Mention(
                    number,
                    role.role,
                    filler,
                    meaning.is_person,
                    phrase.is_plural,
                    (role.role in PLACES and not is_object) or meaning.is_place,
                    phrase,
                )
            )
            yield filler

    def _part(self, phrase: NounPhrase, filler: Filler, clause: Clause, now: list[Mention]) -> Filler:
        """Return the filler of a pronoun with its quantity: two of them, none of them."""
        amount = phrase.amount
        if amount == Amount() and phrase.quantity is None:
            return filler
        clause.negated = clause.negated or amount.is_none
        amount.is_vague = amount.is_vague or amount.is_other
        doubt = quantities.count(phrase, len(filler.entities) or None, filler.text)
        self._found.doubts += [doubt] if doubt else []
        part = structs.replace(filler, description=quantities.describe(phrase, filler.description))
        for mention in now:
            mention.filler = part if mention.filler is filler else mention.filler
        return part

    def _complete(self, phrase: NounPhrase, now: list[Mention]) -> None:
        """Give a phrase without a noun that of the last thing: the red one."""
        if phrase.noun in ("one", "ones"):
            before = (
                m.phrase
                for m in reversed((*self._mentions, *now))
                if m.phrase is not None and not m.is_person and not m.is_place
            )
            if (like := next(before, None)) is not None:
                self._take_noun(phrase, like)
            else:
                word = self._t.word(phrase.head)
                self._found.doubts.append(f"'{word}' refers to nothing that was mentioned")

    def _take_noun(self, phrase: NounPhrase, like: NounPhrase) -> None:
        """Give a phrase the noun of another one: of *red cup* only *cup*."""
        phrase.noun = like.noun.rpartition(" ")[2]
        phrase.key = self._meanings.key(phrase.noun)

    def _there(self, text: str, head: str, number: int) -> Filler:
        """Return the filler for *there*: the last place that was mentioned."""
        before = (m for m in reversed(self._mentions) if m.step != number)
        place = next((m for m in before if self._is_where(m) or self._is_somewhere(m)), None)
        if place is not None and not self._is_where(place):  # someone in the hall is waving, go THERE
            names = next(r.entities for r in self._places_of(place) if r.entities)
            return Filler(text, head, names)
        if place is None:
            self._found.doubts.append("'there' refers to no place that was mentioned")
            return Filler(text, head)
        refers = Antecedent(place.step, place.role) if place.step else None
        return Filler(text, head, place.filler.entities, place.filler.description, refers)

    def _is_where(self, mention: Mention) -> bool:
        """Return whether a mention denotes a place, by its class, its role or the preposition before it."""
        first = 0 if mention.phrase is None else mention.phrase.first
        return mention.is_place or (first > 0 and self._g.match("place", self._t.words, first - 1) > 0)

    def _places_of(self, mention: Mention) -> tuple[PlaceRelation, ...]:
        description = mention.filler.description
        return () if description is None else description.relation

    def _is_somewhere(self, mention: Mention) -> bool:
        """Return whether the description of what is mentioned states a known place of it."""
        return any(relation.entities and not relation.negated for relation in self._places_of(mention))

    def _note(self, meaning: Meaning) -> None:
        self._found.doubts += meaning.doubts
        if meaning.ambiguous:
            self._found.ambiguous.append(meaning.names)

    def _owner(self, phrase: NounPhrase) -> Names:
        """Return the entities of a possessive pronoun: his, her, their."""
        if phrase.owner is None or phrase.owner.kind != "pronoun":
            return ()
        person = next((mention for mention in reversed(self._mentions) if mention.is_person), None)
        return person.filler.entities if person is not None else ()

    # Pronouns

    def _affords(self, mention: Mention, roles: Mapping[str, str], role: str) -> bool:
        """Return whether a thing affords an action, by its class or because it had such a role before.

        `roles` maps the roles of the action to classes.
        """
        wanted = roles[role]
        names, index = mention.filler.entities, self._world.index
        if not names and (description := mention.filler.description) is not None:
            names = tuple(index.members.get(description.class_, ()))
        return mention.role in roles or (
            bool(names) and all(wanted in index.items[name].types for name in names)
        )

    def _is_location(self, mention: Mention) -> bool:
        """Return whether a mention denotes a room or another place that cannot be carried."""
        names = mention.filler.entities
        return bool(names) and all(self._world.index.items[name].is_place for name in names)

    def _pronoun(
        self,
        phrase: NounPhrase,
        text: str,
        head: str,
        clause: Clause,
        role: Role,
        number: int,
        mentions: list[Mention],
    ) -> Filler:
        antecedent = self._antecedent(phrase, clause, role, mentions)
        if antecedent is None:
            told = (
                k
                for k in range(len(self._found.steps), 0, -1)
                if self._found.steps[k - 1].roles.get("Message")
            )
            if (
                clause.frame == "Telling"
                and phrase.noun in ("it", "that", "this")
                and (step := next(told, 0))
            ):
                return Filler(text, head, refers=Antecedent(step, "Message"))  # and report IT to me
            if self._g.is_a(phrase.noun, "possessive") and phrase.noun not in ("her",):
                return Filler(text, head)
            self._found.doubts.append(f"'{phrase.noun}' refers to nothing that was mentioned")
            return Filler(text, head)
        roles = AFFORDANCES.get(clause.frame, {})
        is_known = role.role not in roles or self._affords(antecedent, roles, role.role)
        if antecedent.filler.entities and not is_known:
            kind = roles[role.role].removesuffix("_Thing").lower()
            self._found.doubts.append(f"'{text}': {antecedent.filler.shown} is not known to be {kind}")
        meant = [antecedent.filler]
        if self._g.is_a(phrase.noun, "several_pronoun"):  # all things of a list
            meant = [
                m.filler
                for m in self._mentions
                if m is antecedent or (m.step and (m.step, m.role) == (antecedent.step, antecedent.role))
            ]
        filler = Filler(
            text,
            head,
            tuple(dict.fromkeys(name for one in meant for name in one.entities)),
            antecedent.filler.description if len(meant) == 1 else None,
            Antecedent(antecedent.step, antecedent.role) if antecedent.step else None,
        )
        mentions.append(
            Mention(
                number, role.role, filler, antecedent.is_person, antecedent.is_plural, antecedent.is_place
            )
        )
        return filler

    def _antecedent(
        self, phrase: NounPhrase, clause: Clause, role: Role, now: list[Mention]
    ) -> Mention | None:
        g, word = self._g, phrase.noun
        mentions = [mention for mention in self._mentions if mention.filler.text]
        roles = AFFORDANCES.get(clause.frame, {})
        if role.role in roles:  # take the milk out of the fridge and close IT
            suited = [m for m in reversed(mentions) if self._affords(m, roles, role.role)]
            if g.is_a(word, "several_pronoun"):
                suited = [m for m in suited if m.is_plural] or suited
            if suited:  # of one step rather its object than a place
                step = suited[0].step
                return next((m for m in suited if m.step == step and not m.is_place), suited[0])
        if role.role in ("Beneficiary", "Recipient", "Addressee") or g.is_a(word, "person_pronoun"):
            return next((m for m in reversed(mentions) if m.is_person), None)
        if g.is_a(word, "several_pronoun"):
            people = clause.frame in _PEOPLE
            last = next(
                (
                    m
                    for m in reversed(mentions)
                    if m.is_plural and not m.is_place and not (people and not m.is_person)
                ),
                None,
            )
            person = next((m for m in reversed(mentions) if m.is_person), None)
            if people and person is not None:
                return person
            if last is not None:
                return last
            thing = next((m for m in reversed(mentions) if not m.is_place and not m.is_person), None)
            return thing or person
        if self._t.is_translated and clause.frame in _PEOPLE and word == "it":  # seguila
            return next((m for m in reversed(mentions) if not m.is_place), None)
        things = [m for m in mentions if not m.is_person]
        if role.role == "Theme" and clause.frame in _CARRYING:
            things = [m for m in things if not (m.is_place and self._is_location(m))]
        if (
            role.role in PLACES
            and (theme := next((m for m in now if not m.is_place and not m.is_person), None)) is not None
        ):
            things = [
                m for m in things if m.filler.entities != theme.filler.entities or not m.filler.entities
            ]
        if role.role in PLACES:  # the apples in the bowl and the banana next to IT
            things = [m for m in things if not m.is_plural] or things
        acted_on = next((m for m in reversed(things) if not m.is_place), None)
        if acted_on is not None and clause.frame not in ("Motion", "Arriving"):
            return acted_on
        return next(reversed(things), None)
