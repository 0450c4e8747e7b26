"""Italian words in the forms that commands have."""

import pytest

from semmap.nodes.language.lexicon.italian import _inflected, italian, singulars


@pytest.mark.parametrize(
    ("adjective", "forms"),
    [
        ("rosso", ["rosso", "rossa", "rosse", "rossi"]),
        ("bianco", ["bianco", "bianca", "bianche", "bianchi"]),
        ("lungo", ["lungo", "lunga", "lunghe", "lunghi"]),
        ("grigio", ["grigio", "grigia", "grigie", "grigi"]),
        ("verde", ["verde", "verdi"]),
        ("blu", ["blu"]),
    ],
)
def test_an_adjective_has_gender_and_number(adjective, forms):
    assert list(_inflected(adjective)) == forms


@pytest.mark.parametrize(
    ("plural", "singular"),
    [
        ("tavoli", "tavolo"),
        ("tazze", "tazza"),
        ("chiavi", "chiave"),
        ("banchi", "banco"),
        ("alberghi", "albergo"),
        ("banche", "banca"),
        ("righe", "riga"),
        ("fogli", "foglio"),
        ("arance", "arancia"),
        ("spiagge", "spiaggia"),
        ("armadi", "armadio"),
    ],
)
def test_a_plural_may_be_of_its_singular(plural, singular):
    assert next(iter(singulars(plural))) == plural
    assert singular in singulars(plural)


def test_a_very_short_word_is_not_a_plural():
    assert list(singulars("e")) == ["e"]
    assert list(singulars("ci")) == ["ci"]


@pytest.mark.parametrize(
    ("form", "english"),
    [
        ("porta", "bring"),
        ("porti", "bring"),
        ("portate", "bring"),
        ("portare", "bring"),
        ("portar", "bring"),
        ("prendi", "grab"),
        ("prenda", "grab"),
        ("prendete", "grab"),
        ("apri", "open"),
        ("aprite", "open"),
        ("cerca", "seek"),
        ("cerchi", "seek"),
    ],
)
def test_a_verb_is_known_in_its_forms(form, english):
    assert italian().verbs[form] == english
    assert italian().is_word(form)


@pytest.mark.parametrize("word", ["della", "nel", "rossa", "sul"])
def test_articles_in_prepositions_and_adjectives_are_words(word):
    assert italian().is_word(word)


def test_nouns_are_not_in_the_lexicon():
    assert not italian().is_word("frigorifero")


def test_verbs_of_motion_are_marked():
    assert {"vai", "vada"} & italian().moving
    assert "prendi" not in italian().moving
