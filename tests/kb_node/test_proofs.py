import pytest
from msgspec import structs

from semmap.nodes.kb_node import proofs
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner, explanations, refute
from semmap.ontology import vocabulary as v
from semmap.schemas import codec, errors
from semmap.schemas import explanations as wire

CUP, DISH, FOOD = "<urn:Cup>", "<urn:Dish>", "<urn:Food>"
TBOX = [(CUP, v.RDFS_SUB_CLASS_OF, DISH), (DISH, "<http://www.w3.org/2002/07/owl#disjointWith>", FOOD)]
CUP1 = ("<urn:cup1>", v.RDF_TYPE, CUP)
FOOD1 = ("<urn:cup1>", v.RDF_TYPE, FOOD)


@pytest.fixture
def reasoner():
    return Reasoner([*TBOX, CUP1])


def crossed(message):
    return codec.decode(codec.encode(message), type(message))


@pytest.mark.parametrize(
    ("ours", "theirs"), [(explanations.Step, wire.Step), (explanations.Explanation, wire.Explanation)]
)
def test_both_classes_have_the_same_fields(ours, theirs):
    only_of_the_message = [field for field in theirs.__struct_fields__ if field not in ours.__struct_fields__]
    assert only_of_the_message == (["computed"] if theirs is wire.Explanation else [])
    assert ours.__struct_fields__ == theirs.__struct_fields__[: len(ours.__struct_fields__)]
    assert ours.__struct_defaults__ == theirs.__struct_defaults__[: len(ours.__struct_defaults__)]


def test_a_proof_is_complete_after_encoding(reasoner):
    proof = reasoner.explain(("<urn:cup1>", v.RDF_TYPE, DISH))
    arrived = crossed(proofs.to_message(proof))
    assert proof.steps
    assert isinstance(arrived, wire.Explanation)
    assert [structs.asdict(step) for step in arrived.steps] == [structs.asdict(step) for step in proof.steps]
    rest = [field for field in proof.__struct_fields__ if field != "steps"]
    assert [getattr(arrived, field) for field in rest] == [getattr(proof, field) for field in rest]


@pytest.mark.parametrize(
    ("about", "first"),
    [
        ([], "[1]"),
        ([("<urn:cup7>", "<urn:at>", "_:f19b")], "[1] (at of cup7)"),
        ([("<urn:a1>", "<urn:at>", "_:f19b"), ("_:x", "<urn:at>", "_:f19b")], "[1]"),
    ],
)
def test_nameless_individuals_are_numbered_in_texts(about, first):
    text = "_:f19b has x 1 (asserted), a1 has position _:c3-d.e (asserted), and _:f19b is one."
    assert proofs.number_nameless(text, about) == (
        f"{first} has x 1 (asserted), a1 has position [2] (asserted), and [1] is one."
    )


def test_a_refutation_keeps_its_assumption(reasoner):
    assert crossed(proofs.to_message(refute(reasoner, FOOD1))).supposed == FOOD1


@pytest.mark.parametrize(("of", "beginning"), [("", ""), ("the TBox", "the TBox is inconsistent: ")])
def test_an_error_has_the_reason(reasoner, of, beginning):
    with pytest.raises(Inconsistent) as found:
        reasoner.apply(insert=[FOOD1])
    refusal = proofs.to_error(found.value, of=of)
    assert isinstance(refusal, errors.Inconsistent)
    assert refusal.text == beginning + found.value.explanation.text
    assert refusal.explanation == proofs.to_message(found.value.explanation)
