"""A reasoner that was filled from columns is as good as the one that they are of, also from then on."""

import random

import pytest

from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from tests.kb_node.reasoner.graphs import triples
from tests.kb_node.reasoner.test_worlds import check, refused
from tests.kb_node.reasoner.worlds import AXIOMS, NOMINALS, TRANSITIVE, World

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
    """Another one with the same schema, numbered otherwise, that was filled; None if it cannot be."""
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
    "theme", [AXIOMS, NOMINALS, TRANSITIVE], ids=["everything", "nominals", "transitive"]
)
@pytest.mark.parametrize("seed", range(8))
def test_a_filled_reasoner_goes_on_like_the_one_before(seed, theme):
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


def test_derived_edges_go_with_what_they_rest_on():
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


def test_the_columns_stay_as_they_were():
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


def test_nothing_is_filled_under_another_schema():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=FACTS)
    columns = reasoner.columns()
    other = Reasoner(SCHEMA[1:])
    assert not other.fill(columns)
    assert sorted(other.asserted()) == sorted(SCHEMA[1:])


def test_nothing_is_filled_that_only_another_schema_has():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=FACTS)
    columns = reasoner.columns()
    columns.classes[0] = "_:of nobody's"
    assert not Reasoner(SCHEMA).fill(columns)


def test_what_makes_nodes_the_same_is_not_kept():
    reasoner = Reasoner(SCHEMA)
    reasoner.apply(insert=triples(":cup owl:sameAs :mug ."))
    assert reasoner.columns() is None
