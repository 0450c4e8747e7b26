"""Preconditions of transactions, checked against the map."""

from contextlib import nullcontext
from types import SimpleNamespace

import pytest

from semmap.nodes.kb_node import preconditions
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Reserved
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


@pytest.mark.parametrize(
    ("triple", "is_rejected"),
    [
        ((CUP, v.dm("isGraspedBy"), NEW), True),
        ((NEW, v.dm("grasps"), CUP), True),
        ((CUP, v.dm("isPinchedBy"), NEW), True),  # a subproperty of an equivalent one
        ((NEW, v.dm("pinches"), CUP), True),  # and its inverse
        ((NEW, v.dm("isPinchedBy"), CUP), False),  # of another entity
        ((CUP, v.dm("touches"), NEW), False),  # wider than the reserved one
    ],
)
def test_reserved_properties_are_neither_stated_nor_implied(triple, is_rejected):
    sub, same = v.RDFS_SUB_PROPERTY_OF, v.iri(v.OWL + "equivalentProperty")
    reasoner = Reasoner(
        [
            (v.dm("isGraspedBy"), sub, v.dm("touches")),
            (v.dm("grasps"), v.OWL_INVERSE_OF, v.dm("isGraspedBy")),
            (v.dm("isHeldBy"), same, v.dm("isGraspedBy")),
            (v.dm("isPinchedBy"), sub, v.dm("isHeldBy")),
            (v.dm("isPinchedBy"), v.OWL_INVERSE_OF, v.dm("pinches")),
        ]
    )
    reserved = Reserved(names=("cup1",), properties=("isGraspedBy",), why="is fixed; see {name}")
    cup = SimpleNamespace(iri=v.bare(CUP))
    expected = pytest.raises(errors.Refused, match=r"^isGraspedBy of cup1 is fixed; see cup1$")
    with expected if is_rejected else nullcontext():
        preconditions.require_unreserved(
            transaction(1, reserved=(reserved,)), {"cup1": cup}, [triple], reasoner
        )
