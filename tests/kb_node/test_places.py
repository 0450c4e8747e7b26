"""Effects of changes on locations: retracted assertions, carried objects, objects left behind."""

import random
import re

import pytest

from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.relations.facts.asserted_locations import AssertedLocations
from semmap.nodes.kb_node.relations.facts.contradictions import find_contradiction
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.undo import undo
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import History, Undo
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home

WORDS = "".join(
    f'dm:{name} a owl:Class ; rdfs:subClassOf dm:Object ; dm:model "{name.lower()}" .\n'
    for name in ("Table", "Tray", "Cup", "Bowl", "Apple", "Book")
)
TBOX_TURTLE = (
    home.TBOX_TURTLE
    + WORDS
    + """
dm:Thing a owl:Class ; rdfs:subClassOf dm:Physical_Thing ; dm:model "nothing known" .
dm:isOn a owl:ObjectProperty , owl:AsymmetricProperty ; owl:inverseOf dm:supports ;
    owl:propertyDisjointWith dm:isInside .
dm:supports a owl:ObjectProperty ; rdfs:domain dm:Object .
dm:isInside a owl:ObjectProperty ; owl:inverseOf dm:holds ; rdfs:range dm:Object .
dm:holds a owl:ObjectProperty ; rdfs:domain dm:Object .
dm:isLocatedIn a owl:ObjectProperty .
"""
)
TBOX = rdf.parse(TBOX_TURTLE.encode(), "tbox.ttl", label_prefix="t")
TOP = 0.74
"""Height of a table of 1.5 m by 0.9 m [m]."""


def new(name, class_, at, *, size=None, on=None, **said):
    said = {**said, **({"isOn": on} if on else {})}
    return NewEntity(
        name=name,
        class_iri=v.bare(v.dm(class_)),
        pose=None if at is None else Pose(position_m=at),
        size=size,
        set=tuple(Statement(property=p, values=(o,)) for p, o in said.items()),
    )


@pytest.fixture
def room(tmp_path):
    """A table with a tray, on which are a cup and a bowl with an apple, and a second table."""
    semantic_map = home.new_map(tmp_path, TBOX)
    commit(
        semantic_map,
        add=(
            new("kitchen1", "Kitchen", (0.0, 0.0, 0.0), size=(12.0, 12.0, 2.5)),
            new("table1", "Table", (0.0, 0.0, 0.0), size=(1.5, 0.9, TOP)),
            new("table2", "Table", (3.0, 0.0, 0.0), size=(1.5, 0.9, TOP)),
        ),
    )
    commit(
        semantic_map,
        add=(
            new("tray1", "Tray", (0.0, 0.0, TOP), size=(0.5, 0.4, 0.02)),
            new("cup1", "Cup", (-0.15, 0.0, TOP + 0.02)),
            new("bowl1", "Bowl", (0.1, 0.0, TOP + 0.02)),
            new("apple1", "Apple", (0.1, 0.0, TOP + 0.04)),
        ),
    )
    yield semantic_map
    home.close(semantic_map)


numbers = iter(range(10_000))


def commit(semantic_map, **fields):
    wanted = Transaction(id=f"c{next(numbers)}", source="operator", verb="update", **fields)
    return semantic_map.commit(wanted)


def say(semantic_map, name, property_, other):
    edit = Edit(name=name, set=(Statement(property=property_, values=(other,)),))
    return commit(semantic_map, edit=(edit,))


def move(semantic_map, name, at, **fields):
    return commit(semantic_map, edit=(Edit(name=name, at=at, **fields),))


def take_back(semantic_map, seq=None):
    return undo(semantic_map, semantic_map._journal, Undo(id=f"u{next(numbers)}", commit=seq))


def said(semantic_map, property_="isOn"):
    triples = semantic_map.reasoner.asserted(None, v.dm(property_), None)
    return {(v.entity_name(s), v.entity_name(o)) for s, _, o in triples}


def stands(notes):
    """Return the notes without their distances."""
    return [re.sub(r"( it stands) [0-9.]+ m from it$", r"\1", note) for note in notes]


def where(semantic_map, name):
    return semantic_map.entity(name).pose.position_m


def test_a_move_retracts_assertions_that_the_geometry_denies(room):
    say(room, "cup1", "isOn", "table1")
    say(room, "cup1", "isLocatedIn", "kitchen1")
    before = home.state(room)[1:]
    made = move(room, "cup1", (0.0, 2.0, 0.0))
    assert (v.entity_iri("cup1"), v.dm("isOn"), v.entity_iri("table1")) in made.retracted
    assert stands(made.notes) == ["retracted: cup1 was asserted to be on table1; it stands"]
    assert (said(room), said(room, "isLocatedIn")) == (set(), {("cup1", "kitchen1")})
    assert room.entity("cup1").properties == {"isLocatedIn": ("kitchen1",)}
    take_back(room)
    assert home.state(room)[1] == before[0]
    assert said(room) == {("cup1", "table1")}


def test_moving_the_support_retracts_them_and_inverse_assertions_too(room):
    say(room, "table1", "supports", "cup1")
    made = move(room, "table1", (-3.0, 0.0, 0.0))
    assert stands(made.notes) == ["retracted: cup1 was asserted to be on table1; it stands"]
    assert said(room, "supports") == set()


def test_a_new_size_retracts_them_too(room):
    say(room, "cup1", "isOn", "table1")
    say(room, "cup1", "isOn", "tray1")
    assert not commit(room, edit=(Edit(name="table1", size=(1.4, 0.9, TOP)),)).notes
    made = commit(room, edit=(Edit(name="table1", size=(1.5, 0.9, 0.3)),))
    assert len(made.notes) == 1
    assert said(room) == {("cup1", "tray1")}


def test_assertions_that_still_hold_are_kept(room):
    say(room, "cup1", "isOn", "tray1")
    say(room, "cup1", "isOn", "table1")
    assert not move(room, "cup1", (0.1, 0.1, TOP + 0.02)).notes
    assert said(room) == {("cup1", "tray1"), ("cup1", "table1")}


def test_an_assertion_against_the_geometry_is_kept_and_noted(room):
    made = say(room, "cup1", "isOn", "table2")
    assert stands(made.notes) == ["cup1 was asserted to be on table2; it stands"]
    assert said(room) == {("cup1", "table2")}
    stays = move(room, "apple1", (0.1, 0.01, TOP + 0.04))
    assert not stays.notes
    assert said(room) == {("cup1", "table2")}
    made = move(room, "cup1", (-0.1, 0.0, TOP + 0.02))
    assert made.notes[0].startswith("retracted: cup1 was asserted to be on table2")
    assert said(room) == set()


def test_assertions_of_the_same_commit_are_not_retracted(room):
    say(room, "cup1", "isOn", "table1")
    edit = Edit(name="cup1", at=(3.0, 3.0, 0.0), set=(Statement(property="isOn", values=("table2",)),))
    made = commit(room, edit=(edit,))
    assert stands(made.notes) == [
        "retracted: cup1 was asserted to be on table1; it stands",
        "cup1 was asserted to be on table2; it stands",
    ]
    assert said(room) == {("cup1", "table2")}


def test_assertions_of_a_new_entity_are_noted(room):
    made = commit(room, add=(new("book1", "Book", (5.0, 0.0, 0.0), on="table2"),))
    assert stands(made.notes) == ["book1 was asserted to be on table2; it stands"]


def test_unknown_geometry_denies_nothing(room):
    """Flat maps have no sizes, and some entities no position."""
    commit(
        room,
        add=(
            new("lost1", "Cup", None, on="table1"),
            new("thing1", "Thing", (5.0, 5.0, 0.0)),
            new("thing2", "Thing", (0.0, 0.0, 0.0), on="thing1"),
        ),
    )
    assert not move(room, "table1", (-3.0, 0.0, 0.0)).notes
    assert not move(room, "thing2", (1.0, 0.0, 0.0)).notes
    assert said(room) == {("lost1", "table1"), ("thing2", "thing1")}


def test_a_first_position_counts_as_a_move(room):
    commit(room, add=(new("lost1", "Cup", None, on="table1"),))
    assert len(move(room, "lost1", (5.0, 5.0, 0.0)).notes) == 1
    assert said(room) == set()


def test_a_dry_run_reports_it_and_changes_nothing(room):
    say(room, "cup1", "isOn", "table1")
    before = home.state(room)
    wanted = Transaction(id="dry", source="operator", edit=(Edit(name="cup1", at=(0.0, 2.0, 0.0)),))
    tried = dry_runs.dry_run(room, lambda: room.commit(wanted))
    assert stands(tried.notes) == ["retracted: cup1 was asserted to be on table1; it stands"]
    assert home.state(room) == before
    assert said(room) == {("cup1", "table1")}


def test_a_contradiction_with_a_retracted_assertion_is_accepted(room):
    """An object inside another is not on it: the two properties are disjoint."""
    say(room, "apple1", "isOn", "table1")
    with pytest.raises(errors.Inconsistent):
        say(room, "apple1", "isInside", "table1")
    edit = Edit(name="apple1", at=(0.0, 2.0, 0.0), set=(Statement(property="isInside", values=("table1",)),))
    assert len(commit(room, edit=(edit,)).notes) == 2


def test_a_contradiction_with_a_denied_assertion_is_rejected(room):
    say(room, "table1", "isOn", "table2")
    before = triples(room), room.all_derived()
    with pytest.raises(errors.Inconsistent, match=r"table1 and table2|table2 and table1"):
        say(room, "table2", "isOn", "table1")
    with pytest.raises(errors.Inconsistent):
        say(room, "table1", "supports", "table2")
    assert (triples(room), room.all_derived()) == before
    assert say(room, "cup1", "isOn", "table2") is not None


def test_a_contradiction_with_a_measured_fact_is_accepted(room):
    say(room, "apple1", "isOn", "table2")
    before = room.all_derived()
    assert say(room, "bowl1", "isOn", "apple1").notes  # apple1 is measured to be inside bowl1
    take_back(room)
    after = room.all_derived()
    assert (set(after.come), set(after.aside)) == (set(before.come), set(before.aside))


def test_an_undo_that_restores_a_contradiction_is_rejected(room):
    """The geometry denies nothing about entities without a position."""
    commit(room, add=(new("lost1", "Cup", None, on="table1"),))
    on = (v.entity_iri("lost1"), v.dm("isOn"), v.entity_iri("table1"))
    retracted = commit(room, retract=(on,))
    say(room, "table1", "isOn", "lost1")
    before = triples(room), room.all_derived()
    with pytest.raises(errors.Inconsistent, match=r"cannot be undone: .*table1"):
        take_back(room, retracted.seq)
    assert (triples(room), room.all_derived()) == before


def test_an_undo_may_restore_contradicting_assertions_that_the_geometry_denies(room, monkeypatch):
    say(room, "table1", "isOn", "table2")
    with monkeypatch.context() as patched:  # as in maps that were created before this was rejected
        patched.setattr(room.derived_facts, "require_agreement", lambda inserted: None)
        say(room, "table2", "isOn", "table1")
    before = triples(room), {*room.all_derived().aside}
    assert len(before[1]) == 2
    moved = move(room, "table1", (0.0, 3.0, 0.0))
    assert len(moved.retracted) > len(moved.inserted)
    take_back(room)
    assert (triples(room), {*room.all_derived().aside}) == before
    assert dry_runs.dry_run(room, lambda: move(room, "table1", (0.0, 3.0, 0.0))).notes
    assert (triples(room), {*room.all_derived().aside}) == before


def test_it_is_the_same_after_a_restart(room):
    say(room, "cup1", "isOn", "table1")
    made = move(room, "cup1", (0.0, 2.0, 0.0))
    before = home.state(room)
    again = home.reopened(room)
    room._journal = again._journal
    assert home.state(again) == before
    assert again._journal.commit(made.seq).notes == made.notes
    logged = HistoryReader(again._journal).history(History(name="cup1"))[-1]
    assert logged.notes == made.notes
    assert [change.text for change in logged.changes][1] == "isOn: - table1"


def test_undo_of_a_retraction_after_further_assertions(room):
    say(room, "cup1", "isOn", "table1")
    moved = move(room, "cup1", (3.0, 0.0, TOP))
    say(room, "cup1", "isOn", "table2")
    back = take_back(room, moved.seq)
    assert said(room) == {("cup1", "table1")}
    assert stands(back.notes) == ["retracted: cup1 was asserted to be on table2; it stands"]


def test_carry(room):
    made = move(room, "tray1", (3.0, 0.0, TOP), yaw=1.5707963267948966, carry=True)
    assert made.notes == ("bowl1, cup1 and apple1 moved with tray1",)
    assert {e.name for e in made.changed} == {"tray1", "bowl1", "cup1", "apple1"}
    assert where(room, "cup1") == pytest.approx((3.0, -0.15, TOP + 0.02), abs=1e-5)
    assert where(room, "apple1") == pytest.approx((3.0, 0.1, TOP + 0.04), abs=1e-5)
    assert room.entity("cup1").pose.yaw_rad == pytest.approx(1.5708, abs=1e-4)
    take_back(room)
    assert where(room, "cup1") == (-0.15, 0.0, TOP + 0.02)


def test_carry_keeps_assertions_among_the_moved_objects(room):
    say(room, "cup1", "isOn", "tray1")
    say(room, "cup1", "isOn", "table1")
    made = move(room, "tray1", (3.0, 0.0, TOP), carry=True)
    assert said(room) == {("cup1", "tray1")}
    assert len(made.notes) == 2


def test_carry_excludes_given_names(room):
    made = move(room, "tray1", (3.0, 0.0, TOP), carry=True, leave=("bowl1",))
    assert {e.name for e in made.changed} == {"tray1", "cup1"}


def test_carry_without_objects_has_a_note(room):
    made = move(room, "cup1", (3.0, 0.0, TOP), carry=True)
    assert made.notes == ("nothing is on cup1 or inside it",)


@pytest.mark.parametrize(
    ("edit", "error", "text"),
    [
        (Edit(name="tray1", carry=True), errors.BadRequest, "requires --at, --yaw or --orientation"),
        (Edit(name="kitchen1", at=(1.0, 0.0, 0.0), carry=True), errors.Refused, "kitchen1 is a place"),
        (
            Edit(name="tray1", at=(1.0, 0.0, 0.0), carry=True, leave=("cap1",)),
            errors.UnknownName,
            "no entity is named 'cap1'; did you mean",
        ),
        (Edit(name="lost1", at=(1.0, 0.0, 0.0), carry=True), errors.Refused, "lost1 has no position"),
    ],
)
def test_carry_is_rejected_without_a_move_or_a_position(room, edit, error, text):
    commit(room, add=(new("lost1", "Cup", None),))
    before = home.state(room)
    with pytest.raises(error, match=text):
        commit(room, edit=(edit,))
    assert home.state(room) == before


def test_a_removal_reports_what_was_on_and_in_it(room):
    made = commit(room, remove=("bowl1",))
    assert made.notes == ("inside bowl1 was apple1",)
    made = commit(room, remove=("apple1", "tray1", "table2"))
    assert made.notes == ("on tray1 was cup1",)
    assert commit(room, remove=("cup1",)).notes == ()


def test_a_removed_entity_with_contents_is_removed_completely(room):
    """Including all that was computed about it."""
    commit(room, remove=("bowl1",))
    made = commit(room, remove=("table1",))
    assert [gone.name for gone in made.removed] == ["table1"]
    assert not {"bowl1", "table1"} & set(room.names)
    assert not list(room.reasoner.inferred(None, None, v.entity_iri("table1")))
    assert not list(room.reasoner.inferred(v.entity_iri("table1")))
    take_back(room)
    assert room.entity("table1").class_ == "Table"


def test_removing_everything_reports_nothing(room):
    assert commit(room, remove=tuple(room.names)).notes == ()


def test_a_removal_reports_asserted_contents(room):
    commit(room, add=(new("lost1", "Cup", None, on="table2"),))
    assert commit(room, remove=("table2",)).notes == ("on table2 was lost1",)


def test_maps_in_other_vocabularies_are_supported(tmp_path):
    """A move written as triples, as in a document or an undo."""
    semantic_map = home.new_map(tmp_path, TBOX)
    commit(semantic_map, add=(new("table1", "Table", (0.0, 0.0, 0.0), size=(1.5, 0.9, TOP)),))
    commit(semantic_map, add=(new("cup1", "Cup", (0.0, 0.0, TOP), on="table1"),))
    node = v.entity_iri("cup1_coordinates")
    x = list(semantic_map.reasoner.asserted(node, v.COORDINATE_XYZ[0], None))
    far = (node, v.COORDINATE_XYZ[0], v.literal("4.0", v.XSD_FLOAT))
    made = commit(semantic_map, retract=tuple(x), insert=(far,))
    assert len(made.notes) == 1
    assert said(semantic_map) == set()
    home.close(semantic_map)


@pytest.mark.parametrize("seed", range(4))
def test_invariants_hold_for_random_changes(room, seed):
    """No denied assertion remains about moved entities; undo and restart restore the same state."""
    dice = random.Random(seed)
    for _ in range(60):
        before, poses = triples(room), {e.name: (e.pose, e.size_m) for e in room.entities()}
        made = random_change(room, dice)
        if made is None:
            continue
        moved = {e.name for e in room.entities() if poses.get(e.name) not in (None, (e.pose, e.size_m))}
        own = set(made.inserted)
        for triple, (thing, relation, other) in room.places._sayings.about(moved).items():
            if triple not in own:
                assert find_contradiction(room.places.space(), (thing, relation, other)) is None
        fresh = AssertedLocations(lambda p: room.reasoner.asserted(None, p, None))
        assert fresh.about(room.names) == room.places._sayings.about(room.names)
        if dice.random() < 0.5:
            take_back(room, made.seq)
            assert triples(room) == before
    again = home.reopened(room)
    room._journal = again._journal
    assert home.state(again) == home.state(room)


def triples(semantic_map):
    return set(semantic_map.abox())


def random_change(room, dice):
    name = dice.choice(["table1", "table2", "tray1", "cup1", "bowl1", "apple1"])
    other = dice.choice(["table1", "table2", "tray1", "kitchen1"])
    if room.find(name) is None:
        return commit(room, add=(new(name, "Cup", (0.0, 0.0, TOP)),))
    match dice.randrange(6):
        case 0 | 1 if room.find(other) is not None and other != name:
            property_ = "isLocatedIn" if other == "kitchen1" else dice.choice(["isOn", "isInside"])
            try:
                return say(room, name, property_, other)
            except errors.Inconsistent:
                return None
        case 2 if name not in ("table1", "table2"):
            return commit(room, remove=(name,))
        case 3:
            size = tuple(dice.choice([0.2, 0.5, 1.0]) for _ in range(3))
            return commit(room, edit=(Edit(name=name, size=size),))
        case _:
            beside = room.find(dice.choice(["table1", "table2"])).pose.position_m
            at = (beside[0] + dice.uniform(-0.8, 0.8), beside[1], dice.choice([0.0, TOP, TOP + 0.02]))
            return move(room, name, at, carry=dice.random() < 0.4, yaw=dice.choice([None, 1.0]))


def test_a_dry_run_of_a_removal_keeps_suppressed_facts(room):
    say(room, "cup1", "isOn", "table2")
    before = room.all_derived(), set(room.inferred())
    for names in (("cup1",), ("table2",), ("cup1", "table2")):
        tried = Transaction(id=f"dry {names}", source="operator", remove=names)
        effects = dry_runs.dry_run(room, lambda wanted=tried: room.commit(wanted))
        assert "table2 supports cup1" not in effects.trial.lost
        after = room.all_derived(), set(room.inferred())
        assert set(after[0].aside) == set(before[0].aside)
        assert set(after[0].come) == set(before[0].come)
        assert after[1] == before[1]
