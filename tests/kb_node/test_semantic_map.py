import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.kb_node.applier import Applier
from semmap.nodes.kb_node.storage import conclusions_format
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import codec, errors
from semmap.schemas.commits import Commit, Edit, NewEntity, Snapshot
from semmap.schemas.entities import Pose, Provenance
from tests.kb_node import home
from tests.kb_node.home import chair, state, transaction, turtle
from tests.kb_node.storage.journal.test_journal import BULKY, full_by_page_count

CHAIR1, CHAIR2 = v.entity_iri("chair1"), v.entity_iri("chair2")


def test_a_commit_has_its_changes(semantic_map):
    commit = semantic_map.commit(
        transaction(1, chair(preferred="stool"), agent="ann", reason="tidy", confidence=0.5)
    )
    (entity,) = commit.changed
    assert commit.seq == semantic_map.seq == 1
    assert (entity.name, entity.class_, entity.preferred_reference) == ("chair1", "Chair", "stool")
    assert entity.types == ("Chair", "Seat", "Object", "Physical_Thing")
    assert (entity.provenance.agent, entity.provenance.reason, entity.provenance.confidence) == (
        "ann",
        "tidy",
        0.5,
    )
    assert set(commit.inserted) == set(chair(preferred="stool"))
    assert semantic_map.snapshot() == Snapshot(seq=1, entities=(entity,), digest=commit.digest)


def test_a_removed_entity_leaves_no_trace(semantic_map):
    semantic_map.commit(transaction(1, chair("chair2")))
    before = state(semantic_map)
    semantic_map.commit(transaction(2, chair()))
    commit = semantic_map.commit(transaction(3, retract=chair()))
    assert [(gone.name, gone.types) for gone in commit.removed] == [
        ("chair1", ("Chair", "Seat", "Object", "Physical_Thing"))
    ]
    assert commit.changed == ()
    assert state(semantic_map)[1:] == (before[1], structs.replace(before[2], seq=3, digest=commit.digest))


def test_a_change_without_effect_is_not_a_commit(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    assert semantic_map.commit(transaction(2, chair())) is None
    assert semantic_map.commit(transaction(3, retract=chair("chair2"))) is None
    assert semantic_map.commit(transaction(4, insert=chair(), retract=chair())) is None
    assert semantic_map.commit(transaction(5, insert=home.TBOX[:3])) is None
    assert semantic_map.seq == 1


def test_a_repeated_command_returns_its_first_commit(semantic_map):
    first = semantic_map.commit(transaction("same", chair()))
    assert semantic_map.commit(transaction("same", chair("chair2"))) == first
    semantic_map.commit(transaction("other", retract=chair()))
    again = home.reopened(semantic_map)
    assert again.commit(transaction("same", chair())) == first
    assert (len(again), again.seq) == (0, 2)
    home.close(again)


def test_a_repeated_command_in_one_batch_returns_one_commit(semantic_map):
    several = [
        transaction("same", chair()),
        transaction("same", chair("chair2")),
        transaction(3, chair("c3")),
    ]
    first, again, third = semantic_map.commit_together(several)
    assert again == first
    assert [commit.seq for commit in (first, third)] == [1, 2]
    assert sorted(entity.name for entity in semantic_map.entities()) == ["c3", "chair1"]


HIGH = ':a a dm:Chair ; dm:hasPosition [ dm:float_coordinates_x "high"^^xsd:float ] .'
NAN = ':a a dm:Chair ; dm:hasPosition [ dm:float_coordinates_y "NaN"^^xsd:float ] .'
TWICE = "<http://a.org/x#b> a dm:Chair . <http://b.org/x#b> a dm:Chair ."
IN_A_CHAIR = [*chair(), *turtle(":x dm:isLocatedIn :chair1 .")]


def new_chair(name):
    """Return the transaction that adds a chair."""
    return NewEntity(name=name, class_iri=v.bare(v.dm("Chair")))


REFUSED = {
    "inconsistent": ([*chair(), (CHAIR1, v.RDF_TYPE, v.LOCATION)], {}, errors.Inconsistent),
    "inferred to be inconsistent": (IN_A_CHAIR, {}, errors.Inconsistent),
    "ill-typed": (turtle(HIGH), {}, errors.Inconsistent),
    "not finite": (turtle(NAN), {}, errors.BadRequest),
    "precondition": (chair(), {"require": [(CHAIR2, v.RDF_TYPE, v.dm("Chair"))]}, errors.PreconditionFailed),
    "name taken": ((), {"add": [new_chair("chair0")]}, errors.NameTaken),
    "unknown entity to change": (chair("b"), {"edit": [Edit(name="chair9", ref="x")]}, errors.UnknownName),
    "unknown entity to remove": (chair("b"), {"remove": ["chair0", "chair9"]}, errors.UnknownName),
    "name taken elsewhere": (turtle("<http://example.org/x#chair0> a dm:Chair ."), {}, errors.NameTaken),
    "one name twice": (turtle(TWICE), {}, errors.NameTaken),
    "scheme": (turtle("<javascript:alert(1)#chair> a dm:Chair ."), {}, errors.BadRequest),
    "blank": (turtle("[] a dm:Chair ."), {}, errors.BadRequest),
    "TBox": ((), {"retract": [(v.dm("Chair"), v.RDFS_SUB_CLASS_OF, v.dm("Seat"))]}, errors.Refused),
}


@pytest.mark.parametrize(("insert", "fields", "error"), REFUSED.values(), ids=REFUSED.keys())
def test_a_rejected_transaction_changes_nothing(semantic_map, insert, fields, error):
    semantic_map.commit(transaction(0, chair("chair0")))
    before = state(semantic_map), set(semantic_map.reasoner.inferred())
    with pytest.raises(error) as caught:
        semantic_map.commit(transaction(1, insert, **fields))
    assert type(caught.value) is error
    assert (caught.value.explanation is not None) == (error is errors.Inconsistent)
    assert (state(semantic_map), set(semantic_map.reasoner.inferred())) == before
    again = home.reopened(semantic_map)
    assert state(again) == before[0]
    home.close(again)


@pytest.mark.parametrize(("insert", "retract"), [(chair("chair1"), ()), ((), chair("chair0"))])
def test_a_full_disk_changes_nothing(semantic_map, insert, retract):
    semantic_map.commit(transaction(0, chair("chair0")))
    before = state(semantic_map), set(semantic_map.reasoner.inferred())
    wanted = transaction(1, insert, retract, reason=BULKY)
    could_not = pytest.raises(errors.Refused, match="commit 2 could not be written to")
    with full_by_page_count(semantic_map._journal), could_not:
        semantic_map.commit(wanted)
    assert (state(semantic_map), set(semantic_map.reasoner.inferred())) == before
    assert semantic_map.commit(wanted).seq == 2


def test_a_name_may_move_to_another_namespace(semantic_map):
    other = turtle("<http://zzz.org/x#chair1> a dm:Chair .")
    semantic_map.commit(transaction(1, other))
    commit = semantic_map.commit(transaction(2, chair(), retract=other))
    assert [gone.name for gone in commit.removed] == ["chair1"]
    assert [entity.iri for entity in commit.changed] == [v.bare(CHAIR1)]
    commit = semantic_map.commit(transaction(3, other, retract=chair()))
    assert semantic_map.entity("chair1").iri == "http://zzz.org/x#chair1"
    expected = state(semantic_map)
    again = home.reopened(semantic_map)
    assert state(again) == expected
    home.close(again)


def test_an_entity_may_exist_by_inference_only(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    commit = semantic_map.commit(transaction(2, turtle(":chair1 dm:isLocatedIn :kitchen1 .")))
    kitchen = semantic_map.entity("kitchen1")
    assert (kitchen.class_, kitchen.place, kitchen.pose, kitchen.provenance.commit) == (
        "Location",
        True,
        None,
        2,
    )
    assert {entity.name for entity in commit.changed} == {"chair1", "kitchen1"}
    commit = semantic_map.commit(transaction(3, retract=turtle(":chair1 dm:isLocatedIn :kitchen1 .")))
    assert [gone.name for gone in commit.removed] == ["kitchen1"]


def test_provenance_has_the_last_change(semantic_map):
    def marks():
        entity = semantic_map.entity("chair1")
        since = (
            entity.provenance,
            entity.pose_provenance,
            entity.shape_provenance,
            entity.reference_provenance,
        )
        return tuple(p.commit for p in since)

    first, second = Pose(position_m=(1.0, 2.0, 0.0)), Pose(position_m=(3.0, 2.0, 0.0))
    node = v.entity_iri("chair1_coordinates")
    semantic_map.commit(transaction(1, chair()))
    assert marks() == (1, 1, 1, 1)
    semantic_map.commit(
        transaction(
            2,
            entity_triples.position(CHAIR1, node, second),
            entity_triples.position(CHAIR1, node, first),
            source="scene",
        )
    )
    assert marks() == (2, 2, 1, 1)
    assert semantic_map.entity("chair1").pose_provenance.source == "scene"
    semantic_map.commit(
        transaction(3, entity_triples.size(CHAIR1, v.entity_iri("chair1_size"), (1.0, 1.0, 1.0)))
    )
    assert marks() == (3, 2, 3, 1)
    semantic_map.commit(
        transaction(4, entity_triples.preferred_reference(CHAIR1, v.entity_iri("r"), "stool"))
    )
    assert marks() == (4, 2, 3, 4)
    semantic_map.commit(
        transaction(5, [(CHAIR1, v.RDF_TYPE, v.dm("Door"))], [(CHAIR1, v.RDF_TYPE, v.dm("Chair"))])
    )
    assert marks() == (5, 2, 5, 4)
    semantic_map.commit(transaction(6, chair("chair2")))
    assert marks() == (5, 2, 5, 4)
    (shared,) = turtle(':r dm:lexicalReference "seat" .')
    semantic_map.commit(transaction(7, [shared]))
    assert marks() == (7, 2, 5, 7)


def test_entities_are_listed_by_inferred_class(semantic_map):
    semantic_map.commit(
        transaction(1, [*chair("b"), *chair("a"), *turtle(":k a dm:Kitchen . :d a dm:Door .")])
    )
    assert [e.name for e in semantic_map.entities()] == ["a", "b", "d", "k"]
    assert [e.name for e in semantic_map.entities(v.dm("Seat"))] == ["a", "b"]
    assert [e.name for e in semantic_map.entities(v.LOCATION)] == ["k"]
    assert list(semantic_map.entities(v.COORDINATES)) == []
    counts = {row.name: (row.asserted, row.inferred) for row in semantic_map.class_table()}
    assert (counts["Chair"], counts["Seat"], counts["Physical_Thing"]) == ((2, 2), (0, 2), (0, 4))


def test_unknown_names_have_suggestions(semantic_map):
    semantic_map.commit(transaction(1, chair()))
    with pytest.raises(errors.UnknownName, match=r"no entity is named 'chiar1'; did you mean chair1\?"):
        semantic_map.entity("chiar1")
    with pytest.raises(errors.UnknownName):
        semantic_map.stars(["chair1", "chair9"])


def test_individuals_of_the_tbox_are_entities_that_commands_cannot_change(tmp_path):
    semantic_map = home.new_map(
        tmp_path,
        [
            *home.TBOX,
            *turtle(":sink a dm:Door ."),
        ],
    )
    assert semantic_map.entity("sink").provenance.commit == 0
    with pytest.raises(errors.Refused, match="sink is part of the TBox, which commands cannot change"):
        semantic_map.stars(["sink"])
    with pytest.raises(
        errors.Refused, match="the TBox states that sink type Door, and commands cannot change the TBox"
    ):
        semantic_map.commit(transaction(1, retract=turtle(":sink a dm:Door .")))
    semantic_map.commit(
        transaction(2, turtle(":sink dm:hasPreferredReference :r . :r dm:lexicalReference 'sink' ."))
    )
    semantic_map.checkpoint()
    again = home.reopened(semantic_map)
    assert again.entity("sink").preferred_reference == "sink"
    home.close(again)


def test_entities_of_a_checkpoint_by_other_code_are_read_again(semantic_map, monkeypatch):
    semantic_map.commit(transaction(1, chair(preferred="stool")))
    semantic_map.commit(transaction(2, turtle(":chair1 dm:hasSize :s .")))
    before = semantic_map.snapshot()
    assert [e.provenance.commit for e in before.entities] == [2]
    with monkeypatch.context() as other:
        other.setattr(conclusions_format, "format_mark", lambda: b"other")
        semantic_map.update_entities(
            [structs.replace(entity, class_="Stool") for entity in semantic_map.entities()]
        )
        semantic_map.checkpoint()
    again = home.reopened(semantic_map)
    assert again.snapshot() == before
    assert again._schedule.is_written(2)
    home.close(again)


def test_a_start_from_a_checkpoint_infers_nothing_again(semantic_map, monkeypatch):
    semantic_map.commit(transaction(1, chair(preferred="stool")))
    before, inferred = semantic_map.snapshot(), list(semantic_map.inferred())
    semantic_map.checkpoint()
    monkeypatch.setattr(Applier, "change", None)
    again = home.reopened(semantic_map)
    monkeypatch.undo()
    assert again.snapshot() == before
    assert list(again.inferred()) == inferred
    assert again.commit(transaction(2, retract=chair(preferred="stool"))).removed
    home.close(again)


def test_a_snapshot_can_be_written_later(semantic_map):
    semantic_map.commit(transaction(1, chair(preferred="stool")))
    snapshot = semantic_map.snapshot_for_checkpoint()
    semantic_map.commit(transaction(2, turtle(":lamp1 a dm:Lamp .")))
    expected = state(semantic_map)
    semantic_map._journal.checkpoint(snapshot)
    semantic_map.written(snapshot.seq)
    again = home.reopened(semantic_map)
    assert state(again) == expected
    assert again._schedule.is_written(1)
    home.close(again)


SIZE = "a dm:3Three_Dim_Size ; dm:float_size_x 1.0 ; dm:float_size_y 1.0 ; dm:float_size_z 1.0"
SAYINGS = [
    turtle(text)
    for text in (
        ":chair1 dm:hasSize :s .",
        ":chair2 dm:hasSize :s .",
        f":s {SIZE} .",
        ":chair1 dm:isLocatedIn :k .",
        ":k a dm:Kitchen .",
        ":chair3 dm:hasPreferredReference :chair1_preferred_reference .",
    )
]
CHAIRS = st.builds(
    chair, st.sampled_from(["chair1", "chair2", "chair3"]), preferred=st.sampled_from(["a", "b"])
)
STARS = st.lists(st.one_of(CHAIRS, st.sampled_from(SAYINGS)), min_size=1, max_size=6)


@settings(max_examples=20, deadline=None)
@given(STARS)
def test_a_load_equals_its_parts_one_by_one(tmp_path_factory, parts):
    at_once, one_by_one = (home.new_map(tmp_path_factory.mktemp("map")) for _ in range(2))
    try:
        for number, part in enumerate(parts):
            one_by_one.commit(transaction(number, part))
    except errors.Refused:
        with pytest.raises(errors.Refused):
            at_once.commit(transaction(0, [fact for part in parts for fact in part]))
    else:
        at_once.commit(transaction(0, [fact for part in parts for fact in part]))
        assert set(at_once.abox()) == set(one_by_one.abox())
        assert list(map(without_author, at_once.entities())) == list(
            map(without_author, one_by_one.entities())
        )
    home.close(at_once)
    home.close(one_by_one)


def without_author(entity):
    """Return an entity without its author."""
    none = Provenance(commit=0, stamp_ns=0, source="file")
    names = ("provenance", "pose_provenance", "shape_provenance", "reference_provenance")
    return structs.replace(entity, **dict.fromkeys(names, none))


NAMES = st.sampled_from(["chair1", "chair2", "chair3"])
SEEN = st.sampled_from([0.0, 1.0])
SAID = ["dm:isLocatedIn :kitchen", "dm:hasSize :s"]
OPERATIONS = st.lists(
    st.one_of(
        st.tuples(st.just("insert"), NAMES, SEEN),
        st.tuples(st.just("retract"), NAMES, SEEN),
        st.tuples(st.just("say"), NAMES, st.sampled_from([*SAID, "a dm:Location"])),
        st.tuples(st.just("unsay"), NAMES, st.sampled_from(SAID)),
        st.just(("checkpoint", "", "")),
    ),
    max_size=8,
)  # fmt: skip


def perform(semantic_map, number, operation):
    what, name, how = operation
    if what == "checkpoint":
        semantic_map.checkpoint()
        return
    triples = chair(name, (how, 0.0, 0.0)) if isinstance(how, float) else turtle(f":{name} {how} .")
    insert, retract = ((), triples) if what in ("retract", "unsay") else (triples, ())
    before = state(semantic_map)
    try:
        semantic_map.commit(transaction(number, insert, retract))
    except (errors.Refused, errors.BadRequest):  # it contradicts the map, or is a second position
        assert state(semantic_map) == before


@settings(max_examples=12, deadline=None)
@given(OPERATIONS)
def test_a_restart_restores_the_map_with_and_without_checkpoints(tmp_path_factory, operations):
    semantic_map = home.new_map(tmp_path_factory.mktemp("map"))
    for number, operation in enumerate(operations):
        perform(semantic_map, number, operation)
    expected, classes = state(semantic_map), list(semantic_map.class_table())
    again = home.reopened(semantic_map)
    assert (state(again), list(again.class_table())) == (expected, classes)
    with again._journal.file.reading() as db:
        db.execute("DELETE FROM checkpoints")
    from_nothing = home.reopened(again)
    assert (state(from_nothing), list(from_nothing.class_table())) == (expected, classes)
    home.close(from_nothing)


@settings(max_examples=12, deadline=None)
@given(OPERATIONS, OPERATIONS)
def test_a_commit_and_its_reverse_restore_the_map(tmp_path_factory, before, after):
    semantic_map = home.new_map(tmp_path_factory.mktemp("map"))
    for number, operation in enumerate(before):
        perform(semantic_map, number, operation)
    _, triples, snapshot = state(semantic_map)
    first = semantic_map.seq
    for number, operation in enumerate(after):
        perform(semantic_map, f"after {number}", operation)
    for commit in reversed(list(semantic_map._journal.commits(after=first))):
        semantic_map.commit(transaction(f"undo {commit.seq}", commit.retracted, commit.inserted))
    assert set(semantic_map.abox()) == triples
    assert [plain(e) for e in semantic_map.entities()] == [plain(e) for e in snapshot.entities]
    home.close(semantic_map)


def plain(entity):
    """Return an entity without provenance."""
    no_author = structs.replace(entity.provenance, commit=0, stamp_ns=0)
    return structs.replace(
        entity,
        provenance=no_author,
        pose_provenance=no_author,
        shape_provenance=no_author,
        reference_provenance=no_author,
    )


def test_a_commit_that_no_longer_fits_is_reported_at_the_start(semantic_map):
    bad = Commit(
        seq=1, stamp_ns=1, id="1", source="file", inserted=tuple(turtle(":a a dm:Chair , dm:Kitchen ."))
    )
    semantic_map._journal.append(bad)
    with pytest.raises(errors.Refused, match="commit 1 no longer fits its TBox: a cannot be"):
        home.reopened(semantic_map)


def test_a_commit_survives_encoding(semantic_map):
    commit = semantic_map.commit(transaction(1, chair()))
    assert codec.decode(codec.encode(commit), Commit) == commit


def test_transactions_in_a_batch_are_committed_or_rejected_separately(semantic_map):
    kitchen = [(CHAIR1, v.RDF_TYPE, v.dm("Kitchen"))]
    results = semantic_map.commit_together(
        [transaction(1, chair()), transaction(2, kitchen), transaction(3, chair("chair2")), transaction(1)]
    )
    assert [getattr(result, "seq", type(result)) for result in results] == [1, errors.Inconsistent, 2, 1]
    assert state(home.reopened(semantic_map)) == state(semantic_map)


def test_a_batch_changes_nothing_if_the_disk_is_full(semantic_map):
    semantic_map.commit(transaction(0, chair("chair0")))
    before = state(semantic_map)
    long = "x" * 20_000
    transactions = [
        transaction(1, chair()),
        transaction(2, retract=chair("chair0")),
        transaction(3, chair("chair2", preferred=long)),
    ]
    with full_by_page_count(semantic_map._journal):
        results = semantic_map.commit_together(transactions)
    assert {type(result) for result in results} == {NotWritten}
    assert state(semantic_map) == before
    assert [commit.seq for commit in semantic_map.commit_together(transactions)] == [2, 3, 4]
    assert state(home.reopened(semantic_map)) == state(semantic_map)


@pytest.mark.parametrize("together", [False, True])
@pytest.mark.parametrize("durable", [False, True])
def test_after_an_unexpected_error_the_node_must_restart(semantic_map, monkeypatch, together, durable):
    semantic_map.commit(transaction("before", chair("chair1")))
    on_failure = []
    semantic_map.on_failure = lambda: on_failure.append(True)

    def fail(*_):
        raise MemoryError

    where, what = (semantic_map, "apply_commit") if durable else (semantic_map._applier, "_with_effects")
    monkeypatch.setattr(where, what, fail)
    wanted = [transaction("a", chair("chair2")), transaction("b", chair("chair3"))]
    with pytest.raises(errors.NoAnswer, match="restarts from its journal, because a change failed"):
        semantic_map.commit_together(wanted) if together else semantic_map.commit(wanted[0])
    assert on_failure == [True]
    assert not semantic_map.is_sound
    monkeypatch.undo()
    again = home.reopened(semantic_map)
    is_there = durable and not together  # commits made together are durable together, or not at all
    assert {e.name for e in again.snapshot().entities} == {"chair1", *(["chair2"] if is_there else [])}
    assert again.commit(transaction("a", chair("chair2"))).seq == 2
    home.close(again)


def test_declarations_survive_a_start_from_a_checkpoint(semantic_map):
    said = turtle(":swivel a owl:Class ; rdfs:subClassOf dm:Seat . :chair1 a :swivel .")
    semantic_map.commit(transaction(1, said))
    before = state(semantic_map), set(semantic_map.inferred())
    semantic_map.checkpoint()
    again = home.reopened(semantic_map)
    assert (state(again), set(again.inferred())) == before
    again.commit(transaction(2, turtle(":chair2 a :swivel .")))
    assert "Seat" in again.entity("chair2").types
    home.close(again)
