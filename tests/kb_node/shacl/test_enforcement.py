"""A commit that violates a shape of the TBox is rejected, and changes nothing."""

import pytest

from semmap.nodes.kb_node.shacl.enforcement import ShapeEnforcement
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.kb_node import home
from tests.kb_node.home import transaction, turtle
from tests.kb_node.shacl.test_shapes import SH

SWRL = "@prefix swrl: <http://www.w3.org/2003/11/swrl#> .\n"
SHAPES = turtle(
    SH
    + """
:S sh:targetClass dm:Chair ; sh:property [ sh:path dm:isLocatedIn ; sh:minCount 1 ;
        sh:message "needs a room" ] ;
    sh:property [ sh:path ( dm:isLocatedIn dm:closed ) ; sh:maxCount 0 ; sh:message "its room is closed" ] ;
    sh:property [ sh:path dm:seats ; sh:maxCount 0 ; sh:severity sh:Warning ] .
:W sh:targetObjectsOf dm:w ; sh:minInclusive 0 .
:U sh:targetSubjectsOf dm:uses ; sh:property [ sh:path dm:uses ; sh:class dm:Seat ] .
:F sh:targetSubjectsOf dm:far ; sh:property [ sh:path dm:reaches ; sh:maxCount 1 ] .
dm:uses2 a owl:ObjectProperty ; rdfs:range dm:Seat .
dm:uses a owl:ObjectProperty .
dm:reaches a owl:ObjectProperty ; owl:propertyChainAxiom ( dm:s dm:t dm:u ) .
"""
)
CHAIR = ":chair1 a dm:Chair ; dm:isLocatedIn :kitchen1 . :kitchen1 a dm:Kitchen ."
REFUSED = "required by the shapes of the TBox"


@pytest.fixture
def enforcing(tmp_path):
    made = home.new_map(tmp_path, [*home.TBOX, *SHAPES])
    made.enforcement = ShapeEnforcement(made.tbox)
    yield made
    home.close(made)


def test_a_violation_is_refused_with_its_message(enforcing):
    with pytest.raises(errors.Refused, match=f"^chair2: needs a room; isLocatedIn; {REFUSED}"):
        enforcing.commit(transaction(1, turtle(":chair2 a dm:Chair .")))
    assert (enforcing.seq, enforcing.abox()) == (0, [])
    assert enforcing.commit(transaction(2, turtle(CHAIR))).seq == 1
    with pytest.raises(errors.Refused, match=REFUSED):
        enforcing.commit(transaction(3, (), turtle(":chair1 dm:isLocatedIn :kitchen1 .")))
    assert set(enforcing.abox()) == set(turtle(CHAIR))


def test_what_refers_to_a_change_is_validated(enforcing):
    enforcing.commit(transaction(1, turtle(CHAIR)))
    with pytest.raises(errors.Refused, match="chair1: its room is closed"):
        enforcing.commit(transaction(2, turtle(":kitchen1 dm:closed true .")))


@pytest.mark.parametrize(
    ("path", "before", "inserted"),
    [
        ("( dm:p dm:q dm:r dm:bad )", ":a dm:p :b . :b dm:q :c . :c dm:r :d .", ":d dm:bad 1 ."),
        ("( dm:p dm:q dm:r dm:bad )", ":a dm:p :b . :c dm:r :d . :d dm:bad 1 .", ":b dm:q :c ."),
        ("( [ sh:zeroOrMorePath dm:p ] dm:bad )", ":a dm:p :b . :b dm:p :c . :c dm:p :d .", ":d dm:bad 1 ."),
        ("( [ sh:inversePath dm:p ] dm:q dm:bad )", ":a dm:q :x . :b dm:p :a ; dm:q :c .", ":c dm:bad 1 ."),
        (
            "( dm:q [ sh:inversePath dm:p ] [ sh:inversePath dm:bad ] )",
            ":a dm:q :c . :e dm:bad :f .",
            ":f dm:p :c .",
        ),
        (
            "( dm:q [ sh:inversePath ( dm:bad [ sh:alternativePath ( dm:r ( dm:s dm:p ) ) ] ) ] )",
            ":a dm:q :c . :e dm:bad :f . :f dm:s :g .",
            ":g dm:p :c .",
        ),
        (
            "[ sh:inversePath [ sh:oneOrMorePath ( dm:bad dm:p ) ] ]",
            ":a dm:q :x . :e dm:bad :f .",
            ":f dm:p :a .",
        ),
        (
            "( [ sh:alternativePath ( dm:p dm:q ) ] dm:r dm:bad )",
            ":a dm:q :b . :b dm:r :c .",
            ":c dm:bad 1 .",
        ),
        (
            "( dm:p dm:reaches dm:bad )",
            ":a dm:p :b . :b dm:s :c . :d dm:u :e . :e dm:bad 1 .",
            ":c dm:t :d .",
        ),
        ("dm:reachedFrom", ":a dm:p 1 . :z dm:s :b . :c dm:u :a .", ":b dm:t :c ."),
        ("( dm:p dm:follows dm:bad )", ":a dm:p :b . :b dm:n 1 . :d dm:bad 1 .", ":d dm:m 1 ."),
    ],
)
def test_individuals_from_which_a_path_leads_to_a_change_are_validated(tmp_path, path, before, inserted):
    shapes = f":L sh:targetSubjectsOf dm:p , dm:q ; sh:property [ sh:path {path} ; sh:maxCount 0 ] ."
    rule = """
dm:reaches owl:propertyChainAxiom ( dm:s dm:t dm:u ) ; owl:inverseOf dm:reachedFrom .
:x a swrl:Variable . :y a swrl:Variable . :n a swrl:Variable . [] a swrl:Imp ;
    swrl:body ( [ a swrl:DatavaluedPropertyAtom ; swrl:propertyPredicate dm:n ; swrl:argument1 :x ;
            swrl:argument2 :n ]
        [ a swrl:DatavaluedPropertyAtom ; swrl:propertyPredicate dm:m ; swrl:argument1 :y ;
            swrl:argument2 :n ] ) ;
    swrl:head ( [ a swrl:IndividualPropertyAtom ; swrl:propertyPredicate dm:follows ; swrl:argument1 :x ;
            swrl:argument2 :y ] ) .
"""
    made = home.new_map(tmp_path, [*home.TBOX, *turtle(SH + SWRL + shapes + rule)])
    made.enforcement = ShapeEnforcement(made.tbox)
    try:
        made.commit(transaction(1, turtle(before)))
        with pytest.raises(errors.Refused, match=r"^a: the values of .* violate sh:maxCount"):
            made.commit(transaction(2, turtle(inserted)))
        assert made.seq == 1
    finally:
        home.close(made)


@pytest.mark.parametrize(
    ("before", "inserted", "retracted", "text"),
    [
        ("", ":a dm:w -3 .", "", "-3: violates sh:minInclusive 0"),
        (
            ":z dm:uses :b . :a dm:uses2 :b .",
            "",
            ":a dm:uses2 :b .",
            "z: the value b of uses violates sh:class Seat",
        ),
        (
            ":z dm:uses :b . :b owl:sameAs :c . :a dm:uses2 :c .",
            "",
            ":a dm:uses2 :c .",
            "z: the value b of uses violates sh:class Seat",
        ),
        (
            ":z dm:uses :b . :b owl:sameAs :c . :a dm:uses2 :c .",
            "",
            ":b owl:sameAs :c .",
            "z: the value b of uses violates sh:class Seat",
        ),
        (
            ":z dm:far 1 ; dm:reaches :y ; dm:s :a . :a dm:t :b .",
            ":b dm:u :c .",
            "",
            "z: the values of reaches violate sh:maxCount 1",
        ),
    ],
)
def test_individuals_whose_facts_follow_from_a_change_are_validated(
    enforcing, before, inserted, retracted, text
):
    if before:
        enforcing.commit(transaction(1, turtle(before)))
    state = enforcing.seq, set(enforcing.abox())
    with pytest.raises(errors.Refused, match=f"^{text}; {REFUSED}"):
        enforcing.commit(transaction(2, turtle(inserted), turtle(retracted)))
    assert (enforcing.seq, set(enforcing.abox())) == state


@pytest.mark.parametrize(
    ("before", "inserted"),
    [
        (":x dm:p :b . :y dm:bad 1 .", ":b a dm:Bad ."),  # the class of x implies the value y
        (":x dm:s :b . :c dm:u :y . :y dm:bad 1 .", ":b dm:t :c ."),
        (":y dm:bad 1 .", ":y dm:isFlagOf :x ."),
        (":y dm:bad 1 .", ":x dm:flag2 :y ."),
    ],
)
def test_values_that_become_targets_are_validated(tmp_path, before, inserted):
    tbox = """
:T sh:targetObjectsOf dm:flag , dm:reaches ; sh:property [ sh:path dm:bad ; sh:maxCount 0 ] .
dm:Q a owl:Class ; rdfs:subClassOf [ a owl:Restriction ; owl:onProperty dm:flag ; owl:hasValue :y ] .
dm:Bad a owl:Class .
[ a owl:Restriction ; owl:onProperty dm:p ; owl:someValuesFrom dm:Bad ] rdfs:subClassOf dm:Q .
dm:p a owl:ObjectProperty . dm:flag a owl:ObjectProperty ; owl:inverseOf dm:isFlagOf .
dm:flag2 a owl:ObjectProperty ; rdfs:subPropertyOf dm:flag .
dm:reaches a owl:ObjectProperty ; owl:propertyChainAxiom ( dm:s dm:t dm:u ) .
"""
    made = home.new_map(tmp_path, [*home.TBOX, *turtle(SH + tbox)])
    made.enforcement = ShapeEnforcement(made.tbox)
    try:
        made.commit(transaction(1, turtle(before)))
        with pytest.raises(errors.Refused, match=r"^y: the values of .* violate sh:maxCount"):
            made.commit(transaction(2, turtle(inserted)))
    finally:
        home.close(made)


@pytest.mark.parametrize("path", ["dm:isLocatedIn", "( dm:isLocatedIn dm:seats )"])
def test_what_is_put_into_a_room_touches_none_of_the_other_contents(tmp_path, path):
    """With the shipped TBox, whose rooms contain all that is located in them."""
    shape = f":S sh:targetClass dm:Chair ; sh:property [ sh:path {path} ; sh:maxCount 9 ] ."
    made = home.new_map(tmp_path, [*home.household(), *turtle(SH + shape)])
    enforcement = made.enforcement = ShapeEnforcement(made.tbox)
    found = []
    begin = enforcement.begin

    def counting(commit, reasoner):
        touched = begin(commit, reasoner)
        find = touched.find
        touched.find = lambda *change: found.append(find(*change)) or found[-1]
        return touched

    enforcement.begin = counting
    try:
        for first, last in ((0, 3), (3, 30)):
            chairs = (f":c{n} a dm:Chair ; dm:isLocatedIn :k ." for n in range(first, last))
            made.commit(transaction(f"chairs{last}", turtle(":k a dm:Kitchen ." + " ".join(chairs))))
            found.clear()
            cup = turtle(":cup a dm:Cup ; dm:isLocatedIn :k .")
            made.commit(transaction(f"cup{last}", cup))
            made.commit(transaction(f"gone{last}", (), cup))
            assert [v.local_name(term) for term in sorted(found[0])] == ["cup", "k"]
            assert found[0] == found[1]
    finally:
        home.close(made)


def test_warnings_and_earlier_violations_refuse_nothing(enforcing):
    enforcement, enforcing.enforcement = enforcing.enforcement, None
    enforcing.commit(transaction(1, turtle(":chair2 a dm:Chair .")))
    enforcing.enforcement = enforcement
    assert enforcing.commit(transaction(2, turtle(":chair2 dm:seats 2 ."))).seq == 2


def test_each_transaction_of_several_is_validated(enforcing):
    made = enforcing.commit_together(
        [transaction(1, turtle(CHAIR)), transaction(2, turtle(":b a dm:Chair ."))]
    )
    assert made[0].seq == enforcing.seq == 1
    assert isinstance(made[1], errors.Refused)


def test_a_tbox_is_refused_if_the_map_violates_its_shapes(enforcing):
    enforcing.commit(transaction(1, turtle(CHAIR + ":x a dm:Door .")))
    stools = turtle("dm:Stool a owl:Class ; rdfs:subClassOf dm:Chair . dm:Door rdfs:subClassOf dm:Stool .")
    with pytest.raises(errors.Refused, match=f"^x: needs a room; isLocatedIn; {REFUSED}"):
        enforcing.replace_tbox(transaction(2), [*enforcing.tbox, *stools])
    assert enforcing.seq == 1
    enforcing.commit(transaction(3, turtle(":x dm:isLocatedIn :kitchen1 .")))
    assert enforcing.replace_tbox(transaction(4), [*enforcing.tbox, *stools]).seq == 3


def test_violations_before_a_tbox_refuse_it_only_if_others_come(enforcing):
    enforcement, enforcing.enforcement = enforcing.enforcement, None
    enforcing.commit(transaction(1, turtle(":chair2 a dm:Chair ; dm:seats 5 .")))
    enforcing.enforcement = enforcement
    other = turtle("dm:Stool a owl:Class ; rdfs:subClassOf dm:Chair .")
    assert enforcing.replace_tbox(transaction(2), [*enforcing.tbox, *other]).seq == 2
    few = turtle(SH + ":T sh:targetClass dm:Chair ; sh:property [ sh:path dm:seats ; sh:maxInclusive 4 ] .")
    with pytest.raises(
        errors.Refused, match=r"^chair2: the value 5 of seats violates sh:maxInclusive 4; required"
    ):
        enforcing.replace_tbox(transaction(3), [*enforcing.tbox, *few])


def test_another_tbox_brings_other_shapes(enforcing):
    enforcing.replace_tbox(transaction(1), home.TBOX)
    assert enforcing.commit(transaction(2, turtle(":chair2 a dm:Chair ."))).seq == 2


@pytest.mark.parametrize(
    ("shapes", "reason"),
    [
        (":S sh:targetClass dm:Chair ; sh:property [ sh:path dm:a , dm:b ] .", ""),
        (":S sh:targetClass dm:Chair ; sh:property [ sh:path dm:a ; sh:pattern '(' ] .", "missing \\)"),
        (":S sh:targetClass dm:Chair ; sh:node [ sh:property [ sh:path dm:a ; sh:minLength 'x' ] ] .", ""),
        (":S sh:targetClass dm:Chair ; sh:property [ sh:path ( dm:a ) ; sh:minCount 1 ] .", "A list"),
        (":S sh:targetClass dm:Chair ; sh:property [ sh:path dm:a ; sh:node :S ] .", "S refers to itself$"),
        ("[] sh:targetClass dm:Chair ; sh:or ( :S ) . :S sh:not [ sh:and ( :S ) ] .", "S refers to itself$"),
    ],
)
def test_a_tbox_with_shapes_that_cannot_be_evaluated_is_rejected(enforcing, shapes, reason):
    with pytest.raises(errors.BadFile, match=f"^the TBox: invalid SHACL shape: {reason}"):
        enforcing.replace_tbox(transaction(3), [*home.TBOX, *turtle(SH + shapes)])
    assert enforcing.seq == 0


def test_a_stored_map_starts_with_shapes_that_cannot_be_evaluated(caplog):
    shapes = ":S sh:targetClass dm:Chair ; sh:property [ sh:path dm:a ; sh:pattern '(' ] ."
    ShapeEnforcement([*home.TBOX, *turtle(SH + shapes)], is_stored=True)
    assert caplog.text.count("it is not enforced") == 1


def test_a_shape_that_fails_rejects_no_commit(enforcing, caplog):
    deep = " ".join(f":d{n} sh:property [ sh:path dm:on ; sh:node :d{n + 1} ] ." for n in range(30))
    shapes = turtle(SH + deep + ":d0 sh:targetClass dm:Chair . :S sh:targetClass dm:Door ; sh:closed true .")
    enforcing.replace_tbox(transaction(1), [*home.TBOX, *shapes])
    for n in range(2):
        enforcing.commit(transaction(f"c{n}", turtle(f":chair{n} a dm:Chair ; dm:on :chair{n} .")))
    assert enforcing.seq == 3
    with pytest.raises(errors.Refused, match=r"door1: the value .* violates sh:closed"):
        enforcing.commit(transaction("d", turtle(":door1 a dm:Door ; dm:on :chair1 .")))
    assert caplog.text.count("it is not enforced") == 1
