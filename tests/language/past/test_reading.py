"""Questions about the past, read against a few nouns."""

from datetime import datetime

import pytest

from semmap.nodes.language.past.reading import read_questions
from semmap.nodes.language.past.times import Period
from semmap.nodes.language.reference_resolution.map_index import Item, MapIndex, Terms

NOW = datetime(2026, 3, 2, 15, 0, 0)
CLASSES = {
    "Cup": "tazza", "Table": "tavolo", "Kitchen": "cucina", "Bathroom": "bagno", "Fridge": "frigo",
    "Drawer": "cassetto", "Robot": "robot", "Person": "persona",
}  # fmt: skip


@pytest.fixture(scope="module")
def known():
    classes = [("en", name, name.lower()) for name in CLASSES] + [("it", *pair) for pair in CLASSES.items()]
    index = MapIndex(Terms(classes=tuple(classes), qualities=(("en", "color_red", "red"),)))
    names = ("cup1", "table1", "kitchen1", "bathroom1", "fridge1", "drawer1")
    index.update([Item(name, name[:-1].capitalize(), frozenset(), (), {}) for name in names])
    index.update([Item("r2", "Robot", frozenset(), (), {})])
    return index


def shown(question):
    """Return a question in one line: what is asked, the claim, the time, the other clause, the doubts."""
    parts = [question.asked, claim_of(question.claim)]
    for name in ("since", "until", "at"):
        if (moment := getattr(question.period, name)) is not None:
            parts.append(f"{name} {datetime.fromtimestamp(moment.first_ns / 1e9):%H:%M:%S}")
    parts += [question.order] if question.order else []
    if question.anchored is not None:
        parts.append(f"{question.anchor} ({claim_of(question.anchored)})")
    parts += ["current"] if question.is_current else []
    parts += [f"? {doubt}" for doubt in question.doubts]
    return "; ".join(filter(None, parts))


def claim_of(claim):
    it = ["it"] if claim.is_it else []
    places = [f"{how} {text}" for how, text in claim.places]
    by = [f"by {claim.agent}"] if claim.agent else []
    it += [f"(of {claim.kind})"] if claim.kind else []
    return " ".join([*it, *claim.subjects, *filter(None, (claim.event, claim.state)), *places, *by])


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("where was cup1 at 10:00", "where; cup1; at 10:00:00"),
        ("At 10:00:05, in which room was the red cup?", "where; the red cup; at 10:00:05"),
        ("where was cup1 before it was on table1", "where; cup1; before (it on table1)"),
        ("before anna moved cup1, where was it?", "where; it; before (cup1 move by anna)"),
        ("where did cup1 go after table1", "where; cup1 go; after (table1)"),
        ("when was cup1 last moved", "when; cup1 move; last"),
        ("when did anna move cup1 to the kitchen", "when; cup1 move to the kitchen by anna"),
        ("when was the fridge closed", "when; the fridge close"),
        ("how long was the fridge closed", "how_long; the fridge closed"),
        ("since when is the drawer open", "since; the drawer open; current"),
        ("how long has cup1 been on table1", "how_long; cup1 on table1; current"),
        ("how much time did r2 spend in the kitchen between 10 and 11 am",
         "how_long; r2 in the kitchen; since 10:00:00; until 11:00:00"),
        ("how many times did r2 go to the kitchen", "how_often; r2 enter to the kitchen"),
        ("who put cup1 on table1", "who; cup1 put on table1"),
        ("who was in the kitchen 5 minutes ago", "who; in the kitchen; at 14:55:00"),
        ("what changed in the kitchen since this morning", "changed; change in the kitchen; since 05:00:00"),
        ("what is missing from table1 since 10:00", "missing; from table1; since 10:00:00"),
        ("what did anna move", "what; move by anna"),
        ("was cup1 ever in the bathroom", "whether; cup1 in the bathroom"),
        ("where was cup1 gladly at 10:00", "where; cup1; at 10:00:00; ? gladly"),
        ("which kitchens did r2 visit", "where; (of kitchens) r2 enter"),
        ("in which kitchens has r2 been", "where; (of kitchens) r2; current"),
        ("su quale tavolo era cup1", "where; (of tavolo) cup1"),
        ("what was open in the kitchen at 10:00", "what; open in the kitchen; at 10:00:00; ? open"),
        ("which table was cup1 on", "where; (of table) cup1"),
        ("on which table was cup1", "where; (of table) cup1"),
        ("was cup1 on table1 or in the kitchen", "whether; cup1 on table1 in the kitchen; ? or"),
        ("how many times did r2 visit each kitchen", "how_often; r2 enter to kitchen; ? each"),
        ("cosa manca da table1", "missing; from table1"),
        ("what was the first thing that anna moved", "what; move by anna; first"),
        ("what was moved after the fridge was closed", "what; move; after (the fridge close)"),
        ("who did not move cup1", "who; cup1 move; ? not"),
        ("since when was cup1 not on table1", "since; cup1 on table1; ? not"),
        ("dov'era cup1 alle 10:00", "where; cup1; at 10:00:00"),
        ("quando è stata spostata la tazza", "when; la tazza move"),
        ("da quando è aperto il cassetto", "since; il cassetto open; current"),
        ("quante volte r2 è stato in cucina", "how_often; r2 in cucina"),
        ("chi ha spostato cup1", "who; cup1 move; current"),
        ("cosa manca da table1 dalle 10:00", "missing; from table1; since 10:00:00"),
        ("cup1 è mai stata in bagno?", "whether; cup1 in bagno"),
    ],
)  # fmt: skip
def test_every_part_of_a_question_is_read(known, text, read):
    _, questions = read_questions(text, known, {"anna"}, NOW, ("english", "italian"))
    assert [shown(question) for question in questions] == [read]


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("who moved cup1, and when", ["who; cup1 move", "when; cup1 move"]),
        ("where was cup1 and who moved it", ["where; cup1", "who; it move"]),
        ("when was cup1 on table1 and for how long", ["when; cup1 on table1", "how_long; cup1 on table1"]),
        ("chi ha spostato cup1 e quando", ["who; cup1 move; current", "when; cup1 move; current"]),
    ],
)
def test_two_question_words_are_two_questions(known, text, read):
    _, questions = read_questions(text, known, {"anna"}, NOW, ("english", "italian"))
    assert [shown(question) for question in questions] == read


@pytest.mark.parametrize(
    "text",
    [
        "where is the cup",
        "is the fridge open",
        "how many cups are on the table",
        "how long is the table",
        "take the cup from the table",
        "tell me where the cup is",
        "I took the cup",
        "when you are in the kitchen, take the cup",
        "porta la tazza in cucina",
        "do not take the cup",
        "have Robin follow you to the kitchen",
        "check whether the drawer is open",
        "tell Anna to come if she is in the kitchen",
        "look at the table and tell me what is the heaviest thing there",
    ],
)
def test_commands_and_questions_about_the_present_are_left_to_the_other_grammar(known, text):
    assert read_questions(text, known, set(), NOW, ("english", "italian"))[1] == []


@pytest.mark.parametrize(
    "time",
    [
        "999999999999 days ago",
        "² minutes ago",
        "at commit ²",
        "at 2026-03-01T25:99",
        "on 0001-01-01",
        "9" * 5000,
    ],
)
def test_a_time_that_no_calendar_has_is_no_time(known, time):
    _, (question,) = read_questions(f"where was cup1 {time}", known, set(), NOW, ("english",))
    assert question.period == Period()


@pytest.mark.parametrize(("day", "date"), [("on monday", "2026-03-02"), ("last monday", "2026-02-23")])
def test_the_last_weekday_is_before_today(known, day, date):
    _, (question,) = read_questions(f"where was cup1 {day}", known, set(), NOW, ("english",))
    assert f"{datetime.fromtimestamp(question.period.since.first_ns / 1e9):%Y-%m-%d}" == date
