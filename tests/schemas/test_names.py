"""Names of entities in every script: as IRIs, as chunks of keys, as commands have them."""

import re
import unicodedata

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from semmap.ontology import vocabulary as v
from semmap.schemas import codec, errors, keys
from semmap.schemas.commands import Add, Get, Remove
from semmap.schemas.entities import NAME_PATTERN, composed, free_name, is_name, name_of_text
from semmap.schemas.scene_files import Described

GOOD = ["chair1", "_", "A.b-c_9", "tazzinà", "杯子", "кружка_2", "फूल", "कुर्सी", "كوب", "ถ้วย", "x" * 128]
BAD = [
    "",
    "1chair",
    "a b",
    "a/b",
    "a*",
    "a$",
    "a?b",
    "a#b",
    "a\n",
    "-a",
    ".a",
    "😀",
    "a😀",
    "x" * 129,
    "a%20",
    "a:b",
    "“a”",
]
names = st.from_regex(NAME_PATTERN, fullmatch=True).map(composed)


@pytest.mark.parametrize("name", GOOD)
def test_letters_of_every_script_make_a_name(name):
    assert codec.convert({"class": "Cup", "name": name}, Add).name == composed(name)


@pytest.mark.parametrize("name", BAD)
def test_invalid_names_are_rejected_in_one_sentence(name):
    with pytest.raises(
        errors.BadRequest, match=r"name must be a valid name: up to 128 letters, digits, '_', '.'"
    ):
        codec.convert({"class": "Cup", "name": name}, Add)


def test_however_a_letter_is_typed_the_name_is_the_same():
    decomposed = unicodedata.normalize("NFD", "tazzinà")
    assert decomposed != "tazzinà"
    assert Add(class_="Cup", name=decomposed).name == "tazzinà"
    assert codec.convert({"name": decomposed}, Get).name == "tazzinà"
    assert Remove(names=(decomposed, "b")).names == ("tazzinà", "b")
    assert Described(class_="Cup", name=decomposed).name == "tazzinà"


@given(names)
def test_a_name_is_its_iris_name_and_its_keys_chunk(name):
    assert v.entity_name(v.entity_iri(name)) == name
    key = keys.entity_key("Cup", name)
    assert str(zenoh.KeyExpr(key)) == key
    assert keys.of_entity(key) == ("Cup", name)


@given(st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1), names)
def test_any_name_of_a_class_is_one_chunk_of_a_key(class_name, name):
    key = keys.entity_key(class_name, name)
    assert str(zenoh.KeyExpr(key)) == key
    assert key.count("/") == 4
    assert keys.of_entity(key) == (class_name, name)
    assert zenoh.KeyExpr("semmap/jena/entity/*/*").includes(zenoh.KeyExpr(key))


def test_a_plain_prefix_is_readable_in_a_key():
    assert keys.entity_key("soma:Color", "杯子") == "semmap/jena/entity/soma:Color/杯子"


@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=12))
def test_every_text_has_a_name_from_which_it_can_be_read(text):
    name = name_of_text(text)
    assert is_name(name)
    assert name_of_text(name) == name
    decoded = re.sub("_x([0-9A-F]+)_", lambda code: chr(int(code[1], 16)), name)
    assert composed(text) in (decoded, decoded.removeprefix("_")) or "_x" in text


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("chair1", "chair1"),
        ("_x24_", "_x24_"),
        ("0$aB", "_0_x24_aB"),
        ("-a", "_-a"),
        ("😀", "_x1F600_"),
        ("a/b", "a_x2F_b"),
        ("", "_"),
    ],
)
def test_the_name_of_a_text(text, name):
    assert name_of_text(text) == name


def test_long_texts_with_the_same_beginning_have_different_names():
    one, other = (name_of_text("x" * 200 + end) for end in "ab")
    assert one != other
    assert is_name(one)
    assert is_name(other)


def test_escapes_that_are_not_text_stay():
    assert v.entity_name("<http://x#a%FF>") == "a_x25_FF"


def test_escapes_of_an_iri_are_not_part_of_the_name():
    assert v.entity_name("<http://x#tazzin%C3%A0>") == "tazzinà"


@pytest.mark.parametrize(
    ("class_name", "name"),
    [("Cup", "cup2"), ("soma:Color", "color1"), ("Tazza_Però", "tazza_però1"), ("6DPose", "_6dpose1")],
)
def test_a_name_made_from_the_class(class_name, name):
    assert free_name(class_name, {"cup1"}) == name
    assert re.match(NAME_PATTERN, name)
