"""The fast reader returns what Oxigraph reads, and reads nothing that Oxigraph rejects."""

import gc
import tracemalloc

import pyoxigraph
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from semmap.nodes.kb_node.documents import plain_turtle, plain_words, rdf
from semmap.ontology import vocabulary as v
from semmap.schemas import errors

HEAD = (
    f"@prefix : <{v.ABOX}> .\n@prefix dm: <{v.TBOX}> .\n@prefix xsd: <{v.XSD}> .\n"
    "@prefix odd: <http://x/a/../b?c=> .\n@prefix host: <http://x> .\n"
)
SUBJECTS = st.sampled_from(
    [":cup1", "<http://x/y#z>", "_:b1", "_:c.d", "odd:a", "host:b", "<y>", "<http://x/./y>"]
)
PREDICATES = st.sampled_from(["a", "dm:hasPosition", ":p-", "<http://x/p>", "<urn:a:b>", "odd:p"])
OBJECTS = st.sampled_from(
    [
        *(
            ":cup1",
            "dm:3Three_Dim_Size",
            "dm:a.b",
            "dm:a-b",
            "_:b1",
            "host:b",
            "odd:b",
            ":caffè",
            ":a\\,b",
            "()",
        ),
        *("<http://x:80/y>", "<rel>", "<urn:x>", "<http://x/%20y>", "<http://x/\\u0041>"),
        *(
            '"1.50"^^xsd:float',
            '"x"^^xsd:string',
            '"x"^^<urn:x>',
            '"x"^^dm:mine',
            '"Tasse"@de',
            '"Tasse"@DE-at',
        ),
        *("1", "-01", "+1.5", ".5", "1e3", "1.E3", "1.0e-7", "true", "false"),
        *('"coffee"', '""', '"caffè"', r'"a\nb"', r'"a\u0041"', r'"\""'),
        *('"a cup, of; tea ."', '"# no comment"', '"it\'s"', '"a\tb"'),
    ]
)
TYPED = st.builds('"{}"^^xsd:float'.format, st.text(alphabet='01.-e"\\è\x1f', max_size=4))
NAMED = st.builds("{}:{}".format, st.sampled_from(["", "dm", "x"]), st.text(alphabet="a1-_:.è", max_size=3))
BREAKS = st.sampled_from([" ", "\n", "\n\t", "  ", " # said\n", "\r\n"])
BAD = [
    "[]",
    ":a.",
    "<a b>",
    "un:known",
    '"open',
    "'x'",
    '"""x"""',
    "a",
    "a:",
    "@en",
    '"x"^^',
    "{",
    "<<:a",
    "1.",
    ":a#b",
]


def slowly(content):
    """Read with Oxigraph."""
    quads = pyoxigraph.parse(content, pyoxigraph.RdfFormat.TURTLE, base_iri=v.ABOX)
    return rdf._triples(quads, "f", lambda _: None)


def quickly(content):
    return plain_turtle.read(content, rdf._declared_prefixes(content, "turtle"), "f", lambda _: None)


@st.composite
def statements(draw):
    """Statements in Turtle with line breaks anywhere."""
    text = ""
    for _ in range(draw(st.integers(1, 4))):
        words = [draw(SUBJECTS)]
        for number in range(draw(st.integers(1, 3))):
            words += [*([";"] if number else []), draw(PREDICATES), draw(OBJECTS)]
            for _ in range(draw(st.integers(0, 2))):
                words += [",", draw(OBJECTS)]
        words += draw(st.sampled_from([["."], [";", "."]]))
        plain = draw(st.booleans())
        text += "".join(word + (" " if plain else draw(BREAKS)) for word in words)[:-1] + "\n"
    return text


@st.composite
def triples_in_full(draw):
    """Many lines of one triple each, most of them of words without spaces."""
    lines = draw(st.lists(st.tuples(SUBJECTS, PREDICATES, st.one_of(OBJECTS, TYPED, NAMED)), max_size=12))
    breaks = draw(st.sampled_from([" .\n", " .\n", " .\r\n", ".\n", " ;\n", "\u00a0.\n", "\x0b.\n"]))
    return "".join(" ".join(words) + (breaks if i == 3 else " .\n") for i, words in enumerate(lines))


@pytest.fixture
def few_are_many(monkeypatch):
    """Treat each kind of words as frequent."""
    monkeypatch.setattr(plain_words, "_FEWEST", 1)


@settings(deadline=None, max_examples=500, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(triples_in_full())
@example(':a :p "1"^^xsd:float .\n:b :p ""^^xsd:float .\n')
@example(':a :p "^^xsd:float .\n:b :p "a"b"^^xsd:float .\n')
@example(":a :p ::b .\n:a :p :-b .\n")
def test_columns_give_the_result_of_oxigraph(few_are_many, text):
    content = (HEAD + text).encode()
    read = quickly(content)
    if read is not None:
        assert read == slowly(content)


def test_a_file_as_programs_write_it_is_read_in_columns(monkeypatch):
    lines = "".join(
        f':t{i} a dm:Chair .\n:t{i} dm:float_size_x "{i}.5"^^xsd:float .\n:t{i} :p <http://x/y#{i}> .\n'
        for i in range(300)
    )
    content = (HEAD + "# made by a program\n\n" + lines).encode()
    monkeypatch.setattr(
        plain_turtle._Reader, "_read_words", _only_declarations(plain_turtle._Reader._read_words)
    )
    read = quickly(content)
    assert read == slowly(content)
    assert len(read) == 900


def _only_declarations(read_words):
    def checked(self, line):
        assert not line or line[0] in "@#", line
        read_words(self, line)

    return checked


@pytest.mark.parametrize(
    "words",
    [
        [":a", ":b:c"],
        [":a", ":"],
        [":a", ":-b"],
        [":a", ":b.c"],
        [":a", ":caffè"],
        ['"1"^^xsd:float', '"^^xsd:float'],
        ['"1"^^xsd:float', '"a"b"^^xsd:float'],
        ['"1"^^xsd:float', '"\\t"^^xsd:float'],
        ['"1"^^xsd:float', '"è"^^xsd:float'],
        ['"1"^^xsd:float', '"1^^xsd:float'],
    ],
)
def test_a_kind_with_unusual_words_is_left_out(few_are_many, words):
    assert plain_words.plain_terms(words, {"": "http://x#"}, lambda kind: f"<{kind}>") == {}


def test_many_words_of_a_kind_are_converted_at_once(few_are_many):
    found = plain_words.plain_terms(
        [":a_1-b", ":2", "x:y", "<http://x>", '"1.5"^^xsd:float', '""^^xsd:float', '"x"@de'],
        {"": "http://x#"},
        lambda kind: "<http://f>" if kind == "xsd:float" else None,
    )
    assert found == {
        ":a_1-b": "<http://x#a_1-b>",
        ":2": "<http://x#2>",
        '"1.5"^^xsd:float': '"1.5"^^<http://f>',
        '""^^xsd:float': '""^^<http://f>',
    }


@settings(deadline=None, max_examples=300)
@given(statements())
@example(":cup1 a dm:Cup .\n:cup1 a dm:Cup ;\n\ta :x , :y ;\n\n\t. # done\n")
def test_the_result_equals_that_of_oxigraph(text):
    content = (HEAD + text).encode()
    read = quickly(content)
    if read is not None:
        assert read == slowly(content)


@settings(deadline=None, max_examples=100)
@given(statements(), st.sampled_from(BAD), st.integers(0, 60))
def test_a_document_that_oxigraph_rejects_is_not_read(text, bad, at):
    words = text.split(" ")
    words.insert(min(at, len(words)), bad)
    content = (HEAD + " ".join(words)).encode()
    read = quickly(content)
    if read is not None:
        assert read == slowly(content)  # it raises for invalid words


@pytest.mark.parametrize(
    "text",
    [
        ':cup1 a dm:Cup .\r\n:cup1 dm:lexicalReference "cup" .\r\n',
        ":cup1 a dm:Cup ;\n\tdm:hasPosition :p , :q ;\n\tdm:x 1.5 .\n# the end",
        ":cup1 a dm:Cup,\n        dm:Thing ;\n    dm:x 1,\n        2 .\n",
        "###  http://x/y\n:cup1 rdf:type dm:Cup ;\n".replace("rdf:type", "a") + '      dm:label "Tasse"@de .',
        "<http://x/y> <http://x/p> _:a .\n",
    ],
)
def test_the_usual_output_of_programs_is_read(text):
    content = (HEAD + text).encode()
    assert quickly(content) == slowly(content)


@pytest.mark.parametrize(
    "text",
    [
        ":a :p [ :q 1 ] .",
        ":a :p (1 2) .",
        ':a :p """two\nlines""" .',
        "@base <http://y/> .\n:a :p <b> .",
        ":a :p 1 .\n@prefix : <http://y/> .\n:a :p 1 .",
        "PREFIX x: <http://y/>\n:a :p 1 .",
    ],
)
def test_unusual_documents_are_left_to_oxigraph(text):
    assert quickly((HEAD + text).encode()) is None


@pytest.mark.parametrize(
    "text", [":a :p 1", ":a :p .", ":a :p 1 ;", '"a" :p 1 .', ":a 1 1 .", ":a _:p 1 .", ":a :p 1 2 ."]
)
def test_errors_are_left_to_oxigraph(text):
    content = (HEAD + text).encode()
    assert quickly(content) is None
    with pytest.raises(SyntaxError):
        slowly(content)


def test_pieces_end_at_any_line_end(monkeypatch):
    content = (
        HEAD + "".join(f':cup{i} a dm:Cup ;\n\tdm:x "{i}"@de ,\n\t\t{i} .\n' for i in range(50))
    ).encode()
    expected = slowly(content)
    told = []
    for size in range(1, 60, 7):
        monkeypatch.setattr(plain_turtle, "_PIECE", size)
        assert (
            plain_turtle.read(content, rdf._declared_prefixes(content, "turtle"), "f", told.append)
            == expected
        )
    assert max(told) == len(expected)


def test_the_word_cache_is_limited(monkeypatch):
    monkeypatch.setattr(plain_turtle, "_REMEMBERED", 3)
    content = (HEAD + "".join(f":cup{i} a dm:Cup .\n:cup{i} dm:x {i} .\n" for i in range(20))).encode()
    assert quickly(content) == slowly(content)


def test_a_large_document_is_read_with_the_fast_reader(monkeypatch):
    monkeypatch.setattr(rdf, "_LARGE", 0)
    content = (HEAD + ":cup1 a dm:Cup .\n_:b dm:x :cup1 .\n").encode()
    assert rdf.parse(content, "f.ttl", label_prefix="f") == slowly(content)
    assert ("_:fb", v.dm("x"), v.entity_iri("cup1")) in rdf.parse(content, "f.ttl", label_prefix="f")
    with pytest.raises(errors.BadFile, match="line 9"):
        rdf.parse(content + b":cup2 a\n.", "f.ttl")
    with pytest.raises(errors.BadFile, match=r"not UTF-8 text \(line 6"):
        rdf.parse(content.replace(b"Cup", b"C\xfcp"), "f.ttl")


def test_the_reader_releases_its_memory():
    content = (HEAD + "".join(f":thing{i} dm:isOn :table{i} .\n" for i in range(5000))).encode()
    gc.disable()
    tracemalloc.start()
    try:
        count = len(quickly(content))
        kept, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
        gc.enable()
    assert count == 5000
    assert kept < 200_000
