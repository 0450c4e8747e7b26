"""Words of classes, values and properties in sentences."""

import pytest

from semmap.nodes.kb_node.reasoner.explain.words import (
    VerbPhrase,
    Words,
    article,
    base_form,
    is_uncountable,
    local_name,
)
from tests.kb_node.reasoner.graphs import triples

LABELS = """
:on rdfs:label "is on"@en , "è su"@it . :supports rdfs:label "supports"@en .
:color a owl:DatatypeProperty ; rdfs:label "has color" . :open rdfs:label "is open" .
:Cup rdfs:label "cup"@en-GB , "tazza"@it . :Mug rdfs:label "Becher"@de , "mug" .
:Bar1 rdfs:label "bar"@en . :Bar2 rdfs:label "bar"@en . :Pub rdfs:label "pub"@en .
:mass a owl:DatatypeProperty . :address a owl:ObjectProperty . :needs a owl:DatatypeProperty .
:weighs a owl:DatatypeProperty . :opensAt a owl:DatatypeProperty . :hours a owl:DatatypeProperty .
"""
WORDS = Words.of(triples(LABELS))


def term(name):
    return f"<http://example.org/{name}>"


def value(text, kind):
    return f'"{text}"^^<http://www.w3.org/2001/XMLSchema#{kind}>'


@pytest.mark.parametrize(
    ("phrase", "object_", "negation", "pronoun", "count", "plural"),
    [
        (VerbPhrase("is", "on"), "is on x", "is not on x", "is on x", "is on one cup", "are on"),
        (
            VerbPhrase("has", "part"),
            "has part x",
            "does not have part x",
            "has x as part",
            "has one part that is a cup",
            "have part",
        ),
        (
            VerbPhrase("does", "supports"),
            "supports x",
            "does not support x",
            "supports x",
            "supports one cup",
            "support",
        ),
        (
            VerbPhrase("does", "contains zone"),
            "contains zone x",
            "does not contain zone x",
            "contains x as zone",
            "contains zone one cup",
            "contain zone",
        ),
        (
            VerbPhrase("does", "stands on"),
            "stands on x",
            "does not stand on x",
            "stands on x",
            "stands on one cup",
            "stand on",
        ),
    ],
)
def test_each_kind_of_verb_phrase_in_each_position(phrase, object_, negation, pronoun, count, plural):
    assert phrase.with_object("x") == object_
    assert phrase.with_negation("x") == negation
    assert phrase.with_pronoun("x") == pronoun
    assert phrase.with_count("one", "cup") == count
    assert phrase.plural == plural


def test_a_number_without_a_class_counts_things():
    assert VerbPhrase("is", "on").with_count("at most one") == "is on at most one thing"
    assert VerbPhrase("is", "on").with_count("no") == "is on nothing"
    assert VerbPhrase("is", "on").with_count("no", "cup") == "is on no cup"
    assert VerbPhrase("has", "color").with_count("at most one") == "has at most one color"


@pytest.mark.parametrize(
    ("name", "kind", "rest"),
    [
        ("on", "is", "on"),
        ("supports", "does", "supports"),
        ("color", "has", "color"),
        ("mass", "has", "mass"),
        ("needs", "has", "needs"),
        ("weighs", "does", "weighs"),
        ("opensAt", "does", "opens at"),
        ("hours", "has", "hours"),
        ("sameAs", "is", "same as"),
        ("address", "has", "address"),
        ("has_part", "has", "part"),
        ("isOn", "is", "on"),
        ("is", "has", "is"),
        ("partOf", "is", "part of"),
        ("looksAt", "does", "looks at"),
        ("gas", "has", "gas"),
        ("bus-line", "has", "bus line"),
        ("hasURLText", "has", "URL text"),
    ],
)
def test_a_property_is_a_verb_phrase(name, kind, rest):
    assert WORDS.verb_phrase(term(name)) == VerbPhrase(kind, rest)


def test_the_label_of_a_property_begins_in_lower_case():
    words = Words.of(triples(':p rdfs:label "Has part" . :q rdfs:label "URL" . :r rdfs:label "Is on" .'))
    found = [words.verb_phrase(term(name)) for name in "pr"]
    assert found == [VerbPhrase("has", "part"), VerbPhrase("is", "on")]
    assert words.verb_phrase(term("q")).rest.endswith("URL")


def test_labels_in_english_come_before_those_without_a_language_and_others_are_not_used():
    assert WORDS.cls(term("Cup")) == "cup"
    assert WORDS.cls(term("Mug")) == "mug"
    assert Words.of(triples(':A rdfs:label "a" , "b"@en .')).cls(term("A")) == "b"
    assert Words.of(triples(':A rdfs:label "b"@en . :A rdfs:label "a" .')).cls(term("A")) == "b"
    assert Words.of(triples(':Tisch rdfs:label "Tisch"@de .')).cls(term("Tisch")) == "Tisch"


def test_only_classes_with_equal_labels_get_other_names():
    words = Words.of(triples(LABELS))
    words.disambiguate({term("Bar1"): "ex:Bar1", term("Bar2"): "other:Bar2", term("Pub"): "ex:Pub"})
    assert [words.cls(term(name)) for name in ("Bar1", "Bar2", "Pub")] == ["ex:Bar1", "other:Bar2", "pub"]


@pytest.mark.parametrize(
    ("found", "name"),
    [
        (term("cup1"), "cup1"),
        ("<http://example.org/a#b/>", "b"),
        ("_:b1", "_:b1"),
        ('"red"', '"red"'),
        ('"rot"@de', '"rot"'),
        (value("1.5", "float"), "1.5"),
        (value("INF", "double"), "INF"),
        (value("true", "boolean"), "true"),
        (value("1.5", "string"), '"1.5"'),
        (value("many", "integer"), '"many"'),
        (value("", "integer"), '""'),
    ],
)
def test_the_name_of_an_individual_or_a_value(found, name):
    assert WORDS.name(found) == name


def test_a_truth_value_is_a_part_of_the_verb():
    true, false = value("true", "boolean"), value("0", "boolean")
    assert WORDS.predicate_phrase(term("open"), true) == "is open"
    assert WORDS.predicate_phrase(term("open"), false) == "is not open"
    assert WORDS.predicate_phrase(term("open"), true, negated=True) == "is not open"
    assert WORDS.predicate_phrase(term("open"), false, negated=True) == "is open"
    assert WORDS.predicate_phrase(term("color"), true) == "has color true"
    assert WORDS.predicate_phrase(term("open"), value("maybe", "boolean")) == 'is open "maybe"'
    assert WORDS.predicate_phrase(term("open"), value("1", "integer")) == "is open 1"


def test_a_predicate_with_its_object():
    cup = term("cup1")
    assert WORDS.predicate_phrase(term("on"), cup) == "is on cup1"
    assert WORDS.predicate_phrase(term("on"), cup, negated=True) == "is not on cup1"
    assert WORDS.predicate_phrase(term("has_part"), cup, reflexive=True) == "has itself as part"
    assert WORDS.predicate_phrase(term("supports"), cup, reflexive=True) == "supports itself"
    assert WORDS.predicate_phrase(term("has_part"), cup, negated=True, reflexive=True) == (
        "does not have part itself"
    )


def test_data_properties_are_known():
    assert WORDS.is_data(term("color"))
    assert not WORDS.is_data(term("address"))


@pytest.mark.parametrize(
    ("noun", "found"),
    [
        ("cup", "a cup"),
        ("apple", "an apple"),
        ("Oven", "an Oven"),
        *(("Unit", "a Unit"), ("utensil", "a utensil"), ("USB hub", "a USB hub")),
        *(("Urgent", "an Urgent"), ("umbrella", "an umbrella"), ("unopened jar", "an unopened jar")),
        ("orange juice", "orange juice"),
        ("tableware", "tableware"),
        ("something red", "something red"),
        ("one of a and b", "one of a and b"),
        ("a cup", "a cup"),
        ('"quoted"', '"quoted"'),
        ("", ""),
    ],
)
def test_a_noun_with_its_article(noun, found):
    assert article(noun) == found


def test_only_the_last_word_decides_whether_a_noun_is_counted():
    assert is_uncountable("olive oil")
    assert not is_uncountable("oil can")


@pytest.mark.parametrize(
    ("verb", "base"),
    [
        ("carries it", "carry it"),
        ("touches", "touch"),
        ("passes by", "pass by"),
        ("fixes", "fix"),
        ("goes", "go"),
        ("looks at", "look at"),
        ("uses", "use"),
        ("can", "can"),
    ],
)
def test_a_verb_after_does_not(verb, base):
    assert base_form(verb) == base


def test_the_local_name_is_the_last_part_of_an_iri():
    assert local_name("<urn:x:y>") == "urn:x:y"
    assert local_name("<http://example.org/a/b#c>") == "c"
    assert local_name("<http://example.org/a/>") == "a"
    assert local_name("</>") == "</>"
