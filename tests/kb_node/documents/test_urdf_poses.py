import pytest

from semmap.nodes.kb_node.documents import rdf, urdf_poses
from semmap.nodes.kb_node.documents.urdf import Link
from semmap.nodes.kb_node.entities import alignments
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.entities import Pose

SOMA = [known for known in alignments.shipped() if known.title.startswith("SOMA")]
HEAD = """@prefix : <http://e.org/k#> . @prefix soma: <http://www.ease-crc.org/ont/SOMA.owl#> .
@prefix knowrob: <http://knowrob.org/kb/knowrob.owl#> . @prefix urdf: <http://knowrob.org/kb/urdf.owl#> .
"""
AT = Pose(position_m=(1.0, 2.0, 0.9))
LINKS = {"fridge1": Link(AT, (AT, (0.6, 0.6, 1.8)), ()), "door_link": Link(AT, None, ("door.dae",))}


def posed(turtle):
    triples = rdf.parse((HEAD + turtle).encode(), "f")
    found, notes = urdf_poses.add_poses(triples, LINKS, SOMA, "k.urdf")
    assert found[: len(triples)] == triples
    return found[len(triples) :], notes


def test_an_individual_called_like_a_link_gets_its_pose_and_size():
    added, notes = posed(":fridge1 a soma:Refrigerator .")
    fridge = "<http://e.org/k#fridge1>"
    size, at = "<http://e.org/k#fridge1_size>", "<http://e.org/k#fridge1_coordinates>"
    assert added == [
        *entity_triples.size(fridge, size, (0.6, 0.6, 1.8)),
        *entity_triples.position(fridge, at, Pose(position_m=(1.0, 2.0, 0.0))),
    ]
    assert notes == ["1 pose from k.urdf: fridge1"]


@pytest.mark.parametrize("name", ["door_link", "iai_kitchen/door_link"])
def test_a_property_may_have_the_name_of_the_link(name):
    added, notes = posed(f':door a soma:Door ; urdf:hasURDFName "{name}" .')
    assert added == entity_triples.position("<http://e.org/k#door>", "<http://e.org/k#door_coordinates>", AT)
    assert notes == ["1 pose from k.urdf: door", "1 link of k.urdf without a size: of meshes or no shapes"]


@pytest.mark.parametrize(
    "pose",
    [
        "soma:hasLocalization [ soma:hasSpaceRegion [ knowrob:translation '1 1 1' ] ]",
        f"<{v.bare(v.HAS_POSITION)}> :here",
    ],
)
def test_a_stated_pose_counts_more(pose):
    added, _ = posed(f":fridge1 a soma:Refrigerator ; {pose} .")
    assert {p for _, p, _ in added} >= {v.HAS_SIZE}
    assert v.HAS_POSITION not in {p for _, p, _ in added}


def test_a_file_without_a_common_name_is_rejected():
    with pytest.raises(
        errors.Refused,
        match=r"^k\.urdf: no individual of the file has the name of one of its 2 links, such as",
    ):
        posed(":cup1 a soma:Cup .")
