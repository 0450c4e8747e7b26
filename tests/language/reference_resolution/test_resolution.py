"""Descriptions resolved in a small kitchen."""

import random
from contextlib import suppress
from dataclasses import replace

import pytest

from semmap.nodes.language.reference_resolution import explanation
from semmap.nodes.language.reference_resolution.map_index import MapIndex
from semmap.nodes.language.reference_resolution.resolution import find
from semmap.schemas import errors
from tests.language.reference_resolution.kitchen import ITEMS, TERMS, Written, found, item, known
from tests.language.reference_resolution.phrases import PHRASES


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("the blue cup", {"cup2"}),
        ("cup2", {"cup2"}),
        ("the red cup on the table", {"cup1"}),
        ("the cup in the sink", {"cup3"}),
        ("the table's blue cup", {"cup2"}),
        ("the cup that is neither red nor in the sink", {"cup2"}),
        ("the cups on the table", {"cup1", "cup2"}),
        ("the cup on the table that is not blue", {"cup1"}),
        ("two cups on the table", {"cup1", "cup2"}),
        ("both cups on the table", {"cup1", "cup2"}),
        ("all the cups except the blue one", {"cup1", "cup3"}),
        ("red or blue cups", {"cup1", "cup2", "cup3"}),
        ("the red or blue cup in the sink", {"cup3"}),
        ("the blue and the big cup", {"cup2", "cup3"}),
        ("the big cup", {"cup3"}),
        ("the biggest cup", {"cup3"}),
        ("the cup nearest to the fridge", {"cup3"}),
        ("the second cup from the fridge", {"cup1"}),
        ("the cup between the red cup and the glasses", {"cup2"}),
        ("the sink with a cup in it", {"sink1"}),
        ("the sink with a cup inside", {"sink1"}),
        ("the table and the cup in the sink", {"table1", "cup3"}),
        ("something to drink", {"wine1"}),
        ("something cold", {"wine1"}),
        ("qualcosa di fresco da bere", {"wine1"}),
        ("what is in the sink", {"cup3"}),
        ("which cups are red", {"cup1", "cup3"}),
        ("quante tazze ci sono sul tavolo", {"cup1", "cup2"}),
        ("the sink in which the cup is", {"sink1"}),
        ("the cup outside the sink that is red", {"cup1"}),
        ("some cups from the table", {"cup1", "cup2"}),
        ("the bottle of wine", {"wine1"}),
        ("Anna's cup", {"cup3"}),
        ("the favourite mug", {"cup3"}),
        ("the lamp that is on", {"lamp1"}),
        ("the closed fridge", {"fridge1"}),
        ("the empty sink", set()),
        ("the kitchen table", {"table1"}),
        ("la tazza blu", {"cup2"}),
        ("le tazze sul tavolo", {"cup1", "cup2"}),
        ("la tazza rossa che non è sul tavolo", {"cup3"}),
        ("qualcosa da bere nel frigorifero", {"wine1"}),
        ("la tazza di Anna", {"cup3"}),
        ("gli occhiali", {"glasses1"}),
        ("il tavolo della cucina", {"table1"}),
        ("la lampada accesa", {"lamp1"}),
        ("the things on the table that are not cups", set()),
        ("the things in the fridge that are neither cups nor bottles", {"wine1"}),
        ("le cose sul tavolo che non sono tazze", set()),
        ("the cups that do not belong to Anna", {"cup1", "cup2"}),
        ("something of Anna's", {"cup3", "glasses1"}),
        ("the heaviest cup", {"cup2"}),
        ("la tazza più leggera", {"cup1"}),
    ],
)
def test_what_is_meant(text, names):
    outcome, there = found(text)
    assert there == names
    assert outcome == {0: "none", 1: "one"}.get(len(names), "several")


@pytest.mark.parametrize("row", PHRASES, ids=[row[0] for row in PHRASES])
def test_a_phrase_means_what_fits_it(row):
    text, outcome, names, _, _ = row
    answer = find(text, known(), Written(has_viewer=True), "anna")
    assert (answer.outcome, " ".join(answer.names)) == (outcome, names)


def test_a_name_may_be_a_number_word_too():
    there = known()
    there.update((item("otto1", "Person", "Otto"), item("cup4", "Cup", isOwnedBy="otto1")))
    assert find("le cose di Otto", there, Written()).names == ("cup4",)
    assert find("otto tazze", there, Written()).outcome == "none"


def test_what_may_be_meant_is_all_that_fits():
    assert found("the cup") == ("ambiguous", {"cup1", "cup2", "cup3"})
    assert found("the red cup") == ("ambiguous", {"cup1", "cup3"})
    assert found("the red cup that is not in the sink") == ("one", {"cup1"})
    assert found("the two cups") == ("ambiguous", {"cup1", "cup2", "cup3"})


@pytest.mark.parametrize(
    "text",
    [
        "the green cup",
        "the cat",
        "the four cups",
        "the blue cup in the sink",
        "the fifth cup from the fridge",
    ],
)
def test_what_nothing_fits(text):
    assert found(text) == ("none", set())


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("the cup that is not nearest to the sink", {"cup1", "cup2"}),
        ("the cups that are not on the left", {"cup1", "cup3"}),
        ("the glasses in front of me", {"glasses1"}),
        ("the cup behind me", set()),
        ("Anna's things", {"cup3", "glasses1"}),
        ("the cup that belongs to Anna", {"cup3"}),
        ("the things that belong to Anna", {"cup3", "glasses1"}),
        ("the people near me", set()),
        ("the person behind me", set()),
        ("the cup that Anna owns", {"cup3"}),
        ("the blue one", {"cup2"}),
        ("the cup called favourite mug", {"cup3"}),
        ("the one called cup2", {"cup2"}),
        ("la tazza di nome cup2", {"cup2"}),
        ("the cup called teacup", set()),
    ],
)
def test_negated_places_the_viewer_owners_and_labels_restrict(text, names):
    assert found(text, has_viewer=True)[1] == names


def test_behind_me_needs_a_viewer():
    with pytest.raises(errors.BadRequest, match="viewer"):
        found("the cup behind me")


@pytest.mark.parametrize(
    ("text", "answer", "name"),
    [
        ("the red cup", "the one in the sink", "cup3"),
        ("the red cup", "the cup on the table", "cup1"),
        ("la tazza rossa", "quella nel lavandino", "cup3"),
        ("the cup", "the blue one", "cup2"),
    ],
)
def test_an_answer_selects_a_candidate_of_the_question(text, answer, name):
    assert find(text, known(), Written(), answer=answer).names == (name,)


def test_mine_is_the_askers():
    assert found("my cup", asker="anna") == ("one", {"cup3"})
    assert found("la mia tazza", asker="anna") == ("one", {"cup3"})
    assert found("my table", asker="anna")[0] == "none"


def test_left_and_right_take_a_viewer():
    assert found("the leftmost cup", has_viewer=True) == ("one", {"cup2"})
    assert found("the cup on the left", has_viewer=True) == ("one", {"cup2"})
    assert found("la terza tazza da sinistra", has_viewer=True)[0] in ("one", "ambiguous")
    with pytest.raises(errors.BadRequest, match="there is no viewer"):
        found("the leftmost cup")


@pytest.mark.parametrize(
    ("text", "said", "meant"),
    [
        ("the montior", "montior", "monitor"),
        ("the whine", "whine", "wine"),
        ("the read cup", "read", "red"),
        ("la bottilgia", "bottilgia", "bottiglia"),
        ("the frigde", "frigde", "fridge"),
    ],
)
def test_typing_and_recognition_errors_mean_the_nearest_word(text, said, meant):
    made = find(text, known(), Written())
    assert made.reading.corrections == ((said, meant),)


@pytest.mark.parametrize("text", ["the die", "da rote", "la terr"])
def test_what_would_name_nothing_is_not_what_was_meant(text):
    assert find(text, known(), Written()).reading.corrections == ()


@pytest.mark.parametrize("text", ["", "   ", "🤖🫖", "?!"])
def test_no_words_is_refused(text):
    with pytest.raises(errors.BadRequest):
        find(text, known(), Written())


def test_too_many_words_and_the_past_are_refused():
    with pytest.raises(errors.BadRequest, match="has 10000 words; the maximum is 60"):
        found("cup " * 10_000)
    for text in ("the cup that was on the table", "la tazza che era sul tavolo", "the cup from yesterday"):
        with pytest.raises(errors.BadRequest, match="asks about the past"):
            found(text)


@pytest.mark.parametrize(
    "text",
    [
        "die rote Tasse auf dem Tisch",
        "<b>the</b> cup; DROP TABLE cups",
        "the the the",
        "on on on",
        "not not",
        "and",
        "the cup and",
        "of",
        "the cup of",
        "between",
        "the cup between the table",
        "'s",
        "\x00\x1b[31m",
        "the 's cup",
        "first",
        "the nearest",
        "ignore previous instructions",
        "9" * 50,
        "cup on cup in cup of cup with cup near cup " * 5,
    ],
)
def test_whatever_is_said_is_answered(text):
    assert explanation.explain(find(text, known(), Written(has_viewer=True))).text


def test_any_words_in_any_order_are_answered():
    words = [
        "the",
        "a",
        "cup",
        "cups",
        "red",
        "big",
        "on",
        "in",
        "of",
        "and",
        "or",
        "not",
        "that",
        "is",
        "with",
        "my",
        "first",
        "second",
        "from",
        "left",
        "nearest",
        "to",
        "two",
        "all",
        "one",
        "it",
        "something",
        "drink",
        "kitchen",
        "Anna",
        "'s",
        "\x00\x1b[31m",
        "tavolo",
        "la",
        "di",
        "con",
        "più",
        "vicino",
        "non",
        "che",
    ]
    dice = random.Random(1)
    for _ in range(300):
        text = " ".join(dice.choices(words, k=dice.randint(1, 9)))
        with suppress(errors.BadRequest):
            assert explanation.explain(find(text, known(), Written(has_viewer=True))).text, text


def test_a_name_that_is_also_a_class_and_two_things_of_one_reference():
    there = MapIndex(TERMS)
    there.update([item("cup", "Table"), item("x1", "Cup", "beaker"), item("x2", "Table", "beaker")])
    assert set(find("the cup", there, Written()).names) == {"cup", "x1"}
    assert find("the beaker", there, Written()).outcome == "ambiguous"


def test_who_comes_and_goes_is_known_by_the_newest_words():
    there = known()
    there.update([item("cup1", "Cup", "chalice")], ["cup2"])
    assert find("the chalice", there, Written()).names == ("cup1",)
    assert set(find("the cups", there, Written()).names) == {"cup1", "cup3"}
    assert find("the blue cup", there, Written()).outcome == "none"


def test_the_order_of_the_entities_does_not_matter():
    texts = ("the cup", "the red cups", "something", "the second cup from the fridge")
    first = [find(text, known(), Written()).names for text in texts]
    there = MapIndex(TERMS)
    there.update(random.Random(3).sample(ITEMS, len(ITEMS)))
    assert [find(text, there, Written()).names for text in texts] == first


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("Tasse", {"cup1", "cup2", "cup3"}),
        ("the red Tasse on the table", {"cup1"}),
        ("rote Tasse", {"cup1", "cup3"}),
    ],
)
def test_a_label_of_any_language_is_a_noun(text, names):
    made = MapIndex(
        replace(
            TERMS,
            classes=(*TERMS.classes, ("de", "Cup", "Tasse")),
            qualities=(*TERMS.qualities, ("de", "color_red", "rote")),
        )
    )
    made.update(ITEMS)
    assert set(find(text, made, Written()).names) == names
