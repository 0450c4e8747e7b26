import pyoxigraph as ox

from semmap.nodes.extern.web.views.example_queries import example_queries
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import ClassInfo
from tests.recorder.messages import entity

PREFIXES = "".join(
    f"PREFIX {p}: <{iri}>\n" for p, iri in {**v.PREFIXES, "rdf": v.RDF, "rdfs": v.RDFS}.items()
)


def class_info(name):
    return ClassInfo(
        name=name, iri=v.bare(v.dm(name)), parents=(), ancestors=(), labels={}, spatial=True, place=False,
        fixed=False, model="",
    )  # fmt: skip


def test_examples_use_entities_of_the_map():
    entities = {
        "cup1": entity("cup1", "Cup"),
        "kitchen1": entity("kitchen1", "Kitchen", place=True, preferred_reference="kitchen"),
    }
    titles = [example.title for example in example_queries(entities, {"Cup": class_info("Cup")})]
    assert titles[0] == "All entities with their classes"
    assert "Entities in kitchen" in titles
    assert "Facts about cup1" in titles


def test_every_example_is_a_valid_query():
    entities = {
        "cup1": entity("cup1", "Cup"),
        "kitchen1": entity("kitchen1", "Kitchen", place=True, preferred_reference='"}<script>'),
    }
    for example in example_queries(entities, {"Cup": class_info("Cup")}):
        ox.Store().query(PREFIXES + example.query)


def test_an_empty_map_has_one_example():
    assert len(example_queries({}, {})) == 1
