"""The index of asserted locations."""

from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.relations.facts.asserted_locations import AssertedLocations
from semmap.ontology import vocabulary as v

CUP, TABLE, TRAY = map(v.entity_iri, ("cup1", "table1", "tray1"))
IS_ON, SUPPORTS, COLOR = map(v.dm, ("isOn", "supports", "hasColor"))


def sayings(*triples):
    return AssertedLocations(lambda p: [t for t in triples if t[1] == p])


def test_a_triple_is_found_by_subject_and_object():
    said = sayings((CUP, IS_ON, TABLE), (TABLE, SUPPORTS, TRAY), (CUP, COLOR, v.dm("color_red")))
    assert said
    assert set(said.about(["cup1"])) == {(CUP, IS_ON, TABLE)}
    assert set(said.about(["table1"])) == {(CUP, IS_ON, TABLE), (TABLE, SUPPORTS, TRAY)}
    assert said.about(["tray1"]) == {(TABLE, SUPPORTS, TRAY): ("tray1", "isOn", "table1")}
    assert said.about(["missing"]) == {}


def test_without_assertions():
    said = sayings((CUP, COLOR, v.dm("color_red")))
    assert not said
    said.change((), [(CUP, IS_ON, TABLE)])
    assert said
    said.change([(CUP, IS_ON, TABLE)], ())
    assert not said


things = st.sampled_from([CUP, TABLE, TRAY])
triples = st.tuples(things, st.sampled_from([IS_ON, SUPPORTS, COLOR]), things)


@given(st.lists(st.tuples(st.sets(triples), st.sets(triples)), max_size=6), st.sets(triples))
def test_incremental_updates_equal_a_rebuild(changes, begin):
    held = set(begin)
    said = sayings(*held)
    assert bool(said) == any(p != COLOR for _, p, _ in held)
    for gone, come in changes:
        gone = gone & held
        come = come - held - gone
        held = (held - gone) | come
        said.change(gone, come)
    rebuilt = sayings(*held)
    for name in ("cup1", "table1", "tray1"):
        assert said.about([name]) == rebuilt.about([name])
    assert bool(said) == bool(rebuilt)
