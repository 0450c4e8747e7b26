import pytest

from semmap.schemas import errors
from semmap.schemas.explanations import Explanation

ALL = [
    error
    for error in vars(errors).values()
    if isinstance(error, type) and issubclass(error, errors.SemmapError)
]
EXPLANATION = Explanation(conclusion=None, support=(("<a>", "<b>", "<c>"),), steps=(), text="because")


@pytest.mark.parametrize("kind", ALL, ids=lambda kind: kind.__name__)
def test_an_error_crosses_the_wire_as_itself(kind):
    arrived = errors.from_message(errors.to_message(kind("no", explanation=EXPLANATION)))
    assert type(arrived) is kind
    assert (arrived.text, str(arrived), arrived.explanation) == ("no", "no", EXPLANATION)


def test_every_error_has_a_code_of_its_own():
    assert len({kind.code for kind in ALL}) == len(ALL)


def test_a_code_of_a_newer_version_is_still_an_error():
    arrived = errors.from_message(errors.ErrorMessage(code="from-tomorrow", text="no"))
    assert type(arrived) is errors.SemmapError
    assert arrived.exit_status == 1


@pytest.mark.parametrize(
    ("kind", "status"),
    [
        (errors.Inconsistent, 1),
        (errors.PreconditionFailed, 1),
        (errors.UnknownName, 1),
        (errors.NameTaken, 1),
        (errors.UnknownClass, 2),
        (errors.UnknownVerb, 2),
        (errors.BadFile, 2),
        (errors.NoAnswer, 3),
        (errors.InternalError, 1),
    ],
)
def test_exit_status(kind, status):
    assert kind.exit_status == status


@pytest.mark.parametrize(
    ("word", "hint"),
    [
        ("Chiar", "; did you mean Chair?"),
        ("chair", "; did you mean Chair?"),
        ("chair_1", "; did you mean Chair?"),
        ("Cub", "; did you mean Cup?"),
        ("erator", "; did you mean Refrigerator?"),
        ("Xylophone", ""),
        ("", ""),
        ("***", ""),
    ],
)
def test_the_nearest_names_are_offered(word, hint):
    assert errors.did_you_mean(word, ["Chair", "Cup", "Refrigerator"]) == hint


def test_at_most_three_names_are_offered():
    assert errors.did_you_mean("chair", [f"chair{i}" for i in range(9)]).count("chair") == 3
    assert errors.did_you_mean("chair", []) == ""


def test_unknown_classes_are_reported_with_suggestions_and_individuals():
    text = errors.unknown_classes({"Chiar": ["c1"], "Xylophone": ["x1", "x2"]}, ["Chair", "Table"])
    assert text == (
        "unknown classes 'Chiar' (of c1; did you mean Chair?), 'Xylophone' (of x1, x2);"
        " see: semmap classes; --skip-unknown leaves these out"
    )
    many = errors.unknown_classes({"Chiar": [f"c{i}" for i in range(1000)]}, ["Table"])
    assert many.startswith("unknown class 'Chiar' (of c0, ")
    assert "c4 and 995 more" in many


def test_of_many_unknown_classes_three_are_named():
    text = errors.unknown_classes({f"Kind{i}": ["c"] for i in range(40)}, ["Table"])
    assert text == (
        "unknown classes 'Kind0' (of c), 'Kind1' (of c), 'Kind2' (of c) and 37 more; see: semmap classes;"
        " --skip-unknown leaves these out"
    )


def test_without_a_similar_name_the_command_that_lists_them_is_suggested():
    assert errors.suggestion("chiar", ["Chair"], "classes") == "; did you mean Chair?"
    assert errors.suggestion("xylophone", ["Chair"], "classes") == "; see: semmap classes"


def test_nothing_is_near_to_a_word_that_is_none():
    assert errors.nearest("chair" * 10_000, ["chair"] * 1000) == []


def test_a_text_that_quotes_without_end_is_shortened_on_the_wire():
    sent = errors.to_message(errors.UnknownName(f"no entity is named '{'x' * 100_000}'"))
    assert sent.text.endswith(" more characters)")
    assert len(sent.text) < 10_100


def test_busy_says_when_to_come_again_on_the_wire():
    back = errors.from_message(errors.to_message(errors.Busy("busy", again_s=0.5)))
    assert isinstance(back, errors.Busy)
    assert (back.text, back.again_s) == ("busy", 0.5)
