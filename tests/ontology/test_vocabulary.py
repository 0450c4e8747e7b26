import pyoxigraph
import pytest
import rdflib
from hypothesis import given
from hypothesis import strategies as st

from semmap.ontology import vocabulary as v

TEXTS = st.text(st.characters(codec="utf-8"))
LANGUAGES = st.from_regex(r"[a-z]{2,3}(-[a-z]{2})?", fullmatch=True)


def parsed(term: str) -> rdflib.Literal:
    graph = rdflib.Graph().parse(data=f"<urn:s> <urn:p> {term} .\n", format="nt")
    (literal,) = graph.objects()
    assert isinstance(literal, rdflib.Literal)
    return literal


@given(TEXTS)
def test_rdflib_reads_the_text_that_was_written(text: str) -> None:
    assert str(parsed(v.literal(text))) == text


@given(TEXTS, LANGUAGES)
def test_rdflib_reads_language_and_datatype(text: str, lang: str) -> None:
    assert parsed(v.literal(text, lang=lang)) == rdflib.Literal(text, lang=lang)
    typed = parsed(v.literal(text, "<urn:d>"))
    assert (str(typed), str(typed.datatype)) == (text, "urn:d")


@given(TEXTS)
def test_lexical_undoes_literal(text: str) -> None:
    assert v.lexical(v.literal(text)) == text
    assert v.lexical(v.literal(text, v.XSD_FLOAT)) == text
    assert v.lexical(v.literal(text, lang="it")) == text


@given(TEXTS, st.none() | LANGUAGES)
def test_literals_are_written_as_oxigraph_prints_them(text: str, lang: str | None) -> None:
    assert v.literal(text, lang=lang) == str(pyoxigraph.Literal(text, language=lang))


@given(TEXTS)
def test_lexical_reads_what_rdflib_writes(text: str) -> None:
    graph = rdflib.Graph()
    graph.add((rdflib.URIRef("urn:s"), rdflib.URIRef("urn:p"), rdflib.Literal(text)))
    written = graph.serialize(format="nt").removeprefix("<urn:s> <urn:p> ").rstrip("\n").removesuffix(" .")
    assert v.lexical(written) == text


@pytest.mark.parametrize(
    ("term", "text"),
    [
        (r'"caff\u00E8"', "caffè"),
        (r'"\U0001F600"', "\U0001f600"),
        (r'"it\'s"', "it's"),
        (r'"a\\n"', "a\\n"),
        ('"1.0"^^<http://www.w3.org/2001/XMLSchema#float>', "1.0"),
        ('"sedia"@it', "sedia"),
    ],
)
def test_every_escape_is_read(term: str, text: str) -> None:
    assert v.lexical(term) == text


@pytest.mark.parametrize(
    "term", ["<urn:a>", "_:b", "plain", '"open', '"a"b"', r'"\x"', r'"\u12"', '"a"@', '"a"^^urn:d']
)
def test_invalid_literals_are_rejected(term: str) -> None:
    with pytest.raises(ValueError, match="literal"):
        v.lexical(term)


def test_datatype_and_language() -> None:
    assert v.datatype_of('"a"') == v.XSD_STRING
    assert v.datatype_of('"a"@EN-gb') == v.RDF_LANG_STRING
    assert v.datatype_of('"1"^^<urn:d>') == "<urn:d>"
    assert v.language_of('"a"@EN-gb') == "en-gb"
    assert v.language_of('"a"') is None
    assert v.literal("a", v.XSD_STRING) == v.literal("a") == '"a"'
    with pytest.raises(ValueError, match="not both"):
        v.literal("a", v.XSD_FLOAT, "en")


@pytest.mark.parametrize(
    ("term", "name"),
    [
        (v.dm("3Three_Dim_Size"), "3Three_Dim_Size"),
        (v.entity_iri("chair1"), "chair1"),
        (v.TBOX_ONTOLOGY, "semantic_mapping_domain_model"),
        ("<urn:plain>", "plain"),
        ("<urn:x:cup1>", "cup1"),
        ('"a#b"', '"a#b"'),
        ("_:b0", "_:b0"),
    ],
)
def test_local_name(term: str, name: str) -> None:
    assert v.local_name(term) == name


def test_a_triple_in_words_has_the_names_of_individuals():
    triple = ("<http://x#9a>", "<http://x#2p>", "<http://x#my%20cup>")
    assert v.to_words(triple) == "_9a 2p my_x20_cup"
    assert v.to_words(("<http://x#a>", v.RDF_TYPE, v.THREE_DIM_SIZE)) == "a type 3Three_Dim_Size"
