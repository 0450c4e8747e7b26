"""Commands of our own making."""

from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding import slots
from semmap.nodes.training.language import made
from semmap.nodes.training.language.household import household


def test_every_pattern_can_be_drawn_and_means_what_it_says():
    examples = made.examples(1, household(), seed=7)
    assert len(examples) > 200
    for example in examples:
        assert example.frames
        for frame in example.frames:
            assert frame.name in {name for known in lexicon.load().frames.values() for name in known}
            assert all(1 <= token <= len(example.words) for token in frame.verb)
            for role in frame.arguments:
                assert 1 <= role.first <= role.last <= len(example.words), example.words
                assert slots.slot(frame.name, role.name)
                assert not set(frame.verb) & set(range(role.first, role.last + 1))
        assert not any(set("{}*/()|[]>") & set(word) for word in example.words), example.words


def test_the_same_seed_draws_the_same():
    assert made.examples(1, household(), seed=2) == made.examples(1, household(), seed=2)
    assert made.examples(1, household(), seed=2) != made.examples(1, household(), seed=3)


def test_named_people_are_persons():
    things = [thing for example in made.examples(2, household()) for thing in example.things]
    people = [thing for thing in things if "anna" in thing.references]
    assert people
    assert {thing.class_name for thing in people} == {"Person"}
