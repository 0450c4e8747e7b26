"""The parts of modules that are not mutated."""

import pytest

from tests.mutants.untouched import find_untouched, is_within


@pytest.mark.parametrize(
    "code",
    [
        "x: int | None = y",
        "def f(x: int | None): pass",
        "def f(x) -> int | None: pass",
        'x = f"{a | b}"',
        'log.warning("%s", a | b)',
        "assert a | b",
        "Alias = A | B",
        "@functools.lru_cache(a | b)\ndef f(): pass",
        "if TYPE_CHECKING:\n    x = a | b",
        'if __name__ == "__main__":\n    x = a | b',
    ],
)
def test_annotations_strings_logging_and_guards_are_left_alone(code):
    assert is_within(_position(code), find_untouched(code))


@pytest.mark.parametrize(
    "code",
    [
        "x: int = a | b",
        "def f(x=a | b): pass",
        "def f() -> int:\n    return a | b",
        "@dataclass(frozen=a | b)\nclass C: pass",
        "if TYPE_CHECKING:\n    pass\nelse:\n    x = a | b",
        "def f(x):\n    y = a | b",
        'x = "ä€", a | b',
    ],
)
def test_code_that_does_something_is_changed(code):
    assert not is_within(_position(code), find_untouched(code))


@pytest.mark.parametrize(
    ("code", "is_left"),
    [
        ("@dataclass(frozen=True)\nclass C: pass", True),
        ("@dataclass(slots=True)\nclass C: pass", True),
        ("class C(Struct, frozen=True): pass", True),
        ("class C(Struct, kw_only=True): pass", False),
        ("@dataclass(eq=True)\nclass C: pass", False),
    ],
)
def test_whether_a_class_is_frozen_or_has_slots_is_left_to_mypy(code, is_left):
    position = (1, code.splitlines()[0].index("True"))
    assert is_within(position, find_untouched(code)) == is_left


def _position(code):
    """Line and column of the `|`."""
    line = next(i for i, text in enumerate(code.splitlines(), 1) if "|" in text)
    return line, code.splitlines()[line - 1].index("|")
