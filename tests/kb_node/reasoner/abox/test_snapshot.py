"""A reasoner restored from columns behaves like the original, also after further changes."""

import random

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.swrl import graph
from tests.kb_node.reasoner.test_worlds import check, refused
from tests.kb_node.reasoner.worlds import AXIOMS, NOMINALS, TRANSITIVE, TYPES, World

SCHEMA = triples(
    """
    :Room rdfs:subClassOf :Place . :Cup rdfs:subClassOf [ owl:onProperty :hasMaker ; owl:hasValue :potter ] .
    :isIn rdfs:domain :Thing ; rdfs:range :Place . :isOn rdfs:subPropertyOf :isAt .
    :isAt owl:propertyChainAxiom ( :isOn :isIn ) . :Room owl:disjointWith :Cup .
    """
)
FACTS = triples(
    """
    :cup a :Cup ; :isOn :table ; :weighs 0.2 . :table :isIn :kitchen . :kitchen a :Room .
    :spoon :unheard :cup . :x a :Unheard .
    """
)


def restored(reasoner, random_):
    """Return a restored reasoner with the same schema in another order; None if that is not possible."""
    columns = reasoner.columns()
    schema = [fact for fact in reasoner.asserted() if is_schema(fact)]
    random_.shuffle(schema)
    other = Reasoner(schema)
    before = sorted(other.asserted())
    if columns is None or not other.fill(columns):
        assert sorted(other.asserted()) == before
        return None
    assert {*columns.triples(), *schema} == set(reasoner.asserted())
    return other


@pytest.mark.parametrize(
    "theme", [AXIOMS, NOMINALS, TRANSITIVE, TYPES], ids=["everything", "nominals", "transitive", "types"]
)
@pytest.mark.parametrize("seed", range(6))
def test_a_restored_reasoner_behaves_like_the_original(seed, theme):
    random_, world = random.Random(seed), None
    while world is None or Closure(world.asserted).clash is not None:
        world = World(random_.random(), theme, without=("sameAs",))
    reasoner = Reasoner(world.asserted)
    for _ in range(12):
        change = world.change()
        if refused(reasoner, change) is None:
            world.accept(change)
        if (other := restored(reasoner, random_)) is not None:
            assert len(other) == len(reasoner)
            reasoner = other
            check(reasoner, Closure(world.asserted), world.asserted, random_)


def test_derived_edges_are_removed_with_their_reasons():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=FACTS)
    filled = restored(reasoner, random.Random(1))
    (at_kitchen,) = triples(":cup :isAt :kitchen .")
    assert filled.holds(at_kitchen)
    assert filled.explain(at_kitchen).text == reasoner.explain(at_kitchen).text
    filled.apply(delete=triples(":table :isIn :kitchen ."))
    assert not filled.holds(at_kitchen)
    with pytest.raises(Inconsistent):
        filled.apply(insert=triples(":kitchen a :Cup ."))


def test_columns_do_not_change_with_the_reasoner():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=FACTS)
    columns = reasoner.columns()
    before = sorted(columns.triples())
    reasoner.apply(delete=FACTS)
    assert sorted(columns.triples()) == before
    filled = Reasoner(SCHEMA)
    assert filled.fill(columns)
    filled.apply(delete=FACTS)
    assert sorted(columns.triples()) == before


def test_columns_of_another_schema_are_rejected():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=FACTS)
    columns = reasoner.columns()
    other = Reasoner(SCHEMA[1:])
    assert not other.fill(columns)
    assert sorted(other.asserted()) == sorted(SCHEMA[1:])


def test_columns_with_unknown_classes_are_rejected():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=FACTS)
    columns = reasoner.columns()
    columns.classes[0] = "_:unknown"
    assert not Reasoner(SCHEMA).fill(columns)


def test_equal_nodes_are_not_supported():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=triples(":cup owl:sameAs :mug ."))
    assert reasoner.columns() is None


def test_a_reasoner_with_rules_is_restored_unless_a_rule_has_concluded_something():
    rules = graph("Cup(x), isNear(x, y) -> Full(y)")
    reasoner = Reasoner([*SCHEMA, *rules])
    reasoner.apply(insert=FACTS)
    filled = Reasoner([*SCHEMA, *rules])
    assert filled.fill(reasoner.columns())
    filled.apply(insert=triples(":cup :isNear :table ."))
    assert filled.holds(triples(":table a :Full .")[0])
    assert filled.columns() is None
