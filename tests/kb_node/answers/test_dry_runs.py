"""Dry runs report what would be committed and inferred, and change nothing."""

import pytest

from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.undo import undo
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import TakeBack
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle
from tests.kb_node.stating import TBOX, adding, editing, stated, statement


def tried_commit(semantic_map, transaction):
    """Return the effects of a dry run of a transaction."""
    return tried(semantic_map, lambda: semantic_map.commit(transaction))


def tried(semantic_map, change):
    """Return the effects of a dry run, after which the map and the disk must be unchanged."""
    before = home.state(semantic_map), set(semantic_map.reasoner.inferred()), semantic_map._journal.last
    try:
        return dry_runs.dry_run(semantic_map, change)
    finally:
        after = home.state(semantic_map), set(semantic_map.reasoner.inferred()), semantic_map._journal.last
        assert after == before


def test_effects_and_inferences_are_reported(stateful_map):
    effects = tried(
        stateful_map, lambda: stateful_map.commit(adding("stool1", set=(statement("isOn", "chair1"),)))
    )
    assert (effects.seq, [e.name for e in effects.changed]) == (stateful_map.seq + 1, ["stool1"])
    assert (effects.trial.inserted, effects.trial.retracted, effects.trial.changed) == (2, 0, ("stool1",))
    assert {"stool1 type Seat", "stool1 type Object"} <= set(effects.trial.gained)
    assert effects.trial.lost == ()


def test_lost_inferences_are_reported(stateful_map):
    stated(stateful_map, "hasMainColor", "red")
    effects = tried(
        stateful_map, lambda: stateful_map.commit(editing(stateful_map, unset=(statement("hasMainColor"),)))
    )
    assert effects.trial.lost == ("chair1 hasColor color_red",)
    gone = tried_commit(stateful_map, transaction("go", remove=["chair1"]))
    assert [departed.name for departed in gone.removed] == ["chair1"]
    assert "chair1 type Seat" in gone.trial.lost


def test_a_rejected_change_is_rejected_in_a_dry_run(stateful_map):
    with pytest.raises(errors.Inconsistent):
        tried(
            stateful_map,
            lambda: stateful_map.commit(editing(stateful_map, set=(statement("isLocatedIn", "chair1"),))),
        )
    with pytest.raises(errors.NameTaken):
        tried_commit(stateful_map, adding("chair1"))


def test_a_change_without_effect_has_no_result(stateful_map):
    assert (
        tried(
            stateful_map, lambda: stateful_map.commit(editing(stateful_map, class_iri=v.bare(v.dm("Chair"))))
        )
        is None
    )


def test_the_same_id_can_be_committed_after_a_dry_run(stateful_map):
    addition = adding("stool1")
    tried_commit(stateful_map, addition)
    assert stateful_map.commit(addition).seq == 2
    assert tried_commit(stateful_map, addition) is None


def test_an_undo_and_a_large_load_can_be_dry_runs(stateful_map):
    stated(stateful_map, "isOpen", "true")
    journal = stateful_map._journal
    back = tried(
        stateful_map, lambda: undo(stateful_map, journal, TakeBack(id="u", source="operator", commit=2))
    )
    assert (back.undoes, back.changed[0].properties) == ((2,), {})
    many = [t for i in range(400) for t in chair(f"c{i}")]
    assert len(tried_commit(stateful_map, transaction("many", many)).trial.changed) == 400


def test_replacing_the_tbox_can_be_a_dry_run(stateful_map):
    thrones = frozenset(TBOX) | set(turtle("dm:Throne a owl:Class ; rdfs:subClassOf dm:Chair ."))
    replacing = transaction("tbox")
    effects = tried(stateful_map, lambda: stateful_map.replace_tbox(replacing, thrones))
    assert effects.tbox
    assert "Throne" not in stateful_map.classes.iris
    without = frozenset(t for t in TBOX if v.dm("Chair") not in t)
    with pytest.raises(tbox_validation.DoesNotFit):
        tried(stateful_map, lambda: stateful_map.replace_tbox(replacing, without))
