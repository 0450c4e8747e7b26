"""Italian commands and their word-by-word translation."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.language.language_detection import detect_language
from semmap.nodes.language.lexicon.italian import italian as lexicon
from semmap.nodes.language.lexicon.italian import singulars
from semmap.nodes.language.understanding import italian
from semmap.nodes.language.understanding.interpretation import shipped
from semmap.nodes.training.language import made
from semmap.nodes.training.language.household import household
from tests.language.household import there


def frames(text):
    return [frame.text for frame in shipped().understand(text, there()).frames]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Portamela, per favore!", "porta me la per favore"),
        ("prendilo dall'armadio", "prendi lo dall' armadio"),
        ("dammi dell’acqua", "da mi dell' acqua"),
        ("puoi prendermelo", "puoi prender me lo"),
        ("va' in cucina e mettila lì", "va in cucina e metti la lì"),
        ("la palla e la scala", "la palla e la scala"),  # no clitics
        ("dalle del latte", "da le del latte"),
        ("vai dalle sedie", "vai dalle sedie"),
        ("", ""),
    ],
)
def test_clitics_are_words_of_their_own(text, words):
    assert " ".join(italian.split(text)) == words


@pytest.mark.parametrize(
    ("text", "english"),
    [
        ("prendi la bottiglia rossa", "grab the red bottle"),
        ("mi porti il libro", "bring me the book"),
        ("me lo porti", "bring me it"),
        ("prendi del latte dalla cucina", "grab some milk from the kitchen"),
        ("vai vicino al mio letto", "go near my bed"),
        ("prendi la tazza appoggiata al divano", "grab the cup against the couch"),
        ("apri la porta", "open the door"),
        ("porta la bottiglia", "bring the bottle"),
        ("gira a sinistra di 90 gradi", "turn left by 90 degrees"),
        ("vai a sinistra del divano", "go to the left of the couch"),
        ("prendine uno", "grab one"),
        ("spostati in camera da letto", "move in bedroom"),
        ("dai la bottiglia a me", "give the bottle to me"),
    ],
)
def test_words_are_translated_to_english(text, english):
    told = italian.gloss(text, there())
    assert " ".join(word.text for word in told.words if word.first <= word.last) == english


@pytest.mark.parametrize(
    ("text", "understood"),
    [
        ("prendi la bottiglia dal tavolo", ["Taking(Theme=bottle1, Source=table2)"]),
        ("può prendere la bottiglia?", ["Taking(Theme=bottle1)"]),
        ("la porti in cucina", ['Bringing(Theme="la", Goal=kitchen1)']),
        ("metti il libro sul divano", ["Placing(Theme=book1, Goal=couch1)"]),
        ("prendi il libro e portamelo", ["Taking(Theme=book1)", 'Bringing(Beneficiary="me", Theme=book1)']),
        ("non aprire il frigo", ["not Closure(Containing_object=fridge1)"]),
        ("seguimi lentamente", ['Cotheme(Cotheme="mi", Manner="lentamente")']),
        ("potresti andarci", ['Motion(Goal="ci")']),
        ("accendi la luce", ['Change_operational_state(Device="la luce")']),
        ("come stai", []),
        ("dov'è la bottiglia", []),
    ],
)  # fmt: skip
def test_a_command_is_frames_with_entities(text, understood):
    assert frames(text) == understood


def test_spans_are_of_the_words_that_were_said():
    understood = shipped().understand("mi porti la bottiglia dal tavolo della cucina?", there())
    beneficiary, theme, source = understood.frames[0].arguments
    assert (understood.language, understood.frames[0].verb) == ("italian", (2,))
    assert (beneficiary.span, theme.span, source.span) == ((1, 1), (3, 4), (5, 8))
    assert (source.text, understood.words[source.head - 1]) == ("dal tavolo della cucina", "tavolo")
    assert source.entity == "table1"  # which is called kitchen table


def test_a_thing_called_by_several_words_is_one():
    understood = shipped().understand("vai in camera da letto", there())
    assert (understood.frames[0].arguments[0].text, understood.frames[0].arguments[0].head) == (
        "in camera da letto",
        3,
    )


def test_an_unknown_verb_is_said_to_be_unknown():
    assert shipped().understand("frobnica la bottiglia", there()).unknown == ("frobnica",)


@pytest.mark.parametrize("text", ["guarda daniel", "prendi", "portamela", "la tazza è sul tavolo", "vacci"])
def test_italian_is_detected_by_its_words(text):
    assert detect_language(text) == "italian"


def test_english_commands_are_english():
    for example in made.examples(1, household()):
        assert detect_language(" ".join(example.words)) == "english", example.words
    assert detect_language("") == detect_language("xyzzy") == "english"


def test_a_language_may_be_said():
    assert shipped().understand("take the bottle", there(), "italian").language == "italian"
    assert shipped().understand("prendi la bottiglia", there(), "english").language == "english"


def test_synonyms_are_of_classes_of_the_household():
    assert set(lexicon().synonyms.values()) <= set(household().above)


def test_plurals():
    for plural, singular in (
        ("tazze", "tazza"),
        ("libri", "libro"),
        ("bicchieri", "bicchiere"),
        ("banchi", "banco"),
    ):
        assert singular in singulars(plural)


SOME = "porta portamela la il dell'acqua mi lo al tavolo della cucina a sinistra di 90 gradi e vai non ci"


@given(st.lists(st.sampled_from(SOME.split()), max_size=12))
def test_whatever_is_said_spans_and_heads_are_inside(texts):
    understood = shipped().understand(" ".join(texts), there(), "italian")
    for frame in understood.frames:
        assert frame.verb
        assert all(1 <= token <= len(understood.words) for token in frame.verb)
        for argument in frame.arguments:
            first, last = argument.span
            assert 1 <= first <= argument.head <= last <= len(understood.words)
            assert argument.text == " ".join(understood.words[first - 1 : last])
