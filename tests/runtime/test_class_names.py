from __future__ import annotations

import pytest

from nodes.runtime.class_names import ClassNames
from schemas.entities import ClassInfo
from schemas.errors import UnknownClass


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


def test_a_label_is_a_hint():
    with pytest.raises(UnknownClass, match="unknown class 'Sedia'; did you mean Chair"):
        NAMES.find("Sedia")


def test_what_was_not_taken_literally_is_said():
    assert NAMES.note("LivingRoom", NAMES.find("LivingRoom")) == ("'LivingRoom' is read as Livingroom",)
    assert NAMES.note("Chair", NAMES.find("Chair")) == ()


def test_an_exact_name_wins_over_a_folded_one():
    names = ClassNames([info("TV"), info("Tv")])
    assert names.find("Tv").name == "Tv"
    with pytest.raises(UnknownClass, match="did you mean TV or Tv"):
        names.find("tv")


def test_an_unknown_class_is_told_with_the_nearest():
    with pytest.raises(UnknownClass, match="unknown class 'Chiar'; did you mean Chair"):
        NAMES.find("Chiar")


def test_nothing_can_be_of_an_abstract_class():
    with pytest.raises(UnknownClass, match="no class of things in space"):
        NAMES.spatial("Color")
