"""Situations written by hand, whose relations match human judgement."""

from pathlib import Path

import pytest

from benchmarks.relations.situations import SITUATIONS, TABLE, TOP, about_y, on_table
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import list_relations
from semmap.schemas.commands import Relations

DOCS = Path(__file__).parents[3] / "docs/relations.md"


def test_their_titles_are_unique_and_the_docs_count_them():
    assert len({situation.title for situation in SITUATIONS}) == len(SITUATIONS) >= 100
    assert f"Each of the {len(SITUATIONS)} situations is a test" in DOCS.read_text("utf-8")


@pytest.mark.parametrize("situation", SITUATIONS, ids=lambda situation: situation.title)
def test_relations_match_human_judgement(situation):
    facts = Facts()
    facts.update(situation.things)
    assert set(facts) == situation.said
    space = Space(situation.things)
    told = {
        (r.subject, r.relation, r.object)
        for thing in situation.things
        for r in list_relations(space, Relations(name=thing.name))
    }
    assert situation.also <= told
    assert not situation.never & told


@pytest.mark.parametrize("off_m", [-0.05, -0.02, 0.0, 0.02, 0.05])
@pytest.mark.parametrize("lean_deg", [0.0, 5.0])
def test_relations_hold_within_the_pose_tolerance(off_m, lean_deg):
    facts = Facts()
    facts.update([TABLE, on_table("can1", z=off_m, turn=about_y(lean_deg))])
    lowest = facts.space.solids["can1"].bottom - TOP
    assert (("can1", "isOn", "table1") in facts) == (abs(lowest) <= 0.05 + 1e-9)
    assert abs(lowest - off_m) < 0.004
