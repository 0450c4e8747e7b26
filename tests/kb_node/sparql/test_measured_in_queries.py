"""Relations measured on demand, in queries and standing queries."""

import queue
import random

import pytest

from semmap.nodes.kb_node.relations.facts.pair_facts import measure_pair
from semmap.nodes.kb_node.relations.relation_reports import explain_relation
from semmap.nodes.kb_node.sparql.protocol import Placements
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.ontology import vocabulary as v
from semmap.ontology.model_shapes import ConvexPart, ModelShape, WorldShapes
from semmap.schemas.commands import Sparql, Watch
from semmap.schemas.commits import Edit, Transaction

WAIT_S = 60.0
ALL = "SELECT ?x ?y {{ ?x dm:{} ?y }}"
NAMES = ("isNear", "isNextTo", "touches", "isUnder", "isAbove")


@pytest.fixture
def news():
    return queue.SimpleQueue()


def started(flat, news):
    return SparqlService(
        lambda: flat.reasoner.asserted(),
        news.put,
        derived_changes=flat.all_derived,
        placements=lambda: Placements(placed=flat.placed(), limits=flat.classes.limits),
        closed=lambda: flat.reasoner.closed,
    )


@pytest.fixture
def service(flat, news):
    made = started(flat, news)
    yield made
    made.close()


@pytest.fixture(scope="module")
def services():
    """The service that the tests share that only read, and its map."""
    kept = []
    yield kept
    for _, made in kept:
        made.close()


@pytest.fixture
def reading(flat, services):
    """A service for tests that only read. A start takes a second of processor time."""
    if not services or services[-1][0] is not flat:
        services.append((flat, started(flat, queue.SimpleQueue())))
    return services[-1][1]


def told(flat, wanted):
    """Return the pairs of IRIs with the relation by `semmap relations`, and those inferred from it."""
    space, found = flat.places.space(), set()
    iris = {entity.name: v.iri(entity.iri) for entity in flat.entities()}
    things = [solid for solid in space.solids.values() if not solid.is_place]
    with space.caching():
        for solid in things:
            for other in space.around(solid, space.limits.near_most_m):
                if not other.is_place and any(
                    made.holds for _, made in measure_pair(space, solid, other, frozenset({wanted}))
                ):
                    found.add((iris[solid.name], iris[other.name]))
    if wanted not in ("isUnder", "isAbove"):
        found |= {(o, s) for s, o in found}
    return found | {(s, o) for s, _, o in flat.reasoner.inferred(None, v.dm(wanted), None)}


def mirrored(flat, wanted):
    if wanted not in ("isUnder", "isAbove"):
        return told(flat, wanted)
    other = "isAbove" if wanted == "isUnder" else "isUnder"
    return told(flat, wanted) | {(o, s) for s, o in told(flat, other)}


def ask(service, flat, query):
    rows = service.ask(Sparql(query=query, inferred=True), flat.seq).result(WAIT_S).rows
    assert len(set(rows)) == len(rows)  # no triple is in two graphs
    return set(rows)


def stir(flat, service, dice, number, things, spots):
    name, (x, y, z) = dice.choice(things), dice.choice(spots)
    at = (x + dice.choice([0.0, 0.0, 0.02, 0.3]), y, z)
    commit = flat.commit(Transaction(id=f"c{number}", source="operator", edit=(Edit(name=name, at=at),)))
    if commit is not None:
        service.follow(commit, flat.take_derived_changes(commit))


def movable(flat):
    found = [e for e in flat.entities() if e.pose is not None and not e.place and not e.fixed]
    return [e.name for e in found], [e.pose.position_m for e in found] + [(2.0, 2.0, 0.0)]


@pytest.mark.parametrize("name", NAMES)
def test_a_query_has_the_rows_of_relations(flat, reading, name):
    rows = ask(reading, flat, ALL.format(name))
    assert rows == mirrored(flat, name) != set()
    space, by_iri = flat.places.space(), {v.iri(entity.iri): entity.name for entity in flat.entities()}
    for s, o in list(rows)[:20]:
        if name != "touches":  # an object on another touches it, too, possibly with a gap
            assert explain_relation(space, by_iri[s], name, by_iri[o]).holds


def test_queries_measure_the_shapes_of_the_bodies_of_a_world(flat, service):
    """The process for SPARQL is another one, and may have been started before the shapes arrived."""
    before = ask(service, flat, ALL.format("isNextTo"))
    posts = {}
    for entity in flat.entities():
        if not entity.place and entity.pose is not None and entity.size_m is not None:
            x, y, z = entity.size_m
            axes = ((x / 20, 0.0, 0.0), (0.0, y / 20, 0.0), (0.0, 0.0, z / 2))
            part = ConvexPart(centre=(0.0, 0.0, z / 2), straight=axes)
            posts[entity.name] = ModelShape(size_m=entity.size_m, parts=(part,), turns=False)
    try:
        assert flat.exchange_shapes(WorldShapes.of(posts))
        service.reload()
        assert ask(service, flat, ALL.format("isNextTo")) == mirrored(flat, "isNextTo") != before
    finally:
        flat.exchange_shapes(WorldShapes())


def test_measurements_are_up_to_date_after_each_commit(flat, service):
    dice, (things, spots) = random.Random(3), movable(flat)
    for number in range(8):
        stir(flat, service, dice, number, things, spots)
        for name in NAMES:
            assert ask(service, flat, ALL.format(name)) == mirrored(flat, name), name


@pytest.mark.parametrize("name", ["isNear", "isUnder"])
def test_for_one_object_no_others_are_measured(flat, service, name):
    about = v.entity_iri("counter1")
    for number in range(3):
        there = {(s,) for s, o in mirrored(flat, name) if o == about}
        assert ask(service, flat, f"SELECT ?x {{ ?x dm:{name} :counter1 }}") == there
        stir(flat, service, random.Random(number), number, *movable(flat))


def test_a_variable_predicate_includes_measured_relations(flat, reading):
    rows = ask(reading, flat, "SELECT DISTINCT ?p ?o { :milk1 ?p ?o }")
    assert (
        {o for p, o in rows if p == v.dm("isNear")}
        == {o for s, o in told(flat, "isNear") if s == v.entity_iri("milk1")}
        != set()
    )


def test_without_inferred_there_are_no_measured_relations(flat, reading):
    assert ask(reading, flat, ALL.format("isNear"))
    asserted = reading.ask(Sparql(query=ALL.format("isNear")), flat.seq).result(WAIT_S)
    assert asserted.rows == ()


def test_another_query_does_not_include_them(flat, service):
    counted = "SELECT ?x { ?x a dm:Cup }"
    before = ask(service, flat, counted)
    ask(service, flat, ALL.format("isNear"))
    assert ask(service, flat, counted) == before


def test_nothing_is_measured_for_queries_that_do_not_need_it(flat, service):
    ask(service, flat, "SELECT ?x ?y { ?x dm:isOn ?y . ?y a dm:Table }")
    assert not service._measures


def test_an_asserted_relation_occurs_once(flat, service):
    near = next(iter(sorted(told(flat, "isNear"))))
    ask(service, flat, ALL.format("isNear"))
    triple = (near[0], v.dm("isNear"), near[1])
    for change in ({"insert": (triple,)}, {"retract": (triple,)}):
        commit = flat.commit(Transaction(id=str(change), source="operator", **change))
        service.follow(commit, flat.take_derived_changes(commit))
        assert near in ask(service, flat, ALL.format("isNear"))


def test_a_removed_entity_has_no_relations(flat, service):
    ask(service, flat, ALL.format("isNear"))
    commit = flat.commit(Transaction(id="r", source="operator", remove=("milk1",)))
    service.follow(commit, flat.take_derived_changes(commit))
    assert ask(service, flat, ALL.format("isNear")) == told(flat, "isNear")


@pytest.mark.parametrize("commits", [8, pytest.param(100, marks=pytest.mark.long)])
def test_standing_queries_have_the_correct_rows(flat, service, news, commits):
    dice, (things, spots) = random.Random(15), movable(flat)
    rows, truth = {}, {}
    for name in NAMES:
        begun = service.ask(Watch(query=ALL.format(name), inferred=True, lease=600.0), flat.seq)
        rows[begun.result(WAIT_S).watch] = name, set(begun.result().rows)
        assert set(begun.result().rows) == mirrored(flat, name)
    for number in range(commits):
        stir(flat, service, dice, number, things, spots)
        truth[flat.seq] = {name: mirrored(flat, name) for name in NAMES}
    service.ask(Watch(query="SELECT ?x { ?x a dm:Cup }"), flat.seq).result(WAIT_S)  # all evaluations are done
    changes = 0
    while not news.empty():
        change = news.get().rows
        if change is None or change.watch not in rows:
            continue
        name, before = rows[change.watch]
        assert not before.intersection(change.appeared)
        rows[change.watch] = name, before.difference(change.disappeared).union(change.appeared)
        assert rows[change.watch][1] == truth[change.seq][name]
        changes += 1
    assert changes > commits / 2
    for name, now in rows.values():
        assert now == truth[flat.seq][name]
