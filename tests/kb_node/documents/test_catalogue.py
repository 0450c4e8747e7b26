"""Files that an XML catalogue lists for an ontology."""

import pytest

from semmap.nodes.kb_node.documents import catalogue
from semmap.schemas import errors

HEAD = '<catalog xmlns="urn:oasis:names:tc:entity:xmlns:xml:catalog">'
IRI = "http://o.org/a"


@pytest.fixture
def folder(tmp_path):
    for name in ("a.ttl", "b c.ttl", "sub/a.ttl", "next/a.ttl"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    return tmp_path.resolve()


def find(folder, entries, iri=IRI, name=catalogue.FILENAME):
    (folder / name).write_text(f"{HEAD}{entries}</catalog>")
    return catalogue.find(folder, iri)


@pytest.mark.parametrize(
    ("entry", "path"),
    [
        (f'<uri name="{IRI}" uri="a.ttl"/>', "a.ttl"),
        (f'<system systemId="{IRI}" uri="a.ttl"/>', "a.ttl"),
        (f'<uri name="{IRI}" uri="b%20c.ttl"/>', "b c.ttl"),
        (f'<group><uri name="{IRI}" uri="a.ttl"/></group>', "a.ttl"),
        (f'<group xml:base="sub/"><uri name="{IRI}" uri="a.ttl"/></group>', "sub/a.ttl"),
        ('<rewriteURI uriStartString="http://o.org/" rewritePrefix="sub/"/>', None),
        ('<rewriteURI uriStartString="http://o.org/a" rewritePrefix="sub/a.ttl"/>', "sub/a.ttl"),
        ('<rewriteSystem systemIdStartString="http://o.org/a" rewritePrefix="a.ttl"/>', "a.ttl"),
        ('<rewriteURI uriStartString="http://else.org/" rewritePrefix="a.ttl"/>', None),
        (f'<uri name="{IRI}" uri="gone.ttl"/><uri name="{IRI}" uri="a.ttl"/>', "a.ttl"),
        ('<uri name="http://o.org/b" uri="a.ttl"/>', None),
        (f'<uri name="{IRI}" uri="http://o.org/a.ttl"/>', None),
        (f'<uri name="{IRI}" uri="file://elsewhere/a.ttl"/>', None),
        (f'<public name="{IRI}" uri="a.ttl"/>', None),
        ("", None),
    ],
)
def test_an_entry_leads_to_an_existing_file(folder, entry, path):
    assert find(folder, entry) == (path and folder / path)


def test_a_file_uri_may_be_absolute(folder):
    for host in ("", "localhost"):
        assert find(folder, f'<uri name="{IRI}" uri="file://{host}{folder}/a.ttl"/>') == folder / "a.ttl"


def test_another_catalogue_comes_after_the_own_entries(folder):
    (folder / "next.xml").write_text(f'{HEAD}<uri name="{IRI}" uri="next/a.ttl"/></catalog>')
    further = '<nextCatalog catalog="next.xml"/>'
    assert find(folder, further) == folder / "next/a.ttl"
    assert find(folder, f'{further}<uri name="{IRI}" uri="a.ttl"/>') == folder / "a.ttl"
    assert find(folder, '<nextCatalog catalog="gone.xml"/>') is None
    assert find(folder, '<nextCatalog catalog="http://o.org/next.xml"/>' + further) == folder / "next/a.ttl"


def test_catalogues_that_refer_to_each_other_come_to_an_end(folder):
    (folder / "next.xml").write_text(f'{HEAD}<nextCatalog catalog="{catalogue.FILENAME}"/></catalog>')
    assert find(folder, '<nextCatalog catalog="next.xml"/>') is None


def test_a_folder_without_a_catalogue_has_no_entries(folder):
    assert catalogue.find(folder, IRI) is None


def test_an_invalid_catalogue_is_named(folder):
    with pytest.raises(errors.BadFile, match=r"catalog-v001\.xml is not a valid XML catalogue"):
        find(folder, "<uri>")
