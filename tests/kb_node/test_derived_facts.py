"""Computed facts that are maintained commit by commit equal those computed from scratch."""

from unittest import mock

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.derived_facts import DerivedFacts
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.fastpaths import paths
from semmap.nodes.kb_node.sparql.triples.consequences import Consequences, inferred
from semmap.nodes.kb_node.sparql.triples.dataset import ASSERTED, DENIED, INFERRED, Dataset, Delta
from tests.depth import tries
from tests.kb_node.reasoner import graphs
from tests.kb_node.relations.entities import thing

NAMES = ["room1", "flat1", "shelf1", "cup1", "cup2", "book1"]
TBOX = graphs.triples("""
dm:Cup a owl:Class ; owl:disjointWith dm:Kitchen . dm:Kitchen a owl:Class . dm:Shelf a owl:Class .
dm:Laden a owl:Class ; owl:onProperty dm:supports ; owl:someValuesFrom dm:Cup .
dm:Barred a owl:Class ; owl:onProperty dm:supports ; owl:maxCardinality 1 .
dm:isOn a owl:ObjectProperty , owl:AsymmetricProperty ; owl:inverseOf dm:supports ;
    owl:propertyDisjointWith dm:isInside .
dm:supports a owl:ObjectProperty . dm:isInside a owl:ObjectProperty ; owl:inverseOf dm:holds .
dm:holds a owl:ObjectProperty . dm:contains a owl:ObjectProperty .
dm:isLocatedIn a owl:ObjectProperty ; owl:inverseOf dm:contains ; rdfs:range dm:Kitchen ;
    owl:propertyChainAxiom ( dm:isOn dm:isLocatedIn ) .
:cup1 owl:differentFrom :cup2 , :book1 . :cup2 owl:differentFrom :book1 .
""")
SIZES = {"room": (5.0, 5.0, 2.5), "flat": (9.0, 9.0, 2.5), "shelf": (1.0, 1.0, 0.75)}
TOP = 0.75
ON = graphs.triple(":cup1 dm:isOn :shelf1")
IN = graphs.triple(":cup1 dm:isLocatedIn :room1")


def placed(name, x, z=0.0):
    place = name.startswith(("room", "flat"))
    size = SIZES.get(name[:-1], (0.1, 0.1, 0.1))
    entity = thing(name, None if x is None else (x, 0.0, z), size=size, place=place, model="a box")
    return type(entity)(
        **{field: getattr(entity, field) for field in entity.__struct_fields__}
        | {"iri": graphs.triple(f":{name} a dm:Cup")[0][1:-1]}
    )


ROOM, SHELF = placed("room1", 0.0), placed("shelf1", 0.0)
HERE, AWAY = placed("cup1", 0.0, TOP), placed("cup1", 20.0, TOP)


class Home:
    """A reasoner with its derived facts and the SPARQL dataset; commits go to all of them."""

    def __init__(self, *entities, said=""):
        self.there = {}
        self.said = {}
        self.reasoner = Reasoner(TBOX)
        self.derived_facts = DerivedFacts(self.reasoner)
        self.dataset = Dataset(0, TBOX)
        self.consequences = Consequences(TBOX, self.dataset)
        self.commit(graphs.triples(said), (), entities)

    def commit(self, insert=(), delete=(), moved=(), removed=()):
        """Commit, and return whether it was accepted."""
        insert = tuple(t for t in dict.fromkeys(insert) if t not in self.said)
        delete = tuple(t for t in dict.fromkeys(delete) if t in self.said and t not in insert)
        self.derived_facts.begin()
        try:
            self.derived_facts.change(delete, insert)
        except Inconsistent:
            return False
        self.derived_facts.follow(moved, removed, self.there.get, delete, insert)
        self.there.update((entity.name, entity) for entity in moved)
        for name in removed:
            self.there.pop(name, None)
        self.said = {t: None for t in self.said if t not in delete} | dict.fromkeys(insert)
        delta = Delta(seq=self.dataset.seq + 1, retracted=delete, inserted=insert)
        before = self.seen(ASSERTED) | self.seen(INFERRED)
        delta = self.consequences.after(delta, self.derived_facts.derived_changes)
        self.dataset.apply(delta)
        assert before ^ (self.seen(ASSERTED) | self.seen(INFERRED)) <= set(delta.everything)
        return True

    def seen(self, graph):
        found = self.dataset.store.quads_for_pattern(None, None, None, graph)
        return {(str(q.subject), str(q.predicate), str(q.object)) for q in found}

    def state(self):
        return (
            set(self.reasoner.given()),
            set(self.reasoner.suppressed()),
            set(self.derived_facts.suppressed),
            set(self.reasoner.inferred()),
            {name: self.reasoner.types(graphs.triple(f":{name} a dm:Cup")[0]) for name in NAMES},
        )

    def from_nothing(self):
        """Return the state of a new map with the present assertions."""
        fresh = Home.__new__(Home)
        fresh.reasoner = Reasoner(TBOX)
        fresh.derived_facts = DerivedFacts(fresh.reasoner)
        fresh.derived_facts.change((), sorted(self.said), lenient=True)
        fresh.derived_facts.fill(self.there)
        return fresh.state()

    def holds(self, triple):
        return self.reasoner.holds(triple)


SAID = st.one_of(
    st.builds(
        lambda s, c: f":{s} a dm:{c}",
        st.sampled_from(NAMES),
        st.sampled_from(["Cup", "Kitchen", "Shelf", "Barred"]),
    ),
    st.builds(
        lambda s, p, o: f":{s} dm:{p} :{o}",
        st.sampled_from(NAMES),
        st.sampled_from(["isOn", "supports", "isInside", "isLocatedIn", "contains"]),
        st.sampled_from(NAMES),
    ),
).map(graphs.triple)
PLACED = st.builds(
    placed,
    st.sampled_from(NAMES),
    st.sampled_from([None, 0.0, 0.0, 0.3, 4.0]),
    st.sampled_from([0.0, TOP, TOP + 0.02, TOP + 0.15]),
)
COMMITS = st.lists(
    st.tuples(
        st.lists(SAID, max_size=3),
        st.lists(SAID, max_size=2),
        st.lists(PLACED, max_size=4, unique_by=lambda entity: entity.name),
        st.lists(st.sampled_from(NAMES), max_size=1),
    ),
    max_size=10,
)
SETTINGS = settings(deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


@settings(SETTINGS, max_examples=tries(80))
@given(COMMITS, st.sampled_from([1, paths.MANY]))
def test_incremental_results_equal_those_from_scratch(commits, many):
    with mock.patch.object(paths, "MANY", many):
        follow_from_nothing(commits)


def follow_from_nothing(commits):
    home = Home()
    for insert, delete, moved, removed in commits:
        before = home.state()
        removed = [name for name in removed if name not in {entity.name for entity in moved}]
        if not home.commit(insert, delete, moved, removed):
            assert home.state() == before
            continue
        assert home.state() == home.from_nothing()
        assert home.seen(INFERRED) == set(inferred(home.reasoner))
        assert home.seen(DENIED) == set(home.reasoner.suppressed())
        assert home.dataset.denials == len(home.seen(DENIED))
        assert home.seen(ASSERTED) | home.seen(DENIED) == {*home.said, *TBOX}


@settings(SETTINGS, max_examples=tries(40))
@given(COMMITS, COMMITS)
def test_a_reverted_commit_restores_the_state(first, second):
    home = Home()
    for insert, delete, moved, removed in first:
        home.commit(insert, delete, moved, [n for n in removed if n not in {e.name for e in moved}])
    for insert, delete, moved, removed in second:
        before, there, said = home.state(), dict(home.there), dict(home.said)
        removed = [name for name in removed if name not in {entity.name for entity in moved}]
        if home.commit(insert, delete, moved, removed):
            back = [there[n] for n in {*removed, *(e.name for e in moved)} if n in there]
            gone = [entity.name for entity in moved if entity.name not in there]
            is_taken = home.commit(said.keys() - home.said.keys(), home.said.keys() - said.keys(), back, gone)
            if is_taken:
                assert home.state() == before
            else:  # the assertions contradicted one another, and were suppressed before
                assert not before[2].isdisjoint(said)
                return


def test_computed_facts_have_inferences():
    home = Home(ROOM, SHELF, HERE, said=":cup1 a dm:Cup .")
    assert home.reasoner.is_computed(ON)
    assert home.holds(graphs.triple(":shelf1 a dm:Laden"))
    assert {ON, IN} <= set(home.reasoner.inferred())
    assert not any(home.reasoner.asserted(*ON))
    home.commit(moved=[AWAY])
    assert not home.holds(ON)
    assert not home.holds(graphs.triple(":shelf1 a dm:Laden"))


def test_a_move_without_changed_relations_does_not_change_the_reasoner(monkeypatch):
    home = Home(ROOM, SHELF, HERE)
    asked = []
    monkeypatch.setattr(home.reasoner, "update_computed", lambda **kinds: asked.append(kinds))
    home.derived_facts.follow([placed("cup1", 0.1, TOP)], (), home.there.get, (), ())
    assert not asked


def test_assertions_that_the_geometry_denies_stay_asserted():
    home = Home(ROOM, SHELF, AWAY, said=":cup1 dm:isOn :shelf1 .")
    assert not home.holds(ON)
    assert not home.holds(IN)
    assert any(home.reasoner.asserted(*ON))
    home.commit(moved=[HERE])
    assert home.holds(IN)
    assert not set(home.reasoner.suppressed())
    home.commit(moved=[AWAY])
    home.commit(delete=[ON])
    assert not any(home.reasoner.asserted(*ON))
    assert not set(home.reasoner.suppressed())


def test_a_retracted_fact_may_still_be_computed():
    home = Home(ROOM, SHELF, HERE, said=":cup1 dm:isOn :shelf1 .")
    assert not home.reasoner.is_computed(ON)
    home.commit(delete=[ON])
    assert home.reasoner.is_computed(ON)


def test_computed_facts_never_reject_a_commit():
    home = Home(ROOM, SHELF, HERE)
    assert home.commit(graphs.triples(":room1 a dm:Cup ."))
    assert not home.holds(IN)
    assert home.holds(ON)
    assert set(home.derived_facts.suppressed) == {IN, graphs.triple(":shelf1 dm:isLocatedIn :room1")}
    assert "room1" in home.derived_facts.suppressed[IN].text
    home.commit(delete=graphs.triples(":room1 a dm:Cup ."))
    assert home.holds(IN)
    assert not home.derived_facts.suppressed


def test_of_two_contradicting_facts_the_last_is_suppressed_in_any_order():
    cups = [placed("cup1", 0.0, TOP), placed("cup2", 0.3, TOP)]
    for order in (cups, cups[::-1]):
        home = Home(ROOM, SHELF, said=":shelf1 a dm:Barred .")
        for cup in order:
            home.commit(moved=[cup])
        assert set(home.derived_facts.suppressed) == {graphs.triple(":cup2 dm:isOn :shelf1")}
        home.commit(moved=[placed("cup1", 20.0)])
        assert home.holds(graphs.triple(":cup2 dm:isOn :shelf1"))


def test_a_restored_assertion_that_contradicts_newer_ones_is_suppressed():
    home = Home(ROOM, SHELF, AWAY, said=":cup1 dm:isOn :shelf1 .")
    inside = graphs.triple(":cup1 dm:isInside :shelf1")
    assert home.commit([inside])
    assert set(home.reasoner.suppressed()) == {ON, inside}
    home.commit(moved=[HERE])
    assert home.state() == home.from_nothing()


def test_an_entity_that_is_located_in_itself_is_denied_while_it_exists():
    home = Home(said=":flat1 dm:isInside :flat1 .")
    home.commit(moved=[placed("flat1", None)])
    assert set(home.reasoner.suppressed()) == set(graphs.triples(":flat1 dm:isInside :flat1 ."))
    home.commit(removed=["flat1"])
    assert not set(home.reasoner.suppressed())
    assert home.state() == home.from_nothing()
