import pytest

from semmap.nodes.kb_node.documents import language_tags, rdf
from semmap.ontology import vocabulary as v

SYNTAXES = ["turtle", "ntriples", "rdfxml", "jsonld"]


@pytest.mark.parametrize(
    ("tag", "usual"),
    [
        ("en", "en"),
        ("en-gb", "en-GB"),
        ("zh-hant-tw", "zh-Hant-TW"),
        ("sl-rozaj-1994", "sl-rozaj-1994"),
        ("de-ch-x-phonebk-ab", "de-CH-x-phonebk-ab"),
        ("x-us", "x-us"),
    ],
)
def test_a_tag_gets_its_usual_case(tag, usual):
    assert language_tags.format_tag(tag) == usual


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_only_tags_change(syntax):
    texts = ['x"@en-gb', "y\\", 'z xml:lang="en-gb" <a xml:lang="en-gb">', '{"@language": "en-gb"}', "\n"]
    triples = [("<urn:a:@en-gb>", "<urn:p:>", v.literal(text, lang="en-gb")) for text in texts]
    triples += [("<urn:a:@en-gb>", "<urn:p:>", v.literal(text)) for text in texts]
    document = language_tags.restore_case(rdf.serialise(triples, syntax), syntax)
    assert document.count(b"en-GB") == len(texts)
    assert sorted(rdf.parse(document, "f")) == sorted(triples)


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_a_document_without_regions_stays_as_it_is(syntax):
    document = rdf.serialise([("<urn:a>", "<urn:p:>", v.literal("cup", lang="en"))], syntax)
    assert language_tags.restore_case(document, syntax) is document


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_text_that_begins_like_a_tag_stays(syntax):
    texts = ["x", "@living-room", "@info-de", "y"]
    triples = [("<urn:a:a>", "<urn:p:>", v.literal(text)) for text in texts]
    triples.append(("<urn:a:b>", "<urn:p:>", v.literal("z", lang="en-gb")))
    document = language_tags.restore_case(rdf.serialise(triples, syntax), syntax)
    assert [document.count(part) for part in (b"@living-room", b"@info-de", b"en-GB")] == [1, 1, 1]
