from semmap.nodes.extern.web.views.find_results import format_reasons, summarize
from semmap.schemas.language import Candidate, Found


def candidate(name, *why):
    return Candidate(entity=name, class_="Cup", called="cup", reasons=why)


def test_matches_are_selected():
    found = Found(outcome="several", candidates=(candidate("cup1"), candidate("cup2")), text="two cups")
    shown = summarize(found)
    assert (shown.tone, shown.select, shown.text) == ("found", ("cup1", "cup2"), "two cups")


def test_an_ambiguous_description_selects_nothing_and_lists_candidates():
    both = (candidate("sink1"), candidate("sink2"))
    shown = summarize(Found(outcome="ambiguous", candidates=both, question="Which one?"))
    assert (shown.tone, shown.select, shown.text, shown.choices) == ("question", (), "Which one?", both)


def test_without_a_match_the_closest_ones_are_listed():
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


def test_there_is_always_a_text():
    assert summarize(Found(outcome="one", candidates=(candidate("cup1"),))).text == "cup1"
    assert summarize(Found(outcome="ambiguous")).text == "Which one?"
    many = summarize(Found(outcome="several", candidates=(candidate("a"), candidate("b")), others=3))
    assert many.text == "2 entities"
    assert many.notes == ("… and 3 more",)


def test_reasons_default_to_the_label():
    assert format_reasons(candidate("a", "red", "on table1")) == "red, on table1"
    assert format_reasons(candidate("a")) == "cup"
