"""What a claim states of its subject, and when it was so, over given events and intervals."""

from types import SimpleNamespace

import pytest

from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown, Occurrences, Place
from semmap.nodes.kb_node.answers.past.episodes.resolved import Referent
from semmap.nodes.language.past.question import Claim
from semmap.schemas import errors
from semmap.schemas.episodes import Episode

AUTHORS = {0: "", 1: "anna", 2: "bruno", 3: "Anna", 4: "bruno", 5: "anna"}
NAMES = ("cup1", "table1", "desk1", "kitchen1", "room9")


def episode(since, until=None, what="", name="cup1", by=None):
    return Episode(
        subject=name, what=what, since=since, since_ns=since * 10, until=until,
        until_ns=None if until is None else until * 10, by=AUTHORS[since] if by is None else by,
    )  # fmt: skip


class Timeline:
    """A cup is added by commit 1 on the table, where it is until 2 and from 4; on the desk from 2 until 3."""

    present = SimpleNamespace(entities={"kitchen1": SimpleNamespace(place=True)})

    def last_state_of(self, name):
        return SimpleNamespace(place=True) if name == "room9" else None

    def author(self, seq):
        return AUTHORS[seq]

    def events(self, name, kind, what):
        seqs = {"add": (1, 5), "move": (2, 3, 4), "remove": (4,)}.get(kind, ())
        return [episode(seq, what=what) for seq in seqs]

    def intervals(self, names, relations, other, what):
        known = {"table1": [(4, None), (1, 2)], "desk1": [(2, 3)], "kitchen1": [(0, None)]}
        relation = "isLocatedIn" if other == "kitchen1" else "isOn"
        spans = known.get(other, []) if relation in relations else []
        return {name: [episode(*span, what=what, by="") for span in spans] for name in names}

    def state_intervals(self, name, property_name, value, state):
        if property_name == "isSwitchedOn":
            raise errors.BadRequest("unknown")
        return [episode(*span, what=state, by="") for span in ([(1, 2), (3, 4)] if value else [(2, 3)])]


@pytest.fixture
def occurrences():
    referents = {name: Referent(name, (name,)) for name in NAMES}
    referents["anna"] = Referent("anna", author="anna")
    return Occurrences(Timeline(), referents, ("cup1",))


def claim(event="", *places, **fields):
    return Claim(["cup1"], event, places=list(places), **fields)


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        (claim("move", ("to", "table1")), "moved on table1"),
        (claim("move", ("from", "table1")), "moved from table1"),
        (claim("put"), "put down"),
        (claim("put", ("at", "table1")), "on table1"),
        (claim("take"), "taken away"),
        (claim("take", ("from", "table1")), "moved from table1"),
        (claim("missing"), "missing"),
        (claim(state="open"), "open"),
        (claim("", ("at", "kitchen1")), "in kitchen1"),
        (claim("", ("at", "room9")), "in room9"),
        (claim("", ("in", "table1")), "in table1"),
        (claim("", ("near", "table1"), ("in", "kitchen1")), "near table1 in kitchen1"),
    ],
)
def test_what_a_claim_states(occurrences, asked, text):
    assert occurrences.what(asked, occurrences.places(asked)) == text


@pytest.mark.parametrize(
    ("how", "relations"),
    [
        ("on", ("isOn",)),
        ("in", ("isInside",)),
        ("near", ("isNear",)),
        ("attached", ("isAttachedTo",)),
        ("at", ("isOn", "isInside")),
    ],
)
def test_the_relations_of_a_preposition(occurrences, how, relations):
    assert occurrences.relations(how, "table1") == relations
    assert occurrences.relations(how, "kitchen1") == ("isLocatedIn",)


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        (claim("", ("on", "table1")), ["on table1 1-2", "on table1 4-"]),
        (claim("", ("on", "desk1"), ("in", "kitchen1")), ["on desk1 in kitchen1 2-3"]),
        (claim("", ("on", "table1"), ("on", "desk1")), []),
        (claim("put", ("on", "table1")), ["put on table1 1- by anna", "put on table1 4- by bruno"]),
        (claim("put", ("in", "kitchen1")), []),  # it has been there since before the history
        (claim("put", ("on", "table1"), agent="anna"), ["put on table1 1- by anna"]),
        (claim("take", ("on", "table1")), ["no longer on table1 2- by bruno"]),
        (claim("move", ("from", "table1"), ("to", "desk1")), ["no longer on table1 2- by bruno"]),
        (claim("move", ("from", "desk1"), ("to", "desk1")), []),
        (claim("move", ("in", "kitchen1")), [f"moved in kitchen1 {n}- by {AUTHORS[n]}" for n in (2, 3, 4)]),
        (claim("move", ("on", "desk1")), ["put on desk1 2- by bruno"]),
        (claim("move", ("near", "desk1")), []),
        (claim("move"), [f"moved {n}- by {AUTHORS[n]}" for n in (2, 3, 4)]),
        (claim("move", agent="anna"), ["moved 3- by Anna"]),
        (claim("put"), [f"put down {n}- by {AUTHORS[n]}" for n in (1, 2, 3, 4, 5)]),
        (claim("take"), [f"taken away {n}- by {AUTHORS[n]}" for n in (2, 3, 4, 4)]),
        (claim("missing"), ["missing 4-5 by bruno"]),
        (claim(state="open"), ["open 1-2", "open 3-4"]),
        (claim("open"), ["opened 3- by Anna"]),  # it was added open
        (claim("close"), ["closed 2- by bruno"]),
    ],
)  # fmt: skip
def test_when_a_claim_was_so(occurrences, asked, found):
    def text(e):
        return f"{e.what} {e.since}-{e.until or ''}" + (f" by {e.by}" if e.by else "")

    assert [text(e) for e in occurrences.of(asked, ("cup1",))] == found


@pytest.mark.parametrize(
    ("asked", "problem"),
    [
        (claim("enter"), "names no place"),
        (claim("switch_on"), "whether cup1 was on was never stated"),
        (claim("move", agent="cup1"), "no commit is by cup1"),
        (claim("move", ("to", "anna")), "'anna' is the author of commits"),
    ],
)
def test_why_a_claim_has_no_answer(occurrences, asked, problem):
    with pytest.raises(NotKnown, match=problem):
        occurrences.of(asked, ("cup1",))


def test_the_subjects_of_a_claim(occurrences):
    assert occurrences.subjects(Claim(["table1", "cup1", "table1"])) == ("table1", "cup1")
    assert occurrences.subjects(Claim(is_it=True)) == occurrences.names("it") == ("cup1",)
    assert [found.text for found in occurrences.unused()] == ["desk1", "kitchen1", "room9", "anna"]
    with pytest.raises(NotKnown, match="'it' refers to nothing"):
        Occurrences(Timeline(), {}, ()).subjects(Claim(is_it=True))
    with pytest.raises(NotKnown, match="'anna' is the author"):
        occurrences.kind("anna")


def test_intervals_at_several_places_are_in_order(occurrences):
    found = occurrences.there(["cup1"], Place("at", ("table1", "desk1"), "a surface"))
    assert [(e.what, e.since) for e in found["cup1"]] == [("on table1", 1), ("on desk1", 2), ("on table1", 4)]
