from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import pack, unpack
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.test_reasoner import BASE, asserted_in


def test_unpacked_facts_equal_the_closure():
    back = unpack(pack(BASE))
    assert list(back.facts.items()) == list(BASE.facts.items())
    for fact in BASE.facts:
        assert list(back.match(fact[0])) == list(BASE.match(fact[0]))
        assert back.leaves(fact) == BASE.leaves(fact)


def test_a_reasoner_with_unpacked_facts_infers_and_explains_the_same():
    tbox, abox = asserted_in(BASE), triples(":a a :C ; :q :b ; :tra :c . :c :tra :d .")
    one, other = Reasoner(tbox), Reasoner(tbox, closed=unpack(pack(BASE)))
    for reasoner in (one, other):
        reasoner.apply(insert=abox)
    assert set(other.asserted()) == set(one.asserted())
    inferred = set(one.inferred())
    assert set(other.inferred()) == inferred
    for fact in inferred:
        assert other.explain(fact) == one.explain(fact)
