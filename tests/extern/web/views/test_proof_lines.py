import pytest

from semmap.nodes.extern.web.views.proof_lines import proof_lines, words_of
from semmap.nodes.kb_node import proofs
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import PropertyInfo
from semmap.schemas.explanations import Explanation
from tests.extern.web.views.sample_maps import class_, fact

SUB = "<http://www.w3.org/2000/01/rdf-schema#subClassOf>"
DISJOINT = "<http://www.w3.org/2002/07/owl#disjointWith>"
IS_ON = PropertyInfo(
    name="isOn", iri=f"{v.TBOX}isOn", kind="object", functional=False, domain=(), range=(),
    labels={"en": "is on", "it": "è su"}, values={}
)  # fmt: skip
WORDS = words_of([class_("Beer", labels={"en": "beer"}), class_("Drink", labels={"it": "bibita"})], [IS_ON])
TBOX = [
    (v.dm("Beer"), SUB, v.dm("Drink")),
    (v.dm("Drink"), SUB, v.dm("Food")),
    (v.dm("Drink"), DISJOINT, v.dm("Chair")),
]


def is_a(name, class_name):
    return (v.entity_iri(name), v.RDF_TYPE, v.dm(class_name))


@pytest.fixture
def reasoner():
    reasoner = Reasoner(TBOX)
    reasoner.apply(insert=[is_a("beer1", "Beer")])
    return reasoner


def shown(explanation):
    return [(line.depth, line.text, line.basis) for line in proof_lines(explanation, WORDS)]


def test_premises_are_below_their_conclusion(reasoner):
    told = shown(proofs.to_message(reasoner.explain(is_a("beer1", "Food"))))
    assert told[0] == (0, "beer1 is a Food", "inferred")
    assert (1, "beer1 is a Drink", "inferred") in told
    assert (2, "beer1 is a beer", "asserted") in told
    assert (2, "every beer is a Drink", "axiom") in told
    assert told.index((1, "beer1 is a Drink", "inferred")) < told.index((1, "every Drink is a Food", "axiom"))


def test_asserted_facts_have_one_line(reasoner):
    told = shown(proofs.to_message(reasoner.explain(is_a("beer1", "Beer"))))
    assert told == [(0, "beer1 is a beer", "asserted")]


def test_contradictions_show_both_facts(reasoner):
    with pytest.raises(Inconsistent) as refused:
        reasoner.apply(insert=[is_a("beer1", "Chair")])
    told = shown(proofs.to_message(refused.value.explanation))
    assert told[0] == (0, "these facts contradict one another", "contradiction")
    assert (1, "beer1 is a Chair", "asserted") in told
    assert (1, "beer1 is a Drink", "inferred") in told


@pytest.mark.parametrize("text", ["milk1 is on counter1: level", "milk1 is located there", ""])
def test_the_message_marks_computed_facts_and_its_text_does_not_matter(text):
    on = fact("milk1", "isOn", "counter1")
    asserted = Explanation(conclusion=on, support=(on,), steps=(), text=text)
    assert shown(asserted) == [(0, "milk1 is on counter1", "asserted")]
    computed = Explanation(conclusion=on, support=(on,), steps=(), text=text, computed=(on,))
    assert shown(computed) == [(0, "milk1 is on counter1", "computed")]
    measured_now = Explanation(conclusion=on, support=(), steps=(), text=text, computed=(on,))
    assert shown(measured_now) == [(0, "milk1 is on counter1", "computed")]


def test_a_measurement_without_triples_is_its_text_only():
    assert shown(Explanation(conclusion=None, support=(), steps=(), text="cup1 leans against wall1")) == []


def test_proofs_without_steps_show_their_support():
    support = ((v.dm("Beer"), SUB, v.dm("Drink")), is_a("beer1", "Beer"))
    explanation = Explanation(conclusion=is_a("beer1", "Food"), support=support, steps=(), text="x")
    assert shown(explanation) == [
        (0, "beer1 is a Food", "inferred"),
        (1, "every beer is a Drink", "axiom"),
        (1, "beer1 is a beer", "asserted"),
    ]
