"""Sixty situations made by hand: what is computed is what a person would say."""

import pytest

from benchmarks.relations.situations import SITUATIONS
from nodes.kb_node.relations.place_facts import Facts
from nodes.kb_node.relations.space import Space
from nodes.kb_node.relations.telling import relations
from schemas.commands import Relations


def test_there_are_sixty():
    assert len(SITUATIONS) == 60
    assert len({situation.title for situation in SITUATIONS}) == 60


@pytest.mark.parametrize("situation", SITUATIONS, ids=lambda situation: situation.title)
def test_what_a_person_would_say(situation):
    facts = Facts()
    facts.update(situation.things)
    assert set(facts) == situation.said
    space = Space(situation.things)
    told = {
        (r.subject, r.relation, r.object)
        for thing in situation.things
        for r in relations(space, Relations(name=thing.name))
    }
    assert situation.also <= told
    assert not situation.never & told
