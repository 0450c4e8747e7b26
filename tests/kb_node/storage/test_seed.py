import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.seed import KEPT, seed
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node.home import PREFIXES, TBOX_TURTLE

ABOX = (
    PREFIXES
    + """
<http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1> a owl:Ontology .
:chair1 a dm:Chair ; dm:hasPosition [ a dm:Coordinates ] .
"""
)
ANONYMOUS = "dm:Stool a owl:Class ; rdfs:subClassOf dm:Seat , [ a owl:Class ] .\n"


@pytest.fixture
def files(tmp_path):
    folder = tmp_path / "my files"
    folder.mkdir()
    (folder / "my tbox.ttl").write_text(TBOX_TURTLE + ANONYMOUS)
    (folder / "my abox.ttl").write_text(ABOX)
    return folder / "my tbox.ttl", folder / "my abox.ttl"


@pytest.fixture
def data(tmp_path):
    return tmp_path / "data"


def read(data):
    """Return the names and triples of the map, as read at a start."""
    journal = Journal(data / FILENAME)
    semantic_map = SemanticMap(journal)
    journal.close()
    return [entity.name for entity in semantic_map.entities()], set(semantic_map.abox())


def contents(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_map_is_created_from_two_files(data, files):
    assert seed(data, *files) == "1 entity from my abox.ttl"
    names, triples = read(data)
    assert names == ["chair1"]
    assert (v.ABOX_ONTOLOGY, v.OWL_IMPORTS, v.TBOX_ONTOLOGY) in triples
    assert not any(p == v.RDFS_SUB_CLASS_OF for _, p, _ in triples)


def test_a_map_may_be_empty(data, files):
    assert seed(data, files[0], None) == "0 entities"
    assert read(data)[0] == []


def test_an_existing_map_is_kept(data, files):
    seed(data, *files)
    before = contents(data)
    assert seed(data, files[0], None).startswith("continuing with the map in ")
    assert contents(data) == before


def test_fresh_archives_the_old_map(data, files):
    seed(data, *files)
    for _ in range(2):
        seed(data, files[0], None, fresh=True)
    assert read(data)[0] == []
    kept = sorted((data / KEPT).iterdir())
    assert [read(folder)[0] for folder in kept] == [["chair1"], []]


def test_fresh_archives_a_damaged_journal(data, files):
    data.mkdir()
    (data / FILENAME).write_bytes(b"no database " * 99)
    seed(data, *files, fresh=True)
    assert read(data)[0] == ["chair1"]
    assert len(list((data / KEPT).iterdir())) == 1


def test_a_journal_in_use_is_not_changed(data, files):
    seed(data, *files)
    running = Journal(data / FILENAME)
    before = contents(data)
    with pytest.raises(errors.Refused, match="another knowledge base is using"):
        seed(data, *files, fresh=True)
    assert contents(data).keys() == before.keys()
    running.close()


@pytest.mark.parametrize(
    ("tbox", "abox", "error", "text"),
    [
        (None, "", errors.BadFile, "there is no file .*my tbox.ttl"),
        (TBOX_TURTLE, None, errors.BadFile, "there is no file .*my abox.ttl"),
        (TBOX_TURTLE[:-20], ABOX, errors.BadFile, "my tbox.ttl is not valid Turtle"),
        (TBOX_TURTLE, ABOX[:-5], errors.BadFile, r"^\S+/my files/my abox.ttl is not valid Turtle"),
        (TBOX_TURTLE, " ", errors.BadFile, "my abox.ttl is empty"),
        (ABOX, ABOX, errors.BadFile, "has no class: is it a TBox"),
        (
            TBOX_TURTLE + "dm:x a dm:Chair , dm:Kitchen .",
            ABOX,
            errors.Inconsistent,
            r"the TBox .* is inconsistent: x ",
        ),
        (TBOX_TURTLE, ABOX + ":chair1 a dm:Kitchen .", errors.Inconsistent, "my abox.ttl: chair1 cannot be "),
        (
            TBOX_TURTLE,
            ABOX + ":x a dm:Xylophone .",
            errors.UnknownClass,
            "'Xylophone' .*; other classes are given with --tbox FILE, another map with --abox FILE",
        ),
        (
            TBOX_TURTLE + "dm:isOn rdfs:domain dm:Object .",
            ABOX + "[] dm:isOn :chair1 .",
            errors.BadRequest,
            "my abox.ttl: a Object is a blank node",
        ),
    ],
)
@pytest.mark.parametrize("fresh", [False, True])
def test_invalid_files_leave_the_old_data_unchanged(data, files, tbox, abox, error, text, fresh):
    if fresh:
        seed(data, *files)
    before = contents(data)
    for path, content in zip(files, (tbox, abox), strict=True):
        path.unlink()
        if content is not None:
            path.write_text(content)
    with pytest.raises(error, match=text):
        seed(data, *files, fresh=fresh)
    assert contents(data) == before


def test_individuals_of_unknown_classes_are_left_out_on_request(data, files):
    files[1].write_text(ABOX + ":x a dm:Xylophone . <http://o.org/1> a dm:Chair .")
    assert seed(data, *files, skip_unknown=True) == (
        "2 entities from my abox.ttl; note: left out 1: x (unknown class 'Xylophone'); note: 1 name made from"
        " IRIs, which stay as they are: _1 (<http://o.org/1>)"
    )
    assert read(data)[0] == ["_1", "chair1"]


def test_declarations_of_the_abox_file_become_part_of_the_tbox_on_request(data, files):
    files[1].write_text(ABOX + ":Mug a owl:Class ; rdfs:subClassOf dm:Object . :mug1 a :Mug .")
    assert seed(data, *files, tbox_from_abox=True) == (
        "2 entities from my abox.ttl; note: added to the TBox: 1 class and 0 properties of the file"
    )
    names, triples = read(data)
    assert names == ["chair1", "mug1"]
    assert not any(s.endswith("Mug>") for s, _, _ in triples)
    assert seed(data, *files, fresh=True).startswith(
        "2 entities from my abox.ttl; note: only the map declares Mug"
    )


SHAPE = """
@prefix sh: <http://www.w3.org/ns/shacl#> .
[] a sh:NodeShape ; sh:targetClass dm:Seat ;
    sh:property [
        sh:path ( dm:hasPosition dm:lexicalReference ) ; PATTERN sh:minCount 1 ; sh:message "no label"
    ] .
"""


def test_files_that_violate_a_shape_are_rejected_on_request(data, files):
    files[0].write_text(TBOX_TURTLE + SHAPE.replace("PATTERN", ""))
    with pytest.raises(
        errors.BadFile, match=r"my abox.ttl: chair1: no label; .*required by the shapes of the "
    ):
        seed(data, *files, enforce_shapes=True)
    assert contents(data) == {}
    assert seed(data, *files) == "1 entity from my abox.ttl"
    files[1].write_text(ABOX.replace("dm:Coordinates", 'dm:Coordinates ; dm:lexicalReference "x"'))
    assert seed(data, *files, fresh=True, enforce_shapes=True) == "1 entity from my abox.ttl"


def test_an_invalid_shape_is_rejected_on_request(data, files):
    files[0].write_text(TBOX_TURTLE + SHAPE.replace("PATTERN", 'sh:pattern "(" ;'))
    with pytest.raises(errors.BadFile, match="invalid SHACL shape"):
        seed(data, *files, enforce_shapes=True)


def test_a_write_error_does_not_blame_the_files(data, files, monkeypatch):
    def refuse(path, tbox):
        raise errors.Refused(f"cannot create a journal at {path}: disk full")

    monkeypatch.setattr(Journal, "create", refuse)
    with pytest.raises(errors.Refused, match=r"^cannot create a journal at "):
        seed(data, *files)


@pytest.mark.process  # not Turtle
def test_a_tbox_may_be_a_folder_with_imports(data, files, tmp_path):
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "stools.ofn").write_text(
        "Ontology(<http://o.org/stools> Import(<http://o.org/home>)"
        f" Declaration(Class(<{v.TBOX}Barstool>)) SubClassOf(<{v.TBOX}Barstool> <{v.TBOX}Seat>))"
    )
    imports = {"http://o.org/home": files[0]}
    assert seed(data, tmp_path / "own", None, imports=imports) == "0 entities"
    journal = Journal(data / FILENAME)
    classes = SemanticMap(journal).classes
    journal.close()
    assert {"Barstool", "Chair"} <= classes.iris.keys()
    with pytest.raises(errors.BadFile, match="own cannot be read: Is a directory"):
        seed(data, files[0], tmp_path / "own", fresh=True)


def test_a_file_as_data_folder_is_rejected(files):
    with pytest.raises(errors.Refused, match=r"cannot create a map in .*: File exists"):
        seed(files[1], files[0], None)
