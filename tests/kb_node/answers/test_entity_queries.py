"""Spatial queries with asserted and inferred facts."""

import pytest

from semmap.nodes.kb_node.answers import answers, entity_queries, questions
from semmap.nodes.kb_node.answers.past import fact_intervals
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import Entities
from semmap.schemas.commands import Could, Explain, Get, Relations
from semmap.schemas.commits import Edit, NewEntity, Transaction
from semmap.schemas.entities import Pose
from semmap.schemas.relations import PHRASES, Where
from tests.kb_node import home


def new_flat(folder, further=b""):
    if further:
        triples = rdf.parse(HOUSEHOLD_TTL.read_bytes() + further, "household.ttl", label_prefix="h")
        made = home.new_map(folder, triples)
    else:
        made = SemanticMap(home.new_household_journal(folder))
    made.commit(home.transaction(1, rdf.parse(FLAT_TTL.read_bytes(), "flat.ttl", label_prefix="f")))
    made.ensure_derived()
    return made


@pytest.fixture(scope="module")
def flat(tmp_path_factory):
    made = new_flat(tmp_path_factory.mktemp("flat"))
    yield made
    home.close(made)


@pytest.fixture
def own(tmp_path):
    """A flat that the test may change."""
    made = new_flat(tmp_path)
    yield made
    home.close(made)


def explain_relation(semantic_map, name, predicate, value, *, negated=False):
    query = Explain(name=name, predicate=predicate, value=value, negated=negated)
    now = entity_queries.CurrentState(semantic_map)
    if (measured := now.explain_measured(query)) is not None:
        return measured
    found = now.explain(query, questions.parse_explain(semantic_map, query))
    return found and found.with_dates(lambda facts: began(semantic_map, facts))


def began(semantic_map, facts):
    journal = semantic_map._journal
    return fact_intervals.look_up_starts(journal, HistoryReader(journal), facts, semantic_map.classes.limits)


def refused(semantic_map, name, predicate, value):
    with pytest.raises(errors.Refused) as caught:
        explain_relation(semantic_map, name, predicate, value)
    return str(caught.value)


@pytest.mark.parametrize("word", ["laptop1", "laptop", "Laptop", "the laptop"])
def test_one_rule_of_names_holds_in_every_query(flat, word):
    now = entity_queries.CurrentState(flat)
    then = entity_queries.PastState(flat, HistoryReader(flat._journal))
    assert now.entity(Get(name=word)).name == then.entity(Get(name=word, as_of=1)).name == "laptop1"
    assert answers.infer(flat, word) == answers.infer(flat, "laptop1")
    text = explain_relation(flat, "laptop1", "isOn", "desk1").text
    assert explain_relation(flat, word, "isOn", "desk1").text == text
    assert explain_relation(flat, word, "isOn", "Desk").text == text
    assert explain_relation(flat, word, "isOn", "the desk").text == text
    assert explain_relation(flat, "desk", "supports", word).text.endswith(text)


@pytest.mark.parametrize("word", ["chair", "Chair", "a chair"])
def test_a_word_for_several_is_rejected_with_at_most_five(flat, word):
    now, past = entity_queries.CurrentState(flat), HistoryReader(flat._journal)
    for ask in (
        lambda: now.entity(Get(name=word)),
        lambda: entity_queries.PastState(flat, past).entity(Get(name=word, as_of=1)),
        lambda: answers.infer(flat, word),
        lambda: explain_relation(flat, "cup1", "isNear", word),
        lambda: explain_relation(flat, word, "isLocatedIn", "kitchen1"),
        lambda: past.resolve(word, past.entities(1)),
    ):
        with pytest.raises(errors.BadRequest, match=r"is ambiguous: .*chair1, chair2, chair3.*; name one"):
            ask()


def test_a_statement_about_an_unknown_entity_is_rejected_as_such(flat):
    with pytest.raises(errors.UnknownName, match="label or class 'tabel1'; did you mean table1"):
        explain_relation(flat, "cup1", "isOn", "tabel1")


def test_a_name_precedes_labels_and_classes_of_others(flat):
    assert flat.resolve("table1").name == "table1"
    assert explain_relation(flat, "Chair", "subClassOf", "Object").text.startswith("every chair")


def test_list_with_on_agrees_with_a_property_path_in_sparql(flat):
    listed = {e.name for e in entity_queries.CurrentState(flat).entities(Entities(where=Where(on="table1")))}
    held = flat.reasoner
    on, inside, table = v.dm("isOn"), v.dm("isInside"), v.iri(flat.entity("table1").iri)
    direct = {s for s, _, _ in held.given(None, on, table)}
    assert v.entity_name(v.iri(flat.entity("apple1").iri)) in listed
    assert v.iri(flat.entity("apple1").iri) not in direct
    waiting, all_on = list(direct), set(direct)
    while waiting:
        lower = waiting.pop()
        above = {s for p in (on, inside) for s, _, _ in held.given(None, p, lower)} - all_on
        all_on |= above
        waiting += above
    assert listed == {v.entity_name(s) for s in all_on}


def test_the_start_is_the_commit_since_which_the_relation_holds(own):
    def change(**what):
        own.commit(Transaction(id=f"c{own.seq}", source="operator", **what))

    def since(name, other, predicate="isOn"):
        return explain_relation(own, name, predicate, other).text.rpartition(" (")[2]

    def put(name, *at):
        change(edit=(Edit(name=name, at=at),))

    assert since("milk1", "counter1") == "since commit 1)"
    change(
        add=(NewEntity(name="cup9", class_iri=v.bare(v.dm("Cup")), pose=Pose(position_m=(8.2, 0.3, 0.9))),)
    )
    put("cup9", 8.1, 0.3, 0.9)
    assert since("cup9", "counter1") == "since commit 2)"
    assert since("cup9", "kitchen1", "isLocatedIn") == "since commit 2)"
    put("cup9", 8.2, 2.2, 0.74)
    put("cup9", 8.2, 0.3, 0.9)
    assert since("cup9", "counter1") == "since commit 5)"
    assert "(since commit 5)" in explain_relation(own, "counter1", "supports", "cup9").text


def test_a_relation_may_start_when_an_object_in_between_is_removed(own):
    def change(**what):
        own.commit(Transaction(id=f"c{own.seq}", source="operator", **what))

    def new(class_, name, size, *at):
        iri = v.bare(v.dm(class_))
        return NewEntity(name=name, class_iri=iri, size=size, pose=Pose(position_m=at))

    change(add=(new("Book", "book9", (0.2, 0.2, 0.02), 8.2, 0.3, 0.9),))
    change(add=(new("Cup", "cup9", (0.08, 0.08, 0.1), 8.2, 0.3, 0.92),))
    assert explain_relation(own, "cup9", "isOn", "book9").text.endswith("(since commit 3)")
    change(remove=("book9",))
    assert explain_relation(own, "cup9", "isOn", "counter1").text.endswith("(since commit 4)")


def test_a_chain_starts_with_the_latest_of_its_steps(tmp_path):
    chain = b"dm:restsOver a owl:ObjectProperty ; owl:propertyChainAxiom ( dm:isOn dm:isOn ) ."
    own = new_flat(tmp_path, chain)
    for seq, (class_, name, size, z) in enumerate(
        (("Book", "book9", (0.2, 0.2, 0.02), 0.9), ("Cup", "cup9", (0.08, 0.08, 0.1), 0.92)), start=2
    ):
        iri, pose = v.bare(v.dm(class_)), Pose(position_m=(8.2, 0.3, z))
        new = NewEntity(name=name, class_iri=iri, size=size, pose=pose)
        own.commit(Transaction(id=f"c{seq}", source="operator", add=(new,)))
    text = explain_relation(own, "cup9", "restsOver", "counter1").text
    assert "over it (since commit 3)" in text
    assert "over it (since commit 2)" in text
    assert text.endswith(". It holds since commit 3")
    home.close(own)


def test_a_negative_answer_explains_the_path(flat):
    text = refused(flat, "apple1", "isOn", "table1")
    assert text == "apple1 is not on table1: it is inside bowl1, which is on table1"
    assert "table1 has no known hollow" in refused(flat, "apple1", "isInside", "table1")
    assert refused(flat, "table1", "supports", "apple1") == text


@pytest.mark.parametrize("relation", PHRASES)
def test_each_relation_is_explained_by_a_measurement(flat, relation):
    answers = []
    for other in ("table1", "chair1", "bowl1"):
        try:
            answers.append(explain_relation(flat, "apple1", relation, other).text)
        except errors.Refused as error:
            answers.append(str(error))
    assert all(answer.startswith("apple1 ") for answer in answers)
    assert not any("nothing excludes" in answer for answer in answers)


def test_explanations_mark_the_facts_that_are_computed(flat):
    located = explain_relation(flat, "book3", "isLocatedIn", "studio1")
    assert located.computed == (located.conclusion,)
    inferred = explain_relation(flat, "book3", "isLocatedIn", "flat1")
    assert inferred.steps
    assert inferred.computed == (located.conclusion,)
    found = entity_queries.CurrentState(flat).relations(Relations(name="bowl1"))
    other = next(r for r in found if r.relation == "isNear" and r.holds)
    near = explain_relation(flat, other.subject, "isNear", other.object)
    assert near.computed == (near.conclusion,)
    asserted = explain_relation(flat, "kitchen1", "isLocatedIn", "flat1")
    assert asserted.computed == ()


def test_a_denied_assertion_is_reported_as_such(flat):
    said = (v.iri(flat.entity("milk1").iri), v.dm("isOn"), v.iri(flat.entity("table1").iri))
    assert "asserted" not in refused(flat, "milk1", "isOn", "table1")
    flat.commit(home.transaction(2, [said]))
    flat.ensure_derived()
    assert "it is asserted, but suppressed" in refused(flat, "milk1", "isOn", "table1")


def test_could_reports_a_geometric_conflict(flat):
    asked = questions.parse_could(flat, Could(name="water1", predicate="isOn", value="chair1"))
    against = entity_queries.CurrentState(flat).describe_conflict(asked.triples[0])
    text = questions.could(flat.reasoner, asked, against=against).text
    assert text.startswith("yes: nothing excludes")
    assert "but according to the poses, it stands" in text


def test_a_negative_answer_explains_the_measurement(flat):
    why_not = explain_relation(flat, "apple1", "isOn", "counter1", negated=True)
    assert why_not.text.startswith("apple1 is not on counter1: ")
    assert why_not.text == refused(flat, "apple1", "isOn", "counter1")
    assert (
        explain_relation(flat, "apple1", "isInside", "bowl1", negated=True) is None
    )  # it does, and a rule states it


def test_the_location_of_a_place_is_asserted_and_has_no_conflict(flat):
    assert "as it stands" not in explain_relation(flat, "kitchen1", "isLocatedIn", "flat1").text


def test_get_reports_the_height_of_an_unsupported_object(own):
    def hovering(name):
        return entity_queries.CurrentState(own).entity(Get(name=name, where=True)).on_nothing

    assert hovering("milk1") == hovering("light1") == hovering("kitchen1") == ""  # lights are fixed
    edit = Edit(name="milk1", at=(2.0, 2.0, 0.42))
    own.commit(Transaction(id="lifted", source="operator", edit=(edit,)))
    text = "milk1 is on nothing: its bottom is 42.0 cm above the floor of livingroom1"
    assert hovering("milk1") == text
    told = [
        r.text for r in entity_queries.CurrentState(own).relations(Relations(name="milk1")) if not r.object
    ]
    assert told == [text]
    assert not entity_queries.CurrentState(own).entity(Get(name="milk1")).on_nothing


def test_get_shows_every_asserted_property_and_the_equal_individuals(semantic_map):
    text = """
        :c a dm:Chair , owl:NamedIndividual ; rdfs:label 'mine' ; rdfs:comment 'old'@en ; dm:isLocatedIn :k .
        :c <http://o.org/serial> '00123' ; <http://o.org/near> :d , :e ; <http://o.org/isLocatedIn> :d .
        :c <http://o.org/grasp> [ <http://o.org/width> 0.05 ; <http://o.org/of> [ <http://o.org/z> true ] ] .
        :c <http://o.org/route> ( :d :e ) ; owl:sameAs <http://o.org/7> . <http://o.org/8> owl:sameAs :c .
        :c dm:hasPosition [ a dm:Coordinates ] . :k a dm:Kitchen . :d a dm:Chair . :e a dm:Chair .
    """
    semantic_map.commit(home.transaction(1, home.turtle(text)))
    now = entity_queries.CurrentState(semantic_map)
    expected = {
        "comment": ("old@en",),
        "isLocatedIn": ("k",),
        "<http://o.org/isLocatedIn>": ("d",),
        "grasp": ("[of [z true], width 0.05]",),
        "near": ("d", "e"),
        "route": ("(d e)",),
        "sameAs": ("_7", "_8"),
        "serial": ("00123",),
    }
    assert now.entity(Get(name="c")).properties == expected
    assert now.entity(Get(name="c", where=True)).properties == expected
    assert now.entity(Get(name="d")).properties == {}


def test_get_ends_with_values_that_contain_themselves(semantic_map):
    text = (
        "_:a <http://o.org/p> _:a , _:b . _:b <http://o.org/p> _:a . :c a dm:Chair ; <http://o.org/p> _:a ."
    )
    endless = f":c <http://o.org/q> _:l . _:l <{v.RDF}first> :c ; <{v.RDF}rest> _:l ."
    semantic_map.commit(home.transaction(1, home.turtle(f"{text} {endless}")))
    shown = entity_queries.CurrentState(semantic_map).entity(Get(name="c")).properties
    assert shown["p"] == ("[p [...], p [p [...]]]",)
    assert shown["q"] == (f"({'c ' * 12}...)",)


@pytest.mark.parametrize("class_name", [None, "Cup", "Location"])
@pytest.mark.parametrize(
    "where", [None, Where(on="table1"), Where(in_="kitchen1"), Where(near="table1", within=1.0)]
)
def test_the_past_is_listed_as_it_was_then(flat, class_name, where):
    now = entity_queries.CurrentState(flat)
    then = entity_queries.PastState(flat, HistoryReader(flat._journal))
    found = [e.name for e in then.entities(Entities(class_=class_name, where=where, as_of=1))]
    assert found == [e.name for e in now.entities(Entities(class_=class_name, where=where))]
    if class_name is None:
        assert found


def test_an_entity_of_the_past_is_described_as_it_was_then(own):
    now = entity_queries.CurrentState(own)
    then = entity_queries.PastState(own, HistoryReader(own._journal))
    names = ("apple1", "table1", "kitchen1", "light1")
    relations = {name: now.relations(Relations(name=name)) for name in names}
    whereabouts = {name: now.entity(Get(name=name, where=True)).whereabouts for name in names}
    assert relations["apple1"]
    assert whereabouts["apple1"]
    edit = Edit(name="apple1", at=(2.0, 2.0, 0.42))
    own.commit(Transaction(id="lifted", source="operator", edit=(edit,)))
    for name in names:
        assert then.relations(Relations(name=name, as_of=1)) == relations[name]
        found = then.entity(Get(name=name, where=True, as_of=1))
        assert (found.whereabouts, found.on_nothing) == (whereabouts[name], "")
        assert then.entity(Get(name=name, as_of=1)).whereabouts == ()
        lifted = then.entity(Get(name=name, where=True, as_of=2)).on_nothing
        assert lifted.startswith("apple1 is on nothing") == (name == "apple1")


def test_a_query_of_the_past_needs_a_time(flat):
    then = entity_queries.PastState(flat, HistoryReader(flat._journal))
    for ask in (
        lambda: then.entities(Entities()),
        lambda: then.entity(Get(name="cup1")),
        lambda: then.relations(Relations(name="cup1")),
    ):
        with pytest.raises(errors.InternalError, match="the query has no time"):
            ask()
    with pytest.raises(errors.UnknownName, match="no entity was named 'cup77' after commit 1"):
        then.entity(Get(name="cup77", as_of=1))


def test_individuals_follow_the_entities_of_a_list(semantic_map):
    text = ":c a dm:Chair ; dm:hasPosition [ a dm:Coordinates ] . :bob a <urn:Person> ; rdfs:label 'Bob' ."
    semantic_map.commit(home.transaction(1, home.turtle(text)))
    now = entity_queries.CurrentState(semantic_map)

    def names(**wanted):
        return [one.name for one in now.entities(Entities(**wanted))]

    assert names() == names(class_="Chair", all=True) == ["c"]
    assert names(all=True) == ["c", "bob"]
    assert names(class_="Person", all=True) == ["bob"]
    for wanted in ({"class_": "Persn"}, {"class_": "Persn", "all": True}, {"class_": "Person"}):
        with pytest.raises(errors.UnknownClass):
            names(**wanted)


def test_a_relation_without_a_property_is_explained_by_its_measurement(tmp_path):
    own = home.new_map(tmp_path)
    places = {"chair1": (0.0, 0.0, 0.0), "chair2": (0.7, 0.0, 0.0), "chair3": (9.0, 0.0, 0.0)}
    for number, (name, at) in enumerate(places.items()):
        own.commit(home.transaction(number, home.chair(name, at=at)))
    own.commit(home.transaction(9, home.turtle(":chair9 a dm:Chair .")))
    near = explain_relation(own, "chair1", "isNear", "chair2")
    assert near.text.startswith("chair1 is near chair2")
    assert near.conclusion is None
    assert refused(own, "chair1", "isNear", "chair3").startswith("chair1 is not near chair3")
    assert (
        refused(own, "chair1", "isNear", "chair9") == "chair9 has no position, so it has no spatial relations"
    )
    with pytest.raises(errors.BadRequest, match="the TBox has no property 'isNear', so nothing can exclude"):
        explain_relation(own, "chair1", "isNear", "chair2", negated=True)
    home.close(own)
