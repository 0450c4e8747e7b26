"""A copy of the checkout is changed, never the checkout; what came of it is kept."""

import subprocess

import pytest

from tests.mutants.ledger import Ledger
from tests.mutants.mirror import find_own_tests
from tests.mutants.report import Tried, write_report
from tests.mutants.sample import Mutant
from tests.mutants.trial import BROKEN, KILLED, NO_TEST, SURVIVED, TIMEOUT, Copy

CODE = "def twice(x):\n    return 2 * x\n"


@pytest.fixture
def root(tmp_path):
    root = tmp_path / "checkout"
    (root / "tests" / "a").mkdir(parents=True)
    (root / "nodes" / "a").mkdir(parents=True)
    (root / "nodes" / "a" / "twice.py").write_text(CODE)
    (root / "nodes" / "__init__.py").touch()
    (root / "nodes" / "a" / "__init__.py").touch()
    (root / "package").mkdir()
    (root / "package" / "nodes").symlink_to("../nodes")  # as in this checkout
    (root / "pytest.ini").write_text("[pytest]\nmarkers =\n    long\n    process\n")
    _write_test(root, "assert twice(2) == 4")
    subprocess.run(["git", "init", "-q"], cwd=root, check=True)
    return root


@pytest.mark.long
def test_a_change_that_a_test_notices_is_killed_and_another_survives(root, tmp_path):
    copy = Copy(root, tmp_path / "copy")
    tests = find_own_tests(root, "nodes/a/twice.py")
    assert copy.try_mutant(_mutant("2 + x"), tests) == SURVIVED
    assert copy.try_mutant(_mutant("2 - x"), tests) == KILLED
    assert copy.try_mutant(_mutant("2 ** x"), tests) == SURVIVED
    assert (root / "nodes" / "a" / "twice.py").read_text() == CODE
    assert (tmp_path / "copy" / "nodes" / "a" / "twice.py").read_text() == CODE


@pytest.mark.long
def test_a_change_that_the_mirrored_tests_miss_is_tried_against_those_of_the_folder(root, tmp_path):
    line = "from package.nodes.a.twice import twice"
    (root / "tests" / "a" / "test_other.py").write_text(
        f"{line}\n\ndef test_it():\n    assert twice(3) == 6\n"
    )
    copy = Copy(root, tmp_path / "copy")
    tests = find_own_tests(root, "nodes/a/twice.py")
    assert tests.groups == (("tests/a/test_twice.py",), ("tests/a/test_other.py",))
    assert copy.try_mutant(_mutant("2 + x"), tests) == KILLED
    assert copy.try_mutant(_mutant("x + x"), tests) == SURVIVED


@pytest.mark.long
def test_tests_that_fail_without_a_change_are_reported(root, tmp_path):
    _write_test(root, "assert twice(2) == 5")
    copy = Copy(root, tmp_path / "copy")
    assert copy.try_mutant(_mutant("2 + x"), find_own_tests(root, "nodes/a/twice.py")) == BROKEN


def test_an_outcome_counts_until_the_tests_or_the_code_change(root, tmp_path):
    tests = find_own_tests(root, "nodes/a/twice.py")
    Ledger(root, tmp_path / "kept").note(_mutant("2 + x"), tests, SURVIVED)
    assert Ledger(root, tmp_path / "kept").find(_mutant("2 + x"), tests) == SURVIVED
    assert Ledger(root, tmp_path / "kept").find(_mutant("2 - x"), tests) is None
    _write_test(root, "assert twice(3) == 6")
    assert Ledger(root, tmp_path / "kept").find(_mutant("2 + x"), tests) is None


def test_the_report_counts_what_has_no_test_as_missed_and_what_is_broken_not_at_all(root):
    tests = find_own_tests(root, "nodes/a/twice.py")
    outcomes = (KILLED, TIMEOUT, SURVIVED, NO_TEST, BROKEN)
    report = write_report("nodes/a", 3, [Tried(_mutant("2 + x"), tests, outcome) for outcome in outcomes])
    assert report.splitlines()[-1] == (
        "nodes/a, seed 3: 2 of 4 mutants killed (50%), 1 survived, 1 without a test"
    )
    assert [line.split("  ")[0].strip() for line in report.splitlines()[:-1]] == [BROKEN, NO_TEST, SURVIVED]
    assert "nodes/a/twice.py:2  return 2 * x  ->  return 2 + x  [tests/a/test_twice.py]" in report


def _write_test(root, line):
    test = f"from package.nodes.a.twice import twice\n\ndef test_it():\n    {line}\n"
    (root / "tests" / "a" / "test_twice.py").write_text(test)


def _mutant(product):
    code = CODE.replace("2 * x", product)
    return Mutant("nodes/a/twice.py", 2, "Some", 0, "return 2 * x", f"return {product}", code)
