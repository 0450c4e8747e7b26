"""The words of relations in descriptions."""

import pytest

from semmap.nodes.language.lexicon import describing
from semmap.schemas.relations import RELATIONS


@pytest.mark.parametrize(
    ("text", "relation"),
    [
        ("accanto", "isNextTo"),
        ("accanto a", "isNextTo"),
        ("accanto agli", "isNextTo"),
        ("accanto all'", "isNextTo"),
        ("sulle", "isOn"),
        ("nello", "isInside"),
        ("alla", "isInside"),
        ("sulla destra del", "isRightOf"),
        ("appoggiate ai", "isLeaningAgainst"),
        ("sopra al", "isAbove"),
        ("fuori", "outside"),
        ("tra", "isBetween"),
    ],
)
def test_italian_relations_with_and_without_an_article(text, relation):
    italian = describing.load("italian")
    assert italian.sense(tuple(italian.split(text)))["relations"] == relation


def test_english_has_no_contractions():
    assert list(describing.load("english").contract_last("next to")) == []


@pytest.mark.parametrize("language", describing.LANGUAGES)
def test_every_phrase_of_the_table_is_known(language):
    words = describing.load(language)
    for row in RELATIONS:
        for phrase in getattr(row, language):
            assert words.sense(tuple(words.split(phrase)))["relations"] == row.name
