from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.runtime.class_names import ClassNames
from semmap.schemas.entities import ClassInfo
from semmap.schemas.errors import UnknownClass


def info(name: str, *, spatial: bool = True, italian: str = "") -> ClassInfo:
    return ClassInfo(
        name=name, iri=f"http://x#{name}", parents=(), ancestors=(), labels={"it": italian}, spatial=spatial,
        place=False, fixed=False, model="",
    )  # fmt: skip


NAMES = ClassNames(
    [
        info("Livingroom"),
        info("Chair", italian="sedia"),
        info("Washing_Machine"),
        info("Color", spatial=False),
    ]
)


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("Chair", "Chair"),
        ("chair", "Chair"),
        ("LivingRoom", "Livingroom"),
        ("Living_room", "Livingroom"),
        ("washingmachine", "Washing_Machine"),
    ],
)
def test_case_and_underscores_do_not_matter(word, found):
    assert NAMES.find(word).name == found


@pytest.mark.parametrize("word", ["sedia", "Sedia", "se_dia"])
def test_a_label_is_understood(word):
    found = NAMES.find(word)
    assert found.name == "Chair"
    assert NAMES.note(word, found) == (f"'{word}' is read as Chair",)


def test_a_name_wins_over_a_label():
    names = ClassNames([info("Table"), info("Desk", italian="table")])
    assert names.find("table").name == "Table"


def test_an_ambiguous_label_is_rejected_with_the_candidates():
    names = ClassNames([info("Cup", italian="tazza"), info("Mug", italian="Tazza")])
    with pytest.raises(UnknownClass, match="'tazza' is ambiguous: Cup or Mug; use one of these names"):
        names.find("tazza")


def test_the_nearest_label_is_suggested_with_its_class():
    with pytest.raises(UnknownClass, match=r"unknown class 'sedla'; did you mean Chair \('sedia'\)\?"):
        NAMES.find("sedla")


def twins() -> ClassNames:
    """Two classes of one local name."""
    color = info("dul:Color"), info("soma:Color")
    return ClassNames(structs.replace(c, iri=f"http://{c.name[:3]}#Color", prefixed=c.name) for c in color)


@pytest.mark.parametrize("word", ["Color", "color"])
def test_an_ambiguous_name_is_rejected_with_the_candidates(word):
    with pytest.raises(
        UnknownClass, match=f"'{word}' is ambiguous: dul:Color or soma:Color; use one of these names"
    ):
        twins().find(word)


@pytest.mark.parametrize("word", ["soma:Color", "SOMA:color", "http://som#Color", "<http://som#Color>"])
def test_a_prefix_or_an_iri_is_unambiguous(word):
    assert twins().find(word).name == "soma:Color"


def test_without_spatial_classes_the_error_has_the_next_step():
    names = ClassNames([info("Pizza", spatial=False)])
    with pytest.raises(UnknownClass, match=r"does not define .* --spatial-root CLASS"):
        names.spatial("Pizza")


def test_an_inexact_match_gets_a_note():
    assert NAMES.note("LivingRoom", NAMES.find("LivingRoom")) == ("'LivingRoom' is read as Livingroom",)
    assert NAMES.note("Chair", NAMES.find("Chair")) == ()


def test_an_exact_name_wins_over_a_folded_one():
    names = ClassNames([info("TV"), info("Tv")])
    assert names.find("Tv").name == "Tv"
    with pytest.raises(UnknownClass, match="'tv' is ambiguous: TV or Tv"):
        names.find("tv")


def test_an_unknown_class_is_reported_with_similar_ones():
    with pytest.raises(UnknownClass, match="unknown class 'Chiar'; did you mean Chair"):
        NAMES.find("Chiar")


def test_nothing_can_be_of_an_abstract_class():
    with pytest.raises(UnknownClass, match="is not a spatial class"):
        NAMES.spatial("Color")


@pytest.mark.parametrize("word", ["http://y.org/z#Chair", "<http://y.org/z#Chair>", "urn:z:chair"])
def test_an_iri_in_a_wrong_namespace_is_suggested_in_the_right_one(word):
    with pytest.raises(UnknownClass) as caught:
        NAMES.find(word)
    assert caught.value.text == f"unknown class '{word}'; did you mean <http://x#Chair>?"


def test_the_prefix_of_the_right_namespace_is_named():
    names = ClassNames([structs.replace(info("Chair"), prefixed="x:Chair")])
    with pytest.raises(UnknownClass, match=r"did you mean <http://x#Chair> \(prefix x:\)\?"):
        names.find("http://y#Chair")


def test_an_iri_without_a_namesake_is_compared_by_its_local_name():
    with pytest.raises(UnknownClass, match=r"unknown class 'http://x#Chiar'; did you mean Chair\?"):
        NAMES.find("http://x#Chiar")
