import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rdflib import Graph
from rdflib.compare import isomorphic

from semmap.nodes.kb_node.documents import rdf
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node.graphs import canonical

RDFLIB = {"rdfxml": "xml", "turtle": "turtle", "ntriples": "nt", "jsonld": "json-ld"}
SYNTAXES = list(RDFLIB)
XML_TEXT = st.text(
    st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"], exclude_characters="\ufffe\uffff")
)
TEXTS = XML_TEXT | st.sampled_from(["", " ", "a\r\nb\tc", "\r", "<&>\"'", "]]>", "{", "\\", "caffè 🪑"])
IRIS = st.sampled_from(
    [v.dm("Chair"), v.entity_iri("chair1"), v.dm("3Three_Dim_Size"), "<urn:a:b>", "<http://x/%20y?z=1>"]
)
BLANKS = st.sampled_from(["_:a", "_:b1", "_:c.d"])
LITERALS = st.one_of(
    st.builds(v.literal, TEXTS),
    st.builds(v.literal, TEXTS, lang=st.sampled_from(["en", "en-gb"])),
    st.sampled_from(["1", "01", "1.0", "-0.0", "1e-07", "NaN", "x", ""]).flatmap(
        lambda text: st.sampled_from(["float", "double", "integer", "boolean", "decimal"]).map(
            lambda name: v.literal(text, v.iri(v.XSD + name))
        )
    ),
)
PREDICATES = st.sampled_from([v.RDF_TYPE, v.HAS_POSITION, v.dm("3d"), "<http://x/p>"])
TRIPLES = st.lists(st.tuples(IRIS | BLANKS, PREDICATES, IRIS | BLANKS | LITERALS), max_size=6, unique=True)


@settings(deadline=None, max_examples=60)
@given(TRIPLES, st.sampled_from(SYNTAXES))
def test_a_written_document_is_read_back(triples, syntax):
    triples = [*triples, ("<urn:x>", "<urn:y>", "<urn:z>")]
    read = rdf.parse(rdf.serialise(triples, syntax), "f")
    assert canonical(read) == canonical(triples)


@pytest.mark.filterwarnings("ignore:ConjunctiveGraph:DeprecationWarning")  # of rdflib's JSON-LD reader
@pytest.mark.parametrize("syntax", SYNTAXES)
def test_other_programs_read_the_same(syntax):
    triples = [
        (v.entity_iri("chair1"), v.RDF_TYPE, v.dm("Chair")),
        (v.entity_iri("chair1"), v.LEXICAL_REFERENCE, v.literal("two\r\nlines <&>")),
        (v.entity_iri("chair1"), v.HAS_POSITION, "_:here"),
        ("_:here", v.dm("3d"), v.literal("1.50", v.XSD_FLOAT)),
    ]
    written = rdf.serialise(triples, syntax)
    expected = Graph().parse(data=rdf.serialise(triples, "ntriples"), format="nt")
    assert isomorphic(Graph().parse(data=written, format=RDFLIB[syntax]), expected)


def test_output_is_sorted_and_prefixed():
    chair, table = ((v.entity_iri(n), v.RDF_TYPE, v.dm(n.capitalize())) for n in ("chair", "table"))
    turtle = rdf.serialise([table, chair], "turtle")
    assert turtle == rdf.serialise([chair, table], "turtle")
    assert b":chair a dm:Chair" in turtle


def test_a_character_that_xml_cannot_express_is_rejected():
    triples = [("<urn:a>", "<urn:b>", v.literal("bell\x07"))]
    with pytest.raises(errors.Refused, match=r"cannot hold the character '\\x07'; export as Turtle"):
        rdf.serialise(triples, "rdfxml")
    assert rdf.parse(rdf.serialise(triples, "turtle"), "f") == triples


XML = b"""<?xml version="1.0"?>
<!DOCTYPE rdf:RDF [ <!ENTITY xsd "http://www.w3.org/2001/XMLSchema#" > <!ENTITY dm "urn:dm#" > ]>
<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns="urn:dm#" xml:base="urn:map">
  <rdf:Description rdf:about="#a"><p rdf:datatype="&xsd;float">1.0</p>
    <q rdf:resource="&dm;b"/></rdf:Description>
</rdf:RDF>
"""
TURTLE = b'@prefix : <urn:map#> .\n:a :p "1.0" ; :q [ :r :b ] .\n'
NTRIPLES = b'<urn:a> <urn:p> "1.0" .\n<urn:a> <urn:q> <urn:b> .\n'
JSONLD = b'[{"@id": "urn:a", "urn:p": [{"@value": "1.0"}, {"@id": "urn:b"}]}]'


def test_namespaces_abbreviated_as_xml_entities_are_read():
    assert set(rdf.parse(XML, "f")) == {
        ("<urn:map#a>", "<urn:dm#p>", f'"1.0"^^{v.XSD_FLOAT}'),
        ("<urn:map#a>", "<urn:dm#q>", "<urn:dm#b>"),
    }


def declaring(entities, text):
    return XML.replace(b"]>", entities + b"]>").replace(b">1.0<", b">" + text + b"<")


LAUGHS = b'<!ENTITY l0 "lol">' + b"".join(
    f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">'.encode() for i in range(1, 10)
)


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (declaring(LAUGHS, b"&l9;"), "amplification"),
        (declaring(b'<!ENTITY e "' + b"x" * 10**5 + b'">', b"&e;" * 10**4), "amplification"),
        (declaring(b'<!ENTITY e SYSTEM "file:///etc/passwd">', b"&e;"), "the external entity 'e'"),
        (declaring(b"", b"&gone;"), "undefined entity"),
    ],
)
def test_external_and_recursive_xml_entities_are_rejected(content, text):
    with pytest.raises(errors.BadFile, match=text):
        rdf.parse(content, "evil.owl")


@pytest.mark.parametrize("content", [XML, JSONLD], ids=["rdfxml", "jsonld"])
def test_a_truncated_file_is_rejected_wherever_it_ends(content):
    for end in range(1, len(content.rstrip())):
        with pytest.raises(errors.BadFile, match=r"^cut "):
            rdf.parse(content[:end], "cut")


@pytest.mark.parametrize(("content", "whole"), [(TURTLE, len(TURTLE) - 1), (NTRIPLES, len(NTRIPLES) - 1)])
def test_a_truncated_statement_is_rejected(content, whole):
    last_but_one = content.rindex(b"\n", 0, whole) + 1
    for end in range(last_but_one + 1, whole):
        with pytest.raises(errors.BadFile, match=r"^cut .* line 2"):
            rdf.parse(content[:end], "cut")


@pytest.mark.parametrize("content", [XML, TURTLE, NTRIPLES, JSONLD])
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_document_with_a_byte_order_mark_is_read(content, encoding):
    assert len(rdf.parse(content.decode().encode(encoding), "f")) == len(rdf.parse(content, "f"))


def test_xml_in_latin_1_with_a_relative_base_is_read():
    content = XML.replace(b'"1.0"?', b'"1.0" encoding="ISO-8859-1"?').replace(b"urn:map", b"kitchen")
    ((subject, _, text),) = [t for t in rdf.parse(content.replace(b">1.0<", b">\xe8<"), "f") if '"' in t[2]]
    assert (subject, text) == (f"<{v.ABOX.rpartition('/')[0]}/kitchen#a>", f'"\xe8"^^{v.XSD_FLOAT}')


@pytest.mark.parametrize(
    ("content", "syntax"),
    [
        (XML, "rdfxml"),
        (b'\n<rdf:RDF\n xmlns:rdf="urn:x">', "rdfxml"),
        (b"<!-- map -->", "rdfxml"),
        (TURTLE, "turtle"),
        (b'<urn:a> <http://xmlns.com/foaf/0.1/name> "xmlns" .', "turtle"),
        (b"[ a <urn:Map> ] .", "turtle"),
        (b"[] a <urn:Map> .", "turtle"),
        (JSONLD, "jsonld"),
        (b'{"@id": "urn:a"}', "jsonld"),
    ],
)
def test_the_syntax_is_recognised_by_the_content(content, syntax):
    assert rdf.syntax_of(content) == syntax


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"", "f is empty"),
        (b"\xef\xbb\xbf\n\n", "f is empty"),
        (b'<urn:a> <urn:b> "x" .\n<urn:a> <urn:b> "caff\xe8" .', r"f: it is not UTF-8 text \(line 2\)"),
        (TURTLE.decode().encode("utf-16")[:-1], r"f: it is not UTF-16-LE text \(line 2\)"),
        (b"\x89PNG\r\n\x1a\n", "f: it is not UTF-8 text"),
        (b"<html><body>hi</body></html>", r"f is not valid Turtle: .*line 1"),
        (b"<urn:a b> <urn:p> <urn:c> .", "Invalid IRI code point ' '"),
        (
            b'{"@context": "http://127.0.0.1:9/c", "@id": "urn:a", "p": "x"}',
            "nothing is fetched from the network",
        ),
        (
            b'{"@context": {"@import": "http://127.0.0.1:9/c"}, "p": "x"}',
            "nothing is fetched from the network",
        ),
        (b"<urn:a> <urn:b> <<( <urn:a> <urn:b> <urn:c> )>> .", "a statement about a triple"),
    ],
)
def test_an_invalid_document_is_reported_in_one_line(content, text):
    with pytest.raises(errors.BadFile, match=text) as caught:
        rdf.parse(content, "f")
    assert "\n" not in caught.value.text


_RDF = b'<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"'


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (
            _RDF + b'\n xmlns:o="urn:o:">\n<o:A rdf:about="http://x y"/>\n</rdf:RDF>',
            "' ' (line 3)",
        ),
        (_RDF + b">\n\n<rdf:Description>\n<rdf:x>a<b/>\n</rdf:x></rdf:Description>\n</rdf:RDF>", "(line 4)"),
        (_RDF + b">\n<rdf:Description>\n</rdf:RDF>", "line 3"),
        (
            b'{"@context": {"a": "urn:a:"},\n"@id": "a:b",\n"a:c": {"@id": "a:d", "@value": 1}}\n',
            "before line 3)",
        ),
        (b'{"@id": "urn:a",\n"urn:b":,}', "line 2"),
        (b"<urn:a> <urn:b> <urn:c> .\n<urn:a> <urn:b> .\n", "line 2"),
    ],
)
def test_an_error_has_its_line(content, text):
    with pytest.raises(errors.BadFile) as caught:
        rdf.parse(content, "f")
    assert text in caught.value.text


def test_imports_are_only_triples():
    content = b"<urn:o> <http://www.w3.org/2002/07/owl#imports> <http://127.0.0.1:9/never> ."
    assert rdf.parse(content, "f") == [("<urn:o>", v.OWL_IMPORTS, "<http://127.0.0.1:9/never>")]


def test_blank_nodes_of_two_files_are_different():
    (a,), (b,) = (rdf.parse(b"_:x <urn:p> _:x .", "f", label_prefix=p) for p in ("a", "b"))
    assert a[0] == a[2] != b[0]


@pytest.mark.parametrize(
    ("syntax", "document"),
    [("Turtle", b"%s"), ("Turtle", b'<x:a> <x:b> "%s" .'), ("JSON-LD", b'{"@id": "x:a", "x:b": "%s"}')],
)
def test_a_word_that_exceeds_the_buffer_is_reported_as_an_error_of_the_file(syntax, document):
    with pytest.raises(
        errors.BadFile, match=f"not valid {syntax}: it has a word or a text of more than 16 MB"
    ):
        rdf.parse(document % (b"a" * (17 << 20)), "big")


def test_an_error_of_turtle_has_its_line_once():
    with pytest.raises(errors.BadFile) as caught:
        rdf.parse(b"hello world\n", "a.ttl", label_prefix="t")
    assert caught.value.text == (
        "a.ttl is not valid Turtle: line 1 between columns 1 and 6: hello is not a valid subject or graph"
        " name"
    )
