import pytest

from nodes.kb_node.reasoner import Inconsistent, Reasoner
from nodes.kb_node.reasoner.fastpaths.shortcuts import depart, exchange
from tests.kb_node.reasoner.graphs import EVERYTHING, triple, triples
from tests.kb_node.reasoner.test_reasoner import BASE, asserted_in, check_same

STAR = ':a a :C ; :free :a1 ; :free :old . :a1 :fundata "1.5"^^xsd:float ; :key2 "a" .'
REST = ':old a :B ; :fundata "2.5"^^xsd:float .'


@pytest.fixture
def reasoner():
    return Reasoner([*asserted_in(BASE), *triples(STAR + REST)])


def same_as_fresh(reasoner, turtle):
    check_same(reasoner, dict.fromkeys([*asserted_in(BASE), *triples(turtle)]), BASE)


def test_a_thing_goes_with_all_that_was_said_of_it(reasoner):
    assert depart(reasoner._engine._abox, triples(STAR)) == {triple(":a a :C")[0], triple(":a1 a :C")[0]}
    assert not reasoner.mentioned({triple(":a1 a :C")[0]})
    assert not list(reasoner.inferred(triple(":a a :C")[0]))


@pytest.mark.parametrize(
    ("more", "gone"),
    [
        ("", STAR + " :a :free :i6 ."),
        ("", STAR.replace(" a :C ;", "")),
        (" :old :free :a .", STAR),
        (" :a owl:sameAs :old .", STAR),
        (" :a :p :old .", STAR + " :a :p :old ."),
        (" :a :tra :i6 . :i6 :tra :i5 .", STAR + " :a :tra :i6 ."),
        (' :i6 :key2 "a"^^xsd:token .', STAR),
    ],
)
def test_it_is_not_plain_when_somebody_else_is_concerned(reasoner, more, gone):
    """More was deleted than was there, or less, or others point there or rest on it."""
    reasoner.apply(insert=triples(more))
    assert depart(reasoner._engine._abox, triples(gone)) is None
    reasoner.apply(delete=triples(gone))
    left = [fact for fact in triples(STAR + REST + more) if fact not in triples(gone)]
    check_same(reasoner, dict.fromkeys([*asserted_in(BASE), *left]), BASE)


def values(*texts):
    return [triple(f':a1 :fundata "{text}"^^xsd:float') for text in texts]


def test_a_number_becomes_another(reasoner):
    assert exchange(reasoner._engine._abox, values("1.5"), values("2.5")) == {triple(":a1 a :C")[0]}
    same_as_fresh(reasoner, STAR.replace("1.5", "2.5") + REST)


@pytest.mark.parametrize(
    ("delete", "insert"),
    [
        (values("9.5"), values("2.5")),
        (values("1.5"), [triple(':a1 :key2 "b"')]),
        (values("1.5"), [triple(':old :fundata "3.5"^^xsd:float')]),
        (values("1.5"), [triple(":a1 :fundata 2")]),
        (values("1.5", "1.5"), values("2.5", "3.5")),
        ([triple(":a :free :old")], [triple(":a :free :i6")]),
    ],
)
def test_it_is_not_plain_when_there_is_more_to_it(reasoner, delete, insert):
    """Not there; another property, subject or kind; one for two; no literals."""
    before = set(reasoner.asserted())
    assert exchange(reasoner._engine._abox, delete, insert) is None
    try:
        reasoner.apply(delete=delete, insert=insert)
        before = (before - set(delete)) | set(insert)
    except Inconsistent:
        pass
    check_same(reasoner, dict.fromkeys(before), BASE)


def test_an_ill_typed_value_is_refused_in_exchange(reasoner):
    with pytest.raises(Inconsistent, match='"abc" is not a value of float'):
        reasoner.apply(delete=values("1.5"), insert=values("abc"))
    same_as_fresh(reasoner, STAR + REST)


@pytest.mark.parametrize("text", ["abc", "٣", "1_0"])
def test_what_is_no_number_is_refused_beside_another_value(text):
    """Two values of a functional property, one of them none: both ways it is undone without a trace."""
    reasoner = Reasoner(triples(EVERYTHING))
    facts = [triple(f':x :fundata "{word}"^^xsd:float') for word in (text, "1.0")]
    for insert in (facts, facts[::-1]):
        with pytest.raises(Inconsistent):
            reasoner.apply(insert=insert)
        assert not reasoner.mentioned({facts[0][0]})
    reasoner.apply(insert=facts[1:])
