"""Places as polygons, through a whole system."""

import json

import pytest

from semmap.schemas import errors

L_SHAPE = "POLYGON ((20 0, 26 0, 26 2, 22 2, 22 5, 20 5, 20 0))"


@pytest.fixture(scope="module")
def system(flat_map):
    return flat_map


def test_a_polygon_from_adding_to_removing(system, tmp_path):
    with system.client() as client:
        before = client.status().commit
    told = system.cli("add", "Room", "nook1", "--extent", L_SHAPE)
    assert told == f"added Room nook1 at (23, 2.5, 0) (commit {before + 1})\n"
    system.cli("add", "Cup", "mug1", "--at", 21, 4, 0)
    system.cli("add", "Cup", "mug2", "--at", 24, 4, 0)
    with system.client() as client:
        assert [e.name for e in client.list(in_="nook1")] == ["mug1"]
        place = client.get("nook1")
        assert place.properties["hasExtent"] == L_SHAPE
        assert (place.pose.position_m, place.size_m) == ((23.0, 2.5, 0.0), (6.0, 5.0, 2.5))
        rows = client.sparql("SELECT ?x { ?x dm:isLocatedIn :nook1 }", inferred=True).rows
        assert [row[0].rpartition("#")[2].rstrip(">") for row in rows] == ["mug1"]
        assert "mug2 is not in nook1: it is 1.94 m from it" in system.cli("relations", "mug2", "nook1")

        client.update("nook1", extent="POLYGON ((20 0, 26 0, 26 5, 22 5, 22 2, 20 2, 20 0))")
        assert [e.name for e in client.list(in_="nook1")] == ["mug2"]
        client.undo()
        assert [e.name for e in client.list(in_="nook1")] == ["mug1"]
        assert [e.name for e in client.list(in_="nook1", as_of=client.status().commit - 1)] == ["mug2"]

        with pytest.raises(errors.Refused, match="the extent of nook1 is a polygon"):
            client.update("nook1", at=(0.0, 0.0, 0.0))
        client.update("nook1", at=(23.0, 2.5, 1.0))
        assert client.get("nook1").pose.position_m == (23.0, 2.5, 1.0)
        client.set("nook1", "hasExtent", "POLYGON((20 0, 22 0, 22 2, 20 0))")
        assert client.get("nook1").size_m == (2.0, 2.0, 2.5)
        with pytest.raises(errors.BadRequest, match="crosses or touches itself"):
            client.set("nook1", "hasExtent", "POLYGON ((0 0, 4 4, 4 0, 0 4, 0 0))")
        client.update("nook1", unset=("hasExtent",), at=(5.0, 5.0, 0.0), size=(1.0, 1.0, 1.0))
        assert client.get("nook1").pose.position_m == (5.0, 5.0, 0.0)
        client.remove("nook1", "mug1", "mug2")


@pytest.mark.parametrize("form", ["turtle", "rdfxml", "ntriples", "jsonld"])
def test_every_format_takes_it_out_and_in_again(system, tmp_path, form):
    system.cli("add", "Room", "nook2", "--extent", L_SHAPE, "--size", 1, 1, 3, "--at", 0, 0, 0.5)
    file = tmp_path / "map.rdf"
    system.cli("export", file, "--format", form)
    assert "geosparql#" in file.read_text()
    before = json.loads(system.cli("get", "nook2", "--format", "json"))
    system.cli("load", file, "--replace")
    after = json.loads(system.cli("get", "nook2", "--format", "json"))
    assert [before[k] for k in ("pose", "size_m", "properties")] == [
        after[k] for k in ("pose", "size_m", "properties")
    ]
    assert (after["pose"]["position_m"], after["size_m"]) == ([23.0, 2.5, 0.5], [6.0, 5.0, 3.0])
    system.cli("remove", "nook2")


def test_scenes_have_extents_and_properties(system, tmp_path):
    scene = tmp_path / "scene.json"
    entities = [
        {"class": "Room", "name": "nook3", "extent": L_SHAPE},
        {"class": "Door", "name": "door70", "at": [26, 1, 0], "set": ["connects=nook3", "isOpen=false"]},
    ]
    scene.write_text(json.dumps({"entities": entities}))
    system.cli("load", scene)
    with system.client() as client:
        assert client.get("nook3").pose.position_m == (23.0, 2.5, 0.0)
        assert client.get("door70").properties == {"connects": ("nook3",), "isOpen": False}
        client.remove("nook3", "door70")
    entities[0]["extent"] = "POLYGON ((0 0, 1 0, 1 1, 0 1))"
    scene.write_text(json.dumps({"entities": entities}))
    assert "nook3: the border of the extent is not closed" in system.cli("load", scene, status=2)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ("add", "Room", "--extent", "POLYGON ((0 0, 4 4, 4 0, 0 4, 0 0))"),
            "crosses or touches itself near",
        ),
        (("add", "Room", "--extent", "POLYGON ((0 0, 4 4, 4 nan, 0 0))"), "within 10000 m"),
        (("add", "Room", "--extent", "CIRCLE"), "an extent is one POLYGON, not CIRCLE"),
        (("add", "Room", "--extent", L_SHAPE, "--yaw", "1"), "remove the angle"),
        (("add", "Chair", "--extent", L_SHAPE), "only places have an extent, and a Chair is not a place"),
        (("update", "chair1", "--extent", L_SHAPE), "only places have an extent, and a Chair is not a place"),
    ],
)
def test_what_cannot_be_is_said(system, words, said):
    assert said in system.cli(*words, status=2)


def test_a_document_with_a_broken_extent_is_refused(system, tmp_path):
    file = tmp_path / "broken.ttl"
    file.write_text(
        "@prefix : <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1#> .\n"
        "@prefix dm: <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#> .\n"
        "@prefix geo: <http://www.opengis.net/ont/geosparql#> .\n"
        ':hut1 a dm:Room ; dm:hasExtent "POLYGON ((0 0, 1 0, 1 1, 0 1))"^^geo:wktLiteral .\n'
    )
    assert "hut1: the border of the extent is not closed" in system.cli("load", file, status=2)
    file.write_text(file.read_text().replace("0 1))", "0 1, 0 0))"))
    system.cli("load", file)
    with system.client() as client:
        assert client.get("hut1").size_m == (1.0, 1.0, 2.5)
        client.remove("hut1")
