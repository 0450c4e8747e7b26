"""Preconditions of transactions, checked against the map."""

import pytest

from semmap.nodes.kb_node import preconditions
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node.home import transaction

CUP, NEW = v.entity_iri("cup1"), v.entity_iri("cup2")
TYPE = (CUP, v.RDF_TYPE, v.dm("Cup"))
MANY = [(CUP, v.dm("touches"), v.entity_iri(f"table{i}")) for i in range(200)]
ABSENT = (CUP, v.dm("touches"), v.entity_iri("table999"))


@pytest.fixture(params=[0, 62, 63, 200], ids="{} more".format)
def reasoner(request):
    """A reasoner with one cup and few or many triples about it."""
    reasoner = Reasoner([(v.dm("Cup"), v.RDF_TYPE, v.OWL_CLASS)])
    reasoner.apply(insert=[TYPE, *MANY[: request.param]])
    return reasoner


def test_asserted_triples_are_found(reasoner):
    said = set(reasoner.asserted()).intersection(MANY)
    for where in ("require", "retract", "insert"):
        asked = transaction(1, **{where: (TYPE, *MANY, ABSENT, (NEW, v.RDF_TYPE, v.dm("Cup")))})
        groups = asked.require, asked.retract, asked.insert
        assert preconditions.find_asserted(reasoner, groups) == {TYPE, *said}


def test_required_triples_must_be_asserted():
    preconditions.require(transaction(1, require=(TYPE,)), {TYPE})
    with pytest.raises(errors.PreconditionFailed, match="no longer holds that cup1"):
        preconditions.require(transaction(1, require=(TYPE, ABSENT)), {TYPE})


def test_many_triples_are_looked_up_in_another_way_with_the_same_result(reasoner, monkeypatch):
    groups = [(TYPE, *MANY, ABSENT, (NEW, v.RDF_TYPE, v.dm("Cup")))]
    one_by_one = preconditions.find_asserted(reasoner, groups)
    assert not preconditions.is_large_share(groups, reasoner)
    monkeypatch.setattr(preconditions, "_FEW_AT_ALL", 1)
    assert preconditions.is_large_share(groups, reasoner)
    assert preconditions.find_asserted(reasoner, groups) == one_by_one
