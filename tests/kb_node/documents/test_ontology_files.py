"""Ontology files and their imports: given, from a catalogue, from the same folder, or missing."""

from __future__ import annotations

import pytest

from semmap.nodes.kb_node.documents import ontology_files
from semmap.nodes.kb_node.documents.ontology_files import gather, header, missing_imports
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.data import data_folder

PREFIXES = (
    "@prefix owl: <http://www.w3.org/2002/07/owl#> ."
    " @prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
)
CATALOGUE = """<?xml version="1.0" encoding="UTF-8" standalone="no"?>
<catalog prefer="public" xmlns="urn:oasis:names:tc:entity:xmlns:xml:catalog">
    <uri id="User Entered Import Resolution" name="http://things.org/all" uri="elsewhere/my%20things.ttl"/>
    <uri id="gone" name="http://things.org/gone" uri="elsewhere/gone.ttl"/>
    <uri id="far" name="http://things.org/far" uri="http://things.org/far.ttl"/>
    <group id="Folder Repository, directory=, recursive=true" prefer="public" xml:base="elsewhere/">
        <uri id="Automatically generated entry" name="http://things.org/cups" uri="cups.ofn"/>
    </group>
    <rewriteURI uriStartString="http://things.org/v2/" rewritePrefix="elsewhere/two/"/>
    <nextCatalog catalog="elsewhere/catalog-v001.xml"/>
</catalog>
"""


def ontology(iri: str, *imports: str, more: str = "") -> str:
    said = "".join(f" ; owl:imports <{i}>" for i in imports)
    return f"{PREFIXES}<{iri}> a owl:Ontology{said} .\n<{iri}#C> a owl:Class .\n{more}"


@pytest.fixture
def write(tmp_path):
    def write(name: str, text: str):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path.resolve()

    return write


def classes(gathered):
    return {
        v.bare(s).partition("#")[0] for s, p, o in gathered.triples if (p, o) == (v.RDF_TYPE, v.OWL_CLASS)
    }


def test_one_file_is_read_completely(write):
    path = write("a.ttl", ontology("http://o.org/a"))
    gathered = gather([path], {})
    assert (gathered.files, gathered.found, gathered.missing) == ((path,), {}, ())
    assert len(gathered.triples) == 2


@pytest.mark.parametrize(
    ("file", "iri", "wanted"),
    [
        ("other name.ttl", "http://o.org/b", "http://o.org/b"),
        ("other name.ttl", "http://o.org/b", "http://o.org/b#"),
        ("other name.ttl", "http://o.org/b/", "http://o.org/b"),
        ("b.owl", "http://o.org/unlike", "package://robot/owl/b.owl"),
        ("b.owl", "http://o.org/unlike", "http://o.org/b.owl"),
        ("b.ttl", "http://o.org/unlike", "http://o.org/b/"),
        ("b c.ttl", "http://o.org/unlike", "http://o.org/b%20c.ttl"),
    ],
)
def test_an_import_is_found_in_the_same_folder(write, file, iri, wanted):
    path, other = write("a.ttl", ontology("http://o.org/a", wanted)), write(file, ontology(iri))
    gathered = gather([path], {})
    assert gathered.files == (path, other)
    assert gathered.found == {wanted: other}
    assert gathered.missing == missing_imports(gathered.triples) == ()
    assert header(gathered.triples).imports == (v.iri(iri),)


def test_the_name_of_the_ontology_takes_precedence_over_the_file_name(write):
    path = write("a.ttl", ontology("http://o.org/a", "http://o.org/b.ttl"))
    write("b.ttl", ontology("http://o.org/something-else"))
    right = write("c.ttl", ontology("http://o.org/b.ttl"))
    assert gather([path], {}).files == (path, right)


def test_an_import_may_name_the_version(write):
    path = write("a.ttl", ontology("http://o.org/a", "http://o.org/b/1.0"))
    other = write(
        "x.ttl", ontology("http://o.org/b", more="<http://o.org/b> owl:versionIRI <http://o.org/b/1.0> .")
    )
    gathered = gather([path], {})
    assert (gathered.files, gathered.missing) == ((path, other), ())


def test_imports_are_transitive_and_may_be_cyclic(write):
    a = write("a.ttl", ontology("http://o.org/a", "http://o.org/b"))
    b = write("b.ttl", ontology("http://o.org/b", "http://o.org/c"))
    c = write("c.ttl", ontology("http://o.org/c", "http://o.org/a", "http://o.org/b"))
    gathered = gather([a], {})
    assert gathered.files == (a, b, c)
    assert classes(gathered) == {"http://o.org/a", "http://o.org/b", "http://o.org/c"}
    assert set(gather([c], {}).triples) == set(gathered.triples)


def test_a_given_file_takes_precedence(write):
    path, beside = write("a.ttl", ontology("http://o.org/a", "http://o.org/b")), "b.ttl"
    write(beside, ontology("http://o.org/b"))
    mine = write("mine/b2.ttl", ontology("http://o.org/mine", "http://o.org/d"))
    further = write("mine/d.ttl", ontology("http://o.org/d"))
    gathered = gather([path], {"http://o.org/b": mine})
    assert gathered.files == (path, mine, further)  # its own import is next to it
    assert gathered.missing == ()


@pytest.mark.process  # not Turtle
def test_a_catalogue_maps_imports_to_files(write):
    all_ = write("elsewhere/my things.ttl", ontology("http://things.org/all", "http://things.org/cups"))
    cups = write(
        "elsewhere/cups.ofn",
        "Ontology(<http://things.org/cups> Declaration(Class(<http://things.org/cups#C>)))",
    )
    two = write("elsewhere/two/knives", ontology("http://things.org/v2/knives"))
    write("catalog-v001.xml", CATALOGUE)
    write("elsewhere/catalog-v001.xml", CATALOGUE.replace("elsewhere/", "").replace("all", "next"))
    wanted = [f"http://things.org/{name}" for name in ("all", "cups", "v2/knives", "next", "gone", "far")]
    path = write("a.ttl", ontology("http://o.org/a", *wanted))
    gathered = gather([path], {})
    assert gathered.found == dict(zip(wanted[:4], (all_, cups, two, all_), strict=True))
    assert gathered.missing == ("http://things.org/far", "http://things.org/gone")


def test_an_invalid_catalogue_is_reported(write):
    write("catalog-v001.xml", "<catalog>\n<uri>")
    path = write("a.ttl", ontology("http://o.org/a", "http://o.org/b"))
    with pytest.raises(errors.BadFile, match=r"catalog-v001.xml is not a valid XML catalogue: .*line 2"):
        gather([path], {})


def test_a_missing_import_is_not_an_error(write):
    path = write("a.ttl", ontology("http://o.org/a", "http://o.org/nowhere", "http://o.org/b"))
    write("b.ttl", ontology("http://o.org/b"))
    gathered = gather([path], {})
    assert gathered.missing == missing_imports(gathered.triples) == ("http://o.org/nowhere",)
    assert classes(gathered) == {"http://o.org/a", "http://o.org/b"}


def test_broken_files_are_skipped_unless_they_are_imported(write):
    path = write("a.ttl", ontology("http://o.org/a", "http://o.org/b"))
    write("other.ttl", "http://o.org/b this is\nno Turtle")
    assert gather([path], {}).missing == ("http://o.org/b",)
    write("b.ttl", PREFIXES + "\n<http://o.org/b> a owl:Ontology\n:x")
    with pytest.raises(errors.BadFile, match=r"b\.ttl is not valid Turtle: .*line 4"):
        gather([path], {})


@pytest.mark.process  # not Turtle
def test_a_folder_stands_for_its_ontologies(write, tmp_path):
    b = write("o/b.ttl", ontology("http://o.org/b", "http://o.org/a"))
    a = write(
        "o/a.owx", '<Ontology xmlns="http://www.w3.org/2002/07/owl#" ontologyIRI="http://o.org/a"></Ontology>'
    )
    write("o/readme.md", "# read me")
    write("o/catalog-v001.xml", CATALOGUE)
    gathered = gather([tmp_path / "o"], {})
    assert (gathered.files, gathered.missing) == ((a, b), ())
    write("empty/readme.md", "# nothing")
    with pytest.raises(errors.BadFile, match=r"there is no ontology in the folder .*empty"):
        gather([tmp_path / "empty"], {})


def test_several_files_import_one_another(write):
    a = write("one/a.ttl", ontology("http://o.org/a", "http://o.org/b", "http://o.org/c"))
    b = write("two/x.ttl", ontology("http://o.org/b"))
    c = write("two/c.ttl", ontology("http://o.org/c"))
    gathered = gather([a, b], {})
    assert (gathered.files, gathered.missing) == ((a, b, c), ())


def test_blank_nodes_of_two_files_are_different(write):
    blank = "_:x a owl:Class ; rdfs:comment '{}' ."
    a = write("a.ttl", ontology("http://o.org/a", "http://o.org/b", more=blank.format("a")))
    write("b.ttl", ontology("http://o.org/b", more=blank.format("b")))
    assert len({s for s, _, _ in gather([a], {}).triples if s.startswith("_:")}) == 2


def test_an_ontology_without_a_name_gets_that_of_the_import(write):
    path = write("a.ttl", ontology("http://o.org/a", "http://o.org/b"))
    write("b.ttl", "<http://o.org/b#C> a <http://www.w3.org/2002/07/owl#Class> .")
    gathered = gather([path], {})
    assert gathered.missing == missing_imports(gathered.triples) == ()


@pytest.mark.parametrize("name", ["nowhere.ttl", "."])
def test_an_unreadable_file_is_reported(tmp_path, name):
    with pytest.raises(errors.BadFile, match="there is no"):
        gather([tmp_path / name], {})


@pytest.mark.parametrize(
    ("files", "given", "count", "missing"),
    [
        (["soma/SOMA-ALL.owl"], {}, 12, ()),
        (["soma"], {}, 16, ()),
        (["knowrob/PR2.owl"], {}, 6, ("http://www.ease-crc.org/ont/SOMA.owl",)),
        (["knowrob/PR2.owl"], {"http://www.ease-crc.org/ont/SOMA.owl": "soma/SOMA.owl"}, 8, ()),
        (["knowrob/knowrob.owl", "soma/SOMA-HOME.owl"], {}, 15, ()),
        (["oro/oro.owl"], {}, 1, ()),
        (["bfo"], {}, 2, ()),
    ],
)
@pytest.mark.process  # not Turtle
def test_real_ontologies_are_read_with_their_imports(files, given, count, missing):
    folder = data_folder() / "ontologies"
    if not folder.is_dir():
        pytest.skip(f"there is no {folder}")
    gathered = gather([folder / file for file in files], {iri: folder / file for iri, file in given.items()})
    assert (len(gathered.files), gathered.missing) == (count, missing)
    assert ontology_files.missing_imports(gathered.triples) == missing


@pytest.mark.process  # not Turtle
def test_blank_nodes_of_two_functional_documents_are_different(tmp_path):
    """Their labels are numbered alike, and anonymous individuals may have equal labels."""
    for name in ("one", "two"):
        (tmp_path / f"{name}.ofn").write_text(
            f"Prefix(:=<http://o.org/{name}#>) Ontology(<http://o.org/{name}>"
            " SubClassOf(:A ObjectSomeValuesFrom(:p :B)) ObjectPropertyAssertion(:p :x _:p0n0) )"
        )
    found = ontology_files.gather([tmp_path], {}).triples
    nodes = {name: {o for s, _, o in found if f"/{name}#" in s and o[0] == "_"} for name in ("one", "two")}
    assert all(len(of_file) == 2 for of_file in nodes.values())
    assert nodes["one"].isdisjoint(nodes["two"])
    assert len({o for _, p, o in found if p == v.iri(f"{v.OWL}onProperty")}) == 2
    assert len({s for s, p, _ in found if p == v.iri(f"{v.OWL}onProperty")}) == 2


def test_a_file_import_is_read_only_below_the_ontology(write, tmp_path):
    write("secret.txt", "root:x:0:0\n")
    below = write("onto/parts/more.ttl", ontology("http://things.org/more"))
    away = write("away/far.ttl", ontology("http://things.org/far"))
    path = write(
        "onto/all.ttl",
        ontology("http://all.org", below.as_uri(), away.as_uri(), (tmp_path / "secret.txt").as_uri()),
    )
    gathered = gather([path], {})
    assert gathered.files == (path, below)
    assert set(gathered.missing) == {away.as_uri(), (tmp_path / "secret.txt").as_uri()}
    assert set(gather([path], {away.as_uri(): away}).files) == {path, below, away}
    assert set(gather([path, away], {}).files) == {path, below, away}


def test_an_ontology_that_is_given_too_takes_precedence_over_a_file_of_its_name(write):
    first = write("a.ttl", ontology("http://o.org/a", "http://o.org/b"))
    write("b.ttl", ontology("http://o.org/unlike"))
    second = write("two/x.ttl", ontology("http://o.org/b"))
    gathered = gather([first, second], {})
    assert set(gathered.files) == {first, second}
    assert gathered.found == {"http://o.org/b": second}
