"""Requests to persons, owners, ordinals and *nothing*: wordings that must not become another command."""

import pytest


def texts(understood):
    return [step.text for step in understood.steps]


@pytest.mark.parametrize("said", ["tell Nora", "ask Nora"])
@pytest.mark.parametrize(
    "message", ["to bring me the bread", "to find a towel", "not to take the kettle", "not to open the oven"]
)
def test_what_a_person_is_to_do_is_a_message_and_no_step(read, said, message):
    assert texts(read(f"{said} {message}")) == [f'Request(Addressee=nora1, Message="{message}")']


OWNED = ["belonging to", "that belongs to", "which belongs to", "owned by", "that is owned by"]


@pytest.mark.parametrize("by", OWNED)
def test_the_owner_selects_the_thing(read, by):
    assert texts(read(f"put the phone {by} the owner on the desk")) == [
        "Placing(Theme=smartphone1, Goal=desk1)"
    ]


@pytest.mark.parametrize("by", [*(f"{by} Nora" for by in OWNED), "that Nora owns", "which Nora possesses"])
def test_what_a_person_does_not_own_is_a_doubt(read, by):
    understood = read(f"take the kettle {by}")
    assert texts(understood) == [f'Taking(Theme="the kettle {by}")']
    assert understood.doubts == ("no kettle is known that belongs to Nora",)


@pytest.mark.parametrize("by", ["che appartiene a", "appartenente a", "di proprietà di"])
def test_the_owner_is_read_in_italian(read, by):
    understood = read(f"prendi il bollitore {by} Nora")
    assert texts(understood) == [f'Taking(Theme="il bollitore {by} Nora")']
    assert understood.doubts == ("no kettle is known that belongs to Nora",)


def test_a_thing_that_is_not_of_a_person_is_left_open(read):
    understood = read("take the towel that does not belong to Nora")
    assert texts(understood) == ['Taking(Theme="the towel that does not belong to Nora")']


@pytest.mark.parametrize(
    ("thing", "there"),
    [("the second oven", "is only 1"), ("the third kettle", "is only 1"), ("the tenth door", "are only 7")],
)
def test_an_ordinal_beyond_the_number_of_things_is_a_doubt(read, thing, there):
    understood = read(f"close {thing}")
    assert "1" not in texts(understood)[0]
    assert understood.doubts == (f"'{thing}': there {there}",)


@pytest.mark.parametrize(
    "text", ["open nothing", "bring me nothing", "take nothing from the desk", "non prendere niente"]
)
def test_nothing_negates_its_step(read, text):
    assert [step.negated for step in read(text).steps] == [True]


def test_one_of_several_persons_by_a_superlative_stays_open(read):
    assert texts(read("greet the youngest of the people in the studio")) == [
        'Greeting(Addressee="the youngest of the people in the studio")'
    ]


def test_a_name_and_the_next_word_are_no_noun(read):
    assert texts(read("tell Tomas to come")) == ['Request(Addressee="Tomas", Message="to come")']


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        ("take nothing but the milk", ["Taking(Theme=milk1)"]),
        ("take nothing except the milk and the kettle", ["Taking(Theme=milk1, Theme=kettle1)"]),
        ("do not take anything but the milk", ['not Taking(Theme="anything but the milk")']),
        ("non prendere niente tranne il latte", ['not Taking(Theme="niente tranne il latte")']),
        ("close the oven with Nora gone", ["Closure(Containing_object=oven1)"]),
        ("di' a Nora di portarmi il latte", ['Request(Addressee=nora1, Message="di portarmi il latte")']),
        ("tell Otto which is the biggest cup", ['Telling(Addressee="Otto", Message="which is", Topic=cup1)']),
        ("ask the man in the kitchen where the milk is",
         ['Questioning(Addressee="the man in the kitchen", Message="where the milk is")']),
        ("ask the man who is waving who he is",
         ['Questioning(Addressee="the man who is waving", Message="who he is")']),
        ("ask Nora and Otto to come", ['Request(Addressee=nora1, Addressee="Otto", Message="to come")']),
        ("chiedi a Otto chi è in cucina", ['Questioning(Addressee="Otto", Message="chi è in cucina")']),
        ("bring me everything of the owner's",
         ['Bringing(Beneficiary="me", Theme=keys1|laptop1|smartphone1)']),
        ("ask Nora where the milk is and bring it here",
         ['Questioning(Addressee=nora1, Message="where the milk is")', 'Bringing(Theme=milk1, Goal="here")']),
        ("put the plates on the desk and the milk next to it",
         ["Placing(Theme=plate1|plate2, Goal=desk1)", "Placing(Theme=milk1, Goal=desk1)"]),
    ],
)  # fmt: skip
def test_only_and_pronouns_are_no_other_things(read, text, steps):
    assert texts(read(text)) == steps


@pytest.mark.parametrize("thing", ["the second kettle from the left", "the third oven from the right"])
def test_an_ordinal_is_counted_from_a_side(read, thing):
    assert read(f"take {thing}").doubts == (f"'{thing}': there is only 1",)
