from semmap.nodes.extern.web.views.find_results import format_reasons, summarize
from semmap.schemas.language import Candidate, Found


def candidate(name, *why):
    return Candidate(entity=name, class_="Cup", called="cup", reasons=why)


def test_what_is_meant_is_selected():
    found = Found(outcome="several", candidates=(candidate("cup1"), candidate("cup2")), text="two cups")
    shown = summarize(found)
    assert (shown.tone, shown.select, shown.text) == ("found", ("cup1", "cup2"), "two cups")


def test_a_question_selects_nothing_and_offers_the_candidates():
    both = (candidate("sink1"), candidate("sink2"))
    shown = summarize(Found(outcome="ambiguous", candidates=both, question="Which one?"))
    assert (shown.tone, shown.select, shown.text, shown.choices) == ("question", (), "Which one?", both)


def test_nothing_offers_what_fits_least_badly_and_what_is_gone():
    near = (candidate("apple1", "an apple", "not: in the fridge"),)
    found = Found(
        outcome="none",
        text="nothing fits",
        nearest=near,
        gone=("apple2 was there",),
        read_as=(("aple", "apple"),),
    )
    shown = summarize(found)
    assert (shown.tone, shown.select, shown.choices) == ("nothing", (), near)
    assert shown.notes == ("“aple” is read as “apple”", "apple2 was there")


def test_there_is_always_something_to_say():
    assert summarize(Found(outcome="one", candidates=(candidate("cup1"),))).text == "cup1"
    assert summarize(Found(outcome="ambiguous")).text == "Which one?"
    many = summarize(Found(outcome="several", candidates=(candidate("a"), candidate("b")), others=3))
    assert many.text == "2 entities"
    assert many.notes == ("… and 3 more",)


def test_reasons_are_told_or_else_what_it_is_called():
    assert format_reasons(candidate("a", "red", "on table1")) == "red, on table1"
    assert format_reasons(candidate("a")) == "cup"
