"""Effects of changed triples on entities."""

from semmap.nodes.kb_node.documents import rdf
from semmap.ontology import vocabulary as v
from tests.kb_node import home
from tests.kb_node.home import TBOX_TURTLE, chair, transaction

X = v.COORDINATE_XYZ[0]
MEASURED = f"dm:Measured a owl:Class . {X} rdfs:domain dm:Measured ."


def test_an_individual_with_its_own_coordinates_has_the_inferred_classes(tmp_path):
    tbox = rdf.parse((TBOX_TURTLE + MEASURED).encode(), "tbox.ttl", label_prefix="t")
    semantic_map = home.new_map(tmp_path, tbox)
    semantic_map.commit(transaction(1, chair("chair1")))
    assert "Measured" not in semantic_map.entity("chair1").types
    said = (v.entity_iri("chair1"), X, v.literal("1.0", v.XSD_FLOAT))
    commit = semantic_map.commit(transaction(2, [said]))
    assert [entity.name for entity in commit.changed] == ["chair1"]
    assert "Measured" in semantic_map.entity("chair1").types
    home.close(semantic_map)
