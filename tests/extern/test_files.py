"""Local files of the client."""

from pathlib import Path

import pytest

from semmap.nodes.extern import files
from semmap.nodes.extern.client_commands import CommandMethods
from semmap.nodes.extern.files import read_ontology
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.runtime import extras
from semmap.ontology import vocabulary as v
from semmap.schemas import errors


def test_a_file_is_read_whole(tmp_path):
    file = tmp_path / "map.ttl"
    file.write_bytes(b"x" * 100_000)
    assert files.read_file(file) == b"x" * 100_000


def test_what_cannot_be_read_says_why(tmp_path):
    with pytest.raises(errors.BadFile, match=r"^there is no file .*/map.ttl$"):
        files.read_file(tmp_path / "map.ttl")
    with pytest.raises(errors.BadFile, match="is a directory, not a file"):
        files.read_file(tmp_path)


def test_what_has_no_end_is_refused(monkeypatch):
    monkeypatch.setattr(files, "LARGEST", 1 << 20)
    with pytest.raises(errors.BadFile, match=r"^/dev/zero is larger than 1 MiB; split it into several"):
        files.read_file(Path("/dev/zero"))
    with pytest.raises(errors.BadFile, match=r"^/dev/zero is larger than 2 MiB"):
        files.read_file(Path("/dev/zero"), largest=2 << 20)


def test_a_map_of_labels(tmp_path):
    file = tmp_path / "map.json"
    file.write_text('{"coffee mug": "Cup"}')
    assert files.read_label_map(file) == {"coffee mug": "Cup"}
    for mark in ("utf-8-sig", "utf-16"):
        file.write_text('{"tasse": "Cup"}', mark)
        assert files.read_label_map(file) == {"tasse": "Cup"}
    file.write_bytes(b"\xff\xfe{")
    with pytest.raises(errors.BadFile, match="not a JSON object of labels"):
        files.read_label_map(file)
    file.write_text("[]")
    with pytest.raises(errors.BadFile, match="not a JSON object of labels"):
        files.read_label_map(file)


OWL = "@prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
A = f"{OWL}<http://o.org/a> a owl:Ontology ; owl:imports <http://o.org/b> ."
B = f"{OWL}<http://o.org/b> a owl:Ontology ."


@pytest.fixture
def file(tmp_path):
    (tmp_path / "a.ttl").write_text(A)
    return tmp_path / "a.ttl"


def test_one_file_is_sent_as_it_is(file):
    assert read_ontology(file, {}) == (A.encode(), "a.ttl", "")


@pytest.mark.parametrize("said", [False, True])
def test_with_its_imports_it_is_one_document(file, tmp_path, said):
    other = tmp_path / ("elsewhere" if said else "") / "b.ttl"
    other.parent.mkdir(exist_ok=True)
    other.write_text(B)
    content, name, _ = read_ontology(file, {"http://o.org/b": str(other)} if said else {})
    assert name == "a.ttl and 1 more file"
    assert set(rdf.parse(content, name)) == {*rdf.parse(A.encode(), "a"), *rdf.parse(B.encode(), "b")}


def test_a_folder_is_one_document(file, tmp_path):
    (tmp_path / "b.ttl").write_text(B)
    content, name, _ = read_ontology(tmp_path, {})
    assert name == f"{tmp_path.name} and 1 more file"
    assert len(rdf.parse(content, name)) == 3


@pytest.mark.process
def test_the_graph_of_an_ontology_with_imports_is_read_here(file, tmp_path):
    trig = tmp_path / "c.trig"
    named = f"GRAPH <urn:c#g> {{ <http://o.org/b> a <{v.OWL}Ontology> }}"
    trig.write_text(named)
    imports = {"http://o.org/b": trig}
    with pytest.raises(errors.BadFile, match=r"c\.trig: its default graph is empty.*\(g: 1\)"):
        read_ontology(file, imports)
    trig.write_text(f"{B} {named}")
    with pytest.raises(errors.BadFile, match=r"c\.trig: left out: 1 statement in other graphs"):
        read_ontology(file, imports)
    trig.write_text(named)
    assert read_ontology(trig, {}, "g")[1:] == ("c.trig", "g")


def test_a_client_alone_sends_the_file(file, tmp_path, monkeypatch):
    (tmp_path / "b.ttl").write_text(B)
    monkeypatch.setattr(extras, "find_spec", lambda _: None)
    assert read_ontology(file, {}) == (A.encode(), "a.ttl", "")
    for path, imports in ((file, {"http://o.org/b": tmp_path / "b.ttl"}), (tmp_path, {})):
        with pytest.raises(
            errors.BadRequest, match=r"finding imports: missing optional packages; install: .*kb"
        ):
            read_ontology(path, imports)


def test_imports_are_for_tboxes(file):
    class Client(CommandMethods):
        def request(self, make, read=None):
            return make()

    with pytest.raises(errors.BadRequest, match="applies to TBoxes only"):
        Client().load(file, imports={"http://o.org/b": file})
    with pytest.raises(errors.BadRequest, match="--extend applies to TBoxes only; add --tbox"):
        Client().load(file, extend=True)
    assert Client().load(file, tbox=True).tbox
    assert Client().load(file, tbox=True, extend=True).extend
