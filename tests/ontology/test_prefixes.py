import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v

SOMA, DUL = prefixes.WELL_KNOWN["soma"], prefixes.WELL_KNOWN["dul"]
namespaces = st.builds(
    "http://{}.org/{}{}".format,
    st.sampled_from("ab"),
    st.sampled_from(["", "x/", "x.owl", "v1.0/y"]),
    st.sampled_from("#/"),
)
locals_ = st.sampled_from(["A", "B", "x", "", "a:b", "tazzinà", "杯子", "A%20b"])
iris = st.lists(st.builds("<{}{}>".format, namespaces, locals_), unique=True, max_size=12)


@pytest.mark.parametrize(
    ("namespace", "prefix"),
    [
        (SOMA, "soma"),
        ("http://schema.org/", "schema"),
        ("http://x.org/onto/lab.owl#", "lab"),
        ("http://x.org/onto/v1.2/", "onto"),
        ("http://www.example.org/", "example"),
        ("http://x.org/Meine%20Küche#", "meine_k_che"),
        ("urn:robots:", "robots"),
        ("http://x.org/dul#", "dul2"),
        ("http://x.org/floor2#", "floor2"),
        ("http://x.org/hall_3/", "hall_3"),
        ("http://x.org/3rd-floor#", "rd-floor"),
        ("http://x.org/bfo-2.0.owl#", "bfo"),
        ("http://x.org/lab_v1.2#", "lab"),
    ],
)
def test_a_prefix_is_known_or_made_from_the_namespace(namespace, prefix):
    assert prefixes.prefixes_of([namespace]) == {prefix: namespace}


@pytest.mark.parametrize("words", [("floor2", "floor3"), ("hall_2", "hall_3"), ("b/lab2", "a/lab2", "lab")])
def test_a_number_in_a_prefix_is_that_of_the_namespace_if_it_has_one(words):
    found = prefixes.prefixes_of([f"http://x.org/{word}#" for word in words])
    for prefix, namespace in found.items():
        meant = namespace.rpartition("/")[2].removesuffix("#")
        assert prefix == meant or (prefix not in words and prefix.startswith(meant))


def test_what_is_declared_is_taken_unless_it_means_something_else():
    declared = {"http://x.org/a#": "Kit", "http://x.org/b#": "soma", "http://x.org/c#": "9"}
    assert prefixes.prefixes_of(declared, declared) == {
        "kit": "http://x.org/a#", "soma2": "http://x.org/b#", "c": "http://x.org/c#"
    }  # fmt: skip


@given(st.lists(namespaces), st.randoms())
def test_no_two_namespaces_have_one_prefix_in_any_order(given, random):
    shuffled = random.sample(given, len(given))
    assert prefixes.prefixes_of(shuffled) == prefixes.prefixes_of(given)
    assert sorted(prefixes.prefixes_of(given).values()) == sorted(set(given))


def test_only_ambiguous_names_get_a_prefix():
    there = [f"<{SOMA}Color>", f"<{DUL}Color>", f"<{SOMA}Cup>"]
    assert list(prefixes.names(there, {"soma": SOMA, "dul": DUL}).values()) == [
        "soma:Color",
        "dul:Color",
        "Cup",
    ]


@given(iris)
def test_every_iri_has_a_name_of_its_own(iris):
    known = prefixes.prefixes_of(prefixes.split(iri)[0] for iri in iris)
    names = prefixes.names(iris, known)
    assert set(names) == set(iris)
    assert len(set(names.values())) == len(iris)
    assert all(names.values())


@given(iris)
def test_an_iri_is_its_namespace_and_its_local_name(iris):
    assert all(f"<{''.join(prefixes.split(iri))}>" == iri for iri in iris)


def test_what_a_file_declares_is_kept_among_the_triples():
    lab, c = "http://x.org/lab#", "http://x.org/c#"
    triples = [(f"<{ns}C>", v.RDF_TYPE, v.OWL_CLASS) for ns in (lab, c, v.TBOX)]
    said = prefixes.declarations({"Kit": lab, "owl": v.OWL, "": v.ABOX}, triples)
    assert prefixes.declared_in(said) == {lab: "kit", c: "c"}
    assert prefixes.declarations({}, [*triples, *said]) == said


def test_a_tbox_in_well_known_words_needs_no_declarations():
    assert prefixes.declarations({"house": v.TBOX}, [(v.dm("C"), v.RDF_TYPE, v.OWL_CLASS)]) == []
