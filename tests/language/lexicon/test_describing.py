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


@pytest.mark.parametrize(
    ("noun", "with_article", "pronoun"),
    [
        ("tavolo", "il tavolo", "quello"),
        ("tazza", "la tazza", "quella"),
        ("scaffale", "lo scaffale", "quello"),
        ("armadio", "l'armadio", "quello"),
        ("acqua", "l'acqua", "quella"),
        ("forbici", "le forbici", "quelle"),
        ("occhiali", "gli occhiali", "quelli"),
        ("scaffali", "gli scaffali", "quelli"),
        ("libri", "i libri", "quelli"),
        ("Anna", "Anna", "quella"),
    ],
)
def test_an_italian_noun_has_an_article_and_a_pronoun(noun, with_article, pronoun):
    italian = describing.load("italian")
    assert italian.with_article(noun) == with_article
    assert italian.pronoun_for(noun) == pronoun


def test_an_english_noun_has_the_article_the_unless_it_is_a_name():
    english = describing.load("english")
    assert english.with_article("cup") == "the cup"
    assert english.with_article("Anna") == "Anna"
    assert english.pronoun_for("cup") == "the one"


@pytest.mark.parametrize(
    ("adjective", "noun", "inflected"),
    [
        ("rosso", "tazza", "rossa"),
        ("rosso", "tavolo", "rosso"),
        ("verde", "tazza", "verde"),
        ("blu", "tazza", "blu"),
        ("bianco", "porta", "bianca"),
    ],
)
def test_an_adjective_agrees_with_its_noun(adjective, noun, inflected):
    assert describing.load("italian").inflect(adjective, noun) == inflected


@pytest.mark.parametrize(
    ("text", "contracted"),
    [
        ("la tazza su il tavolo", "la tazza sul tavolo"),
        ("il libro di la cucina", "il libro della cucina"),
        ("accanto a lo scaffale", "accanto allo scaffale"),
        ("la tazza rossa", "la tazza rossa"),
    ],
)
def test_a_preposition_and_an_article_are_contracted(text, contracted):
    assert describing.load("italian").contract(text) == contracted


def test_the_last_word_of_a_phrase_is_contracted_with_each_article():
    phrases = list(describing.load("italian").contract_last("accanto a"))
    assert {"accanto al", "accanto alla", "accanto allo", "accanto ai", "accanto agli"} <= set(phrases)
    assert all(phrase.startswith("accanto a") for phrase in phrases)


@pytest.mark.parametrize(
    ("language", "text", "words"),
    [
        ("english", "The blue-green Cup!", ["the", "blue", "green", "cup"]),
        ("english", "Anna's cup isn't red", ["anna", "'s", "cup", "is", "n't", "red"]),
        ("english", "the one called 'novel'", ["the", "one", "called", "novel"]),
        ("english", "the boys' cup", ["the", "boys", "'", "cup"]),
        ("english", "Anna’s cup", ["anna", "'s", "cup"]),
        ("italian", "l'acqua nell'armadio", ["l'", "acqua", "nell'", "armadio"]),
        ("italian", "che cos'e' sul tavolo", ["che", "cos'", "è", "sul", "tavolo"]),
        ("italian", "più grande", ["più", "grande"]),
        ("english", "cup_1", ["cup", "1"]),
        ("english", "?!", []),
    ],
)
def test_a_text_is_split_into_words(language, text, words):
    assert describing.load(language).split(text) == words


@pytest.mark.parametrize(
    ("language", "word", "base"),
    [
        ("english", "cups", "cup"),
        ("english", "glasses", "glasses"),
        ("english", "shelves", "shelf"),
        ("english", "knives", "knife"),
        ("english", "people", "person"),
        ("italian", "tazza", "tazz"),
        ("italian", "tazze", "tazz"),
        ("italian", "bianche", "bianc"),
        ("italian", "bianchi", "bianc"),
        ("italian", "grigio", "grig"),
        ("italian", "grigi", "grig"),
        ("italian", "blu", "blu"),
        ("italian", "via", "via"),
        ("italian", "zio", "zio"),
        ("italian", "forbici", "forbici"),
    ],
)
def test_the_base_of_a_word_is_the_same_for_all_its_forms(language, word, base):
    assert describing.load(language).base(word) == base


def test_a_plurale_tantum_may_also_be_a_plural():
    assert describing.load("english").singular_of("glasses") == "glass"
    assert describing.load("english").singular_of("cups") == "cups"
    assert describing.load("italian").singular_of("occhiali") == "occhiali"


@pytest.mark.parametrize(
    ("word", "is_known"), [("red", False), ("on", True), ("nearest", True), ("cup", False)]
)
def test_words_of_the_lexicon_are_not_taken_for_typing_errors(word, is_known):
    assert describing.load("english").has(word) == is_known
