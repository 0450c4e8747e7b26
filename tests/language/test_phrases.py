"""Phrases: every word is in exactly one."""

from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.language.phrases import phrases
from semmap.nodes.language.words import split, tag
from tests.language.household import LEXICON


def said(text):
    words = tag(split(text), LEXICON)
    return [(p.kind, p.preposition, words[p.head].text) for p in phrases(words, LEXICON)]


def test_prepositions_of_several_words_are_one():
    assert said("go to the left of the couch") == [("verb", "", "go"), ("pp", "to the left of", "couch")]
    assert said("to the left") == [("pp", "to", "left")]


def test_a_new_determiner_begins_a_new_phrase():
    assert said("bring me the cup") == [("verb", "", "bring"), ("np", "", "me"), ("np", "", "cup")]
    assert said("take all the plates") == [("verb", "", "take"), ("np", "", "plates")]


SOME = "take the all red cup of next to it on 90 and go in front you"


@given(st.lists(st.sampled_from(SOME.split()), max_size=12))
def test_phrases_cover_a_sentence_without_gap(texts):
    words = tag(texts, LEXICON)
    covered = [i for p in phrases(words, LEXICON) for i in range(p.first, p.last + 1)]
    assert covered == list(range(len(words)))
    assert all(p.first <= p.nominal <= p.head <= p.last or not p.names for p in phrases(words, LEXICON))
