import pytest

from semmap.nodes.kb_node.documents import named_graphs, rdf
from semmap.schemas import errors

HEAD = "@prefix : <urn:m#> .\n"
TRIG = HEAD + ":a :p :b . GRAPH :g1 { :c :p :d . :c :p :e } <http://o.org/g2> { :f :p :g }"
NQUADS = (
    "<urn:m#a> <urn:m#p> <urn:m#b> .\n<urn:m#c> <urn:m#p> <urn:m#d> <urn:m#g1> .\n"
    "<urn:m#c> <urn:m#p> <urn:m#e> <urn:m#g1> . # twice\n<urn:m#f> <urn:m#p> <urn:m#g> <http://o.org/g2> ."
)
JSONLD = """{"@context": {"@vocab": "urn:m#", "@base": "urn:m", "p": {"@type": "@id"}}, "@graph": [
    {"@id": "#a", "p": "#b"},
    {"@id": "#g1", "@graph": [{"@id": "#c", "p": ["#d", "#e"]}]},
    {"@id": "http://o.org/g2", "@graph": [{"@id": "#f", "p": "#g"}]}]}"""
ALL = [TRIG, NQUADS, JSONLD]
A, C, F = {"<urn:m#a>"}, {"<urn:m#c>"}, {"<urn:m#f>"}


def subjects(content, graph=""):
    document = rdf.read(content.encode(), "f", graph=graph)
    return {s for s, _, _ in document.triples}, document.notes


@pytest.mark.parametrize("content", ALL, ids=["trig", "nquads", "jsonld"])
def test_the_default_graph_is_read_and_the_others_are_counted(content):
    note = "left out: 3 statements in other graphs (g2: 1 and g1: 2); to load such a graph use --graph NAME"
    assert subjects(content) == (A, (note,))


@pytest.mark.parametrize("content", ALL, ids=["trig", "nquads", "jsonld"])
@pytest.mark.parametrize(
    ("name", "found"),
    [("g1", C), ("urn:m#g1", C), ("<urn:m#g1>", C), ("g2", F), ("http://o.org/g2", F)],
)
def test_a_named_graph_is_read_by_its_name(content, name, found):
    there, notes = subjects(content, name)
    assert there == found
    assert "the default graph: 1" in notes[0]


def test_a_prefix_of_the_file_is_part_of_a_name():
    assert subjects(TRIG, ":g1")[0] == C


@pytest.mark.parametrize(
    ("content", "graph", "text"),
    [
        (
            TRIG,
            "g3",
            r"f: there is no graph 'g3'; it has 4 statements in its graphs \(g2: 1, g1: 2 and the def",
        ),
        (f"{HEAD} <urn:x#g> {{ :a :p :b }} <urn:y#g> {{ :a :p :b }}", "g", "'g' is ambiguous: <urn:x#g> and"),
        (
            f"{HEAD} :g {{ :a :p :b }}",
            "",
            r"its default graph is empty; it has 1 .*\(g: 1\).* load --graph NAME",
        ),
        (f"{HEAD} {{ :a :p :b }}", "g", "there is no graph 'g'; it has no named graphs"),
        (f"{HEAD} :a :p :b .", "g", "f is Turtle, which has no graphs; load it without --graph"),
        (f"{HEAD} :a :p :b . :g {{ :a :p }}", "", "f is not valid TriG: .*line 2"),
    ],
)
def test_a_graph_that_cannot_be_chosen_is_an_error(content, graph, text):
    with pytest.raises(errors.BadFile, match=text):
        rdf.read(content.encode(), "f", graph=graph)


def test_statements_of_a_nameless_graph_are_counted():
    assert subjects(f"{HEAD} :a :p :b . _:x {{ :a :p :b }}") == (
        A,
        ("left out: 1 statement in other graphs (a blank node: 1)",),
    )


def test_blank_nodes_of_a_graph_get_the_prefix_of_the_file():
    ((s, _, o),) = rdf.read(b"GRAPH <urn:g> { _:x <urn:p> [] }", "f", graph="g", label_prefix="f1").triples
    assert s == "_:f1x"
    assert o.startswith("_:f1")


@pytest.mark.parametrize(
    ("content", "syntax"),
    [
        (TRIG, "trig"),
        ("{ <urn:a> <urn:b> <urn:c> }", "trig"),
        ("{ ex:a ex:b ex:c }", "trig"),
        (NQUADS, "nquads"),
        ("<urn:a> <urn:b> <urn:c> .\n" * 9000 + '_:a <urn:b> "c"@en <urn:d> .', "nquads"),
        (f'{HEAD} :a :p "{{", \'}}{{\', """{{ "{{" """, <urn:x> . # {{', "turtle"),
        (f'{HEAD} :a :p """\n<urn:a> <urn:b> <urn:c> <urn:d> .\n"""@en ; :q 1 .', "turtle"),
        ("# a comment\n\n" + NQUADS.replace("\n", "\r\n"), "nquads"),
        ('{"@id": "urn:a"}', "jsonld"),
        ("{}", "jsonld"),
    ],
)  # fmt: skip
def test_documents_with_graphs_are_recognised(content, syntax):
    assert rdf.syntax_of(content.encode()) == syntax


def test_a_text_may_end_with_the_file():
    assert not named_graphs.has_braces(b'<urn:a> <urn:b> """ {')
