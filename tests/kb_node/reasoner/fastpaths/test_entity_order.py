import random

from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.fastpaths.entity_order import order_by_entity
from semmap.nodes.kb_node.reasoner.fastpaths.shapes import Shapes
from tests.kb_node.reasoner.graphs import triple, triples

TERMS = st.sampled_from(["<a:a>", "<a:b>", "<a:c>", "<a:d>", "_:e"])
PREDICATES = st.sampled_from([triple(":a a :b")[1], "<a:p>", "<a:q>"])
TRIPLES = st.tuples(TERMS, PREDICATES, st.one_of(TERMS, st.just('"1"')))


@given(st.lists(TRIPLES, max_size=30))
def test_no_triple_is_lost_or_duplicated(given_triples):
    assert sorted(order_by_entity(given_triples)) == sorted(given_triples)


def test_an_individual_follows_its_only_referrer_and_precedes_several():
    facts = triples(
        ":cup1 a :Cup ; :at :place1 ; :in :room . :cup2 a :Cup ; :in :room . :place1 :x 1 . :room a :Room ."
    )
    random.Random(1).shuffle(facts)
    order = list(dict.fromkeys(s.rpartition("/")[2].rstrip(">") for s, _, _ in order_by_entity(facts)))
    assert order.index("room") < min(order.index("cup1"), order.index("cup2"))
    assert order.index("place1") == order.index("cup1") + 1


def test_a_map_in_any_order_is_stored_by_columns(monkeypatch):
    """`check` loads the triples in the order of the store."""
    tbox = ":Cup rdfs:subClassOf :Thing . :at rdfs:range :Place . "
    said = "".join(
        f":cup{i} a :Cup ; :at :place{i} ; :in :room{i % 3} . :place{i} :x {i}.5 . " for i in range(200)
    )
    facts = triples(tbox + said + ":room0 a :Room . :room1 a :Room . :room2 a :Room .")
    sizes, write_all = [], Shapes.write_all
    monkeypatch.setattr(Shapes, "write_all", lambda *args: sizes.append(write_all(*args)) or sizes[-1])
    in_order = Reasoner(facts)
    random.Random(1).shuffle(facts)
    sizes.clear()
    shuffled = Reasoner(facts, scattered=True)
    assert max(sum(len(list(runs.rows())) for runs in alike) for alike, _ in sizes) > 100
    assert set(shuffled.asserted()) == set(in_order.asserted()) == set(facts)
    assert set(shuffled.inferred()) == set(in_order.inferred())
