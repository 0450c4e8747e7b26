"""Pytest is run in parts; a test that needs a process and fails is run once more, alone."""

import pytest

from tests.suite import __main__ as suite
from tests.suite import repeats

CONFTEST = """
import pytest
@pytest.fixture(scope="session")
def ran_before(request):
    return len(request.session.items) > 1
"""
GOOD = "def test_good(): pass\n"
FLAKY = """
import pytest
@pytest.mark.process
def test_flaky(ran_before):
    assert not ran_before, "not alone"
"""
BROKEN = """
import pytest
@pytest.mark.process
def test_broken():
    raise ValueError("no\\nway")
"""
PURE = "def test_pure(ran_before):\n    assert not ran_before\n"


@pytest.fixture
def tests(tmp_path, monkeypatch):
    """A function that writes a file of tests, in a folder where the suite has one part."""
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers =\n    long\n    process\n")
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "test_good.py").write_text(GOOD)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(suite.ROOT))
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.delenv("PYTEST_ADDOPTS", raising=False)
    monkeypatch.setattr(suite, "PARTS", ((),))
    monkeypatch.setattr(repeats, "PARTS", ((),))
    monkeypatch.setattr(repeats, "_ROOT", tmp_path)
    return lambda **files: [(tmp_path / f"test_{name}.py").write_text(text) for name, text in files.items()]


def test_a_run_in_which_all_pass_ends_with_the_line_of_pytest(tests, capfd):
    assert suite.main([]) == 0
    assert " 1 passed in " in capfd.readouterr().out.splitlines()[-1]


def test_a_flaky_test_is_named_at_the_end_of_a_green_run(tests, capfd):
    tests(flaky=FLAKY)
    assert suite.main([]) == 0
    *_, closing, flaky = capfd.readouterr().out.splitlines()
    assert " 1 failed, 1 passed in " in closing
    assert flaky == "flaky: test_flaky.py::test_flaky"


def test_a_test_that_fails_again_makes_the_run_red_and_is_shown(tests, capfd):
    tests(flaky=FLAKY, broken=BROKEN)
    assert suite.main([]) == 1
    out = capfd.readouterr().out
    assert out.count("1 failed in ") == 1
    assert out.splitlines()[-1] == "flaky: test_flaky.py::test_flaky"


def test_a_pure_test_is_not_run_again(tests, capfd):
    tests(flaky=FLAKY, pure=PURE)
    assert suite.main([]) == 1
    assert "flaky:" not in capfd.readouterr().out


def test_a_file_that_cannot_be_read_makes_the_run_red(tests, capfd):
    tests(unreadable="def")
    assert suite.main([]) == 1


def test_pytest_that_breaks_off_makes_the_run_red(tests, capfd):
    tests(ending="import os\ndef test_it(): os._exit(0)")
    assert suite.main([]) == 1


def test_repeats_list_what_failed_and_how_often(tests, capfd):
    tests(broken=BROKEN, flaky=FLAKY)
    assert repeats.main(["--times", "2", "--seed", "1"]) == 1
    out = capfd.readouterr().out.splitlines()
    assert sorted(out) == [
        "test_broken.py::test_broken  2 of 2  ValueError: no",
        "test_flaky.py::test_flaky  2 of 2  AssertionError: not alone",
    ]


def test_repeats_print_nothing_when_all_passed(tests, capfd):
    assert repeats.main(["--times", "1"]) == 0
    assert capfd.readouterr().out == ""
