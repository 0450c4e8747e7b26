"""The result of a check with the violations of shapes, without a process."""

import pytest

from semmap.nodes.kb_node.reasoner import GivenFacts
from semmap.nodes.kb_node.shacl import violations
from semmap.nodes.kb_node.shacl.results import Result
from semmap.nodes.kb_node.shacl.validation_process import Validation
from semmap.schemas import errors
from semmap.schemas.commands import SHAPES_BYTES, Check
from semmap.schemas.replies import Checked
from tests.kb_node.home import turtle
from tests.kb_node.shacl.test_shapes import SH

PLAIN = Check()
RESULT = Result("<urn:a>", "m", "", "", "violation", "<urn:s>")


def test_a_large_document_is_rejected():
    violations.require_size(Check(shapes=b"x" * SHAPES_BYTES))
    with pytest.raises(errors.BadFile, match=r"^s\.ttl is larger than 10 MiB; split it into several files$"):
        violations.require_size(Check(shapes=b"x" * (SHAPES_BYTES + 1), filename="s.ttl"))


class Validator:
    def __init__(self, outcome):
        self._outcome = outcome

    def validate(self, *_):
        if isinstance(self._outcome, Exception):
            raise self._outcome
        return self._outcome


def check(outcome, query=PLAIN, *, shapes=":s sh:targetNode :a .", consistent=True):
    checked = Checked(consistent=consistent, engine="semmap", triples=1, elapsed_s=0.0, text="")
    facts = GivenFacts(list(turtle(SH + shapes)), [])
    names = violations.Names({}, {})
    return violations.with_validation(checked, Validator(outcome), query, facts, names)


@pytest.mark.parametrize(
    ("outcome", "conforms"),
    [
        (Validation(shapes=1), True),
        (Validation(shapes=1, results=[RESULT], count=1), False),
        (Validation(shapes=1, results=[RESULT], count=1, is_complete=False), False),
        (Validation(is_complete=False), None),
        (errors.BadFile("it takes too long"), None),
        (errors.Refused("the parser does not start"), None),
    ],
)
def test_shapes_that_were_not_evaluated_do_not_conform(outcome, conforms):
    found = check(outcome)
    assert found.conforms is conforms
    if isinstance(outcome, Exception):
        assert found.notes == (f"shapes not evaluated: {outcome.text}",)
        with pytest.raises(type(outcome)):
            check(outcome, Check(shapes=b"shapes"))


def test_without_shapes_or_consistency_nothing_is_evaluated():
    assert check(AssertionError(), shapes="").conforms is True
    found = check(AssertionError(), consistent=False)
    assert (found.conforms, found.notes) == (None, ("shapes not evaluated: the map is inconsistent",))


P, Q, A, B = "<urn:x#p>", "<urn:y#p>", "<urn:a>", "<urn:b>"


@pytest.mark.parametrize(
    ("result", "message", "path", "value", "text"),
    [
        (
            Result(A, "too few", P, B, "violation", "<urn:S>"),
            "too few", "p", "bowl", "cup: too few; p; bowl",
        ),
        (
            Result(A, "", P, '"5"', "violation", "<urn:S>", "sh:maxCount 1"),
            "the value 5 of p violates sh:maxCount 1", "p", "5",
            "cup: the value 5 of p violates sh:maxCount 1; correct the map or the shape S",
        ),
        (
            Result(A, "", f"{P}/^{Q}", "", "violation", "_:b1", "sh:minCount 1"),
            "the values of p/^y:p violate sh:minCount 1", "p/^y:p", "",
            "cup: the values of p/^y:p violate sh:minCount 1; correct the map or the shape",
        ),
        (
            Result("_:b2", "", "", A, "violation", "_:b1", "sh:class A"),
            "cup violates sh:class A", "", "cup",
            "an individual without a name: cup violates sh:class A; correct the map or the shape",
        ),
        (
            Result(A, "", "", A, "violation", "_:b1", "sh:closed"),
            "violates sh:closed", "", "",
            "cup: violates sh:closed; correct the map or the shape",
        ),
    ],
)  # fmt: skip
def test_a_violation_in_one_line(result, message, path, value, text):
    found = violations.to_violation(result, {A: "cup", B: "bowl"}.__getitem__, {Q: "y:p"})
    assert (found.message, found.path, found.value, found.text) == (message, path, value, text)
    assert found.shape == ("S" if result.shape == "<urn:S>" else "")
    assert found.severity == "violation"
    if not result.message:
        assert (
            violations.to_violation(result, {A: "cup"}.__getitem__, {Q: "y:p"}, "").text
            == f"{found.name}: {message}"
        )
