"""Readers of JSON scenes and HuRIC maps, and the detection of file types."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest

from semmap.nodes.coordinator.files import huric
from semmap.nodes.coordinator.files.content import kind_of
from semmap.schemas import scene_files
from semmap.schemas.errors import BadFile
from semmap.schemas.file_kinds import FORMATS
from tests.data import data_folder

SCENE = {"entities": [{"class": "Chair", "name": "chair9", "at": [1, 2, 0], "yaw": 1.5, "alt": ["seat"]}]}


def as_bytes(scene: object) -> bytes:
    return json.dumps(scene).encode()


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (b'<?xml version="1.0"?><huricExample id="1"/>', "huric"),
        (b'<?xml version="1.0"?><rdf:RDF xmlns:rdf="..."/>', "abox"),
        (b"@prefix : <http://x#> . :a a :B .", "abox"),
        (b"<http://x#a> <http://x#b> <http://x#c> .", "abox"),
        (b'\xef\xbb\xbf  {"entities": []}', "scene"),
        (b'{"@context": {}, "@graph": []}', "abox"),
        (b"{ <http://x#a> a <http://x#b> }", "abox"),
        (b"{ :a a :b }", "abox"),
        (b'[{"@id": "http://x#a"}]', "abox"),
        (b"[] a <http://x#B> .", "abox"),
    ],
)
def test_the_file_type_is_detected_from_the_content(content, kind):
    assert kind_of(content, "file") == kind
    assert kind_of(gzip.compress(content), "file.gz") == kind


@pytest.mark.parametrize("content", [b"", b"  \n", b"{", b'{"chairs": 3}', b"[1, 2]"])
def test_unknown_content_is_rejected(content):
    with pytest.raises(BadFile):
        kind_of(content, "file.json")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"\x89PNG\r\n\x1a\n", "an image; a floor plan is loaded by its .yaml file"),
        (b"SQLite format 3\0", f"a database; supported formats: {FORMATS}"),
        (b"#ROSBAG V2.0\n", "a recording; convert it with `semmap frames`"),
        (
            b'<?xml version="1.0"?>\n<!-- a\n<robot> -->\n<mujoco model="desk">',
            "a world; start a system with it: `semmap up --world FILE`",
        ),
    ],
)
def test_another_kind_of_file_is_named_with_the_next_step(content, said):
    with pytest.raises(BadFile) as caught:
        kind_of(content, "x")
    assert caught.value.text == f"x is not a map, but {said}"


def test_a_broken_json_file_is_reported():
    assert kind_of(b"[1, 2", "x.ttl") == "abox"
    for content in (b"[1, 2", b"{a:1}"):
        with pytest.raises(BadFile, match=r"x\.json is not valid JSON"):
            kind_of(content, "x.json")
    with pytest.raises(BadFile, match=r"x\.json is not valid JSON"):
        kind_of(gzip.compress(b"[1, 2"), "x.json.gz")


def test_a_broken_archive_is_reported():
    with pytest.raises(BadFile, match=r"x\.gz: the gzip data is truncated"):
        kind_of(gzip.compress(as_bytes(SCENE))[:-9], "x.gz")


def test_a_scene():
    (chair,) = scene_files.read(as_bytes(SCENE), "scene.json").entities
    assert (chair.class_, chair.name, chair.at, chair.yaw) == ("Chair", "chair9", (1.0, 2.0, 0.0), 1.5)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"at": [1, 2]}, "at"),
        ({"at": [1, 2, "x"]}, "at"),
        ({"at": [1e9, 0, 0]}, "at"),
        ({"size": [1, -1, 1]}, "size"),
        ({"name": "my chair"}, "name"),
        ({"colour": "red"}, "colour"),
        ({"ref": ""}, "ref"),
        ({"orientation": [1, 0, 0, 0]}, "entities: the 1st: give yaw or orientation, not both"),
        ({"orientation": [1, 1, 0, 0], "yaw": None}, "entities: the 1st: the quaternion .* it must be 1"),
    ],
)
def test_a_scene_with_a_fault_names_the_field(change, said):
    scene = {"entities": [{**SCENE["entities"][0], **change}]}
    with pytest.raises(BadFile, match=said):
        scene_files.read(as_bytes(scene), "scene.json")


@pytest.mark.parametrize(
    ("camera", "said"),
    [
        ({"look_at": [0, 0, 0]}, "cameras: the 1st: at is missing"),
        ({"at": [0, 0, 1]}, "cameras: the 1st: a camera needs either look_at or orientation"),
        (
            {"at": [0, 0, 1], "look_at": [1, 0, 1], "orientation": [1, 0, 0, 0]},
            "either look_at or orientation",
        ),
        ({"at": [0, 0, 1], "look_at": [0, 0, 1]}, "look_at is the camera's own position"),
        ({"at": [0, 0, 1], "orientation": [1, 1, 0, 0]}, "has length 1.414; it must be 1"),
        ({"at": [0, 0, 1], "look_at": [1, 0, 1], "fovy": 58}, "fovy is 58; it must be from .* radians"),
        ({"at": [0, 0, 1], "look_at": [1, 0, 1], "name": "a/b"}, "name must be a valid name"),
        ({"at": [0, 0, 1], "lookat": [1, 0, 1]}, "no field 'lookat'; did you mean look_at"),
    ],
)
def test_an_invalid_camera_is_reported(camera, said):
    with pytest.raises(BadFile, match=said):
        scene_files.read(as_bytes({**SCENE, "cameras": [camera]}), "scene.json")


def test_two_cameras_of_one_name_are_refused():
    camera = {"name": "desk", "at": [0, 0, 1], "look_at": [1, 0, 1]}
    with pytest.raises(BadFile, match="two cameras are named desk"):
        scene_files.read(as_bytes({**SCENE, "cameras": [camera, camera]}), "scene.json")


def test_the_json_schema_in_the_repository_is_up_to_date():
    path = Path(scene_files.__file__).with_name("scene.schema.json")
    assert path.read_text() == scene_files.json_schema()


HURIC = b"""<huricExample id="1"><semanticMap><entities>
<entity atom="jar_1" type="Jar"><attributes>
<attribute name="contain_ability"><value>true</value></attribute>
<attribute name="support_ability"><value>false</value></attribute>
<attribute name="lexical_references"><value>jar</value><value>pot</value></attribute>
</attributes><coordinate angle="0.5" x="11.0" y="6.0" z="0.0"/></entity>
</entities></semanticMap></huricExample>"""


def test_a_huric_map():
    (jar,) = huric.read(HURIC, "a.hrc")
    assert (jar.class_, jar.name, jar.at, jar.yaw) == ("Jar", "jar_1", (11.0, 6.0, 0.0), 0.5)
    assert (jar.ref, jar.alt, jar.affords) == ("jar", ("pot",), ("containing",))


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (HURIC[:200], "not valid XML"),
        (b"<huricExample/>", "no semantic map"),
        (HURIC.replace(b'x="11.0"', b'x="NaN"'), "jar_1"),
        (HURIC.replace(b'x="11.0"', b'x="eleven"'), "jar_1"),
        (HURIC.replace(b'atom="jar_1"', b'atom="jar 1"'), "jar 1"),
        (b'<!DOCTYPE x [<!ENTITY a "b">]>' + HURIC, "XML entities"),
    ],
)
def test_a_huric_map_with_a_fault_is_refused(fault, said):
    with pytest.raises(BadFile, match=said):
        huric.read(fault, "a.hrc")


def test_every_huric_map_of_the_corpus_can_be_read():
    paths = sorted((data_folder() / "huric").rglob("*.hrc"))
    assert paths
    assert all(huric.read(path.read_bytes(), path.name) for path in paths)


def test_a_byte_order_mark_is_no_part_of_a_scene():
    (chair,) = scene_files.read(b"\xef\xbb\xbf" + as_bytes(SCENE), "scene.json").entities
    assert chair.name == "chair9"


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
def test_numbers_that_json_does_not_have_are_named(number):
    content = as_bytes(SCENE).replace(b"1.5", number.encode())
    with pytest.raises(BadFile, match=r"scene.json is not a valid scene: .*; JSON does not allow NaN"):
        scene_files.read(content, "scene.json")
    with pytest.raises(BadFile) as error:
        scene_files.read(as_bytes({"entities": [{"class": number}], "x": 1}), "scene.json")
    assert "Infinity" not in error.value.text
