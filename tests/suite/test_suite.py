"""Tests are dealt to workers; a test that needs a process and fails is run once more, alone."""

import pytest

from tests.suite import __main__ as suite
from tests.suite import pytest_runs, repeats
from tests.suite.pytest_plugin import deal, share_out

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
    """A function that writes a file of tests, in a folder of its own."""
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers =\n    long\n    process\n")
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "test_good.py").write_text(GOOD)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(suite.ROOT))
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.delenv("PYTEST_ADDOPTS", raising=False)
    monkeypatch.setattr(suite, "IN_PARALLEL", ())
    monkeypatch.setattr(repeats, "IN_PARALLEL", ())
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


def test_each_worker_begins_with_its_share_of_the_slow_files():
    shares = [["a1", "a2", "c1"], ["b1"]]
    fast = [["d1", "d2", "d3"], ["e1"], ["f1"]]
    assert deal(shares, fast) == ["a1", "a2", "c1", "d1", "b1", "d2", "d3", "e1", "f1"]


def test_a_share_of_slow_tests_may_be_longer_than_the_others():
    assert deal([["a1", "a2", "a3"], []], [["b1"]]) == ["a1", "a2", "a3", "b1"]


def test_files_that_use_the_same_shared_system_are_given_to_one_worker():
    files = [["a1", "a2"], ["map1"], ["b1"], ["both1"], ["scene1"], ["c1"], ["map2"], ["d1"]]
    shares = share_out(files, 3, _systems_by_name, _load_by_name)
    assert shares == [["map1", "map2", "c1"], ["both1", "scene1", "d1"], ["a1", "a2", "b1"]]


def test_files_without_shared_systems_are_divided_equally():
    files = [["a1", "a2"], ["b1"], ["c1"], ["d1"], ["e1"]]
    assert share_out(files, 2, _systems_by_name, _load_by_name) == [["a1", "a2", "c1", "e1"], ["b1", "d1"]]


def test_a_file_that_takes_longer_stands_for_several():
    files = [["a1"], ["b1"], ["slow1"], ["c1"], ["d1"], ["e1"]]
    assert share_out(files, 2, _systems_by_name, _load_by_name) == [["a1", "slow1"], ["b1", "c1", "d1", "e1"]]


def _load_by_name(tests):
    return 3 if tests[0].startswith("slow") else 1


def _systems_by_name(tests):
    first = tests[0].rstrip("0123456789")
    return {"both": ("scene", "map")}.get(first, (first,) if first in ("map", "scene") else ())


@pytest.mark.parametrize("workers", [1, 2, 3, 7])
def test_no_test_is_lost_by_the_dealing(workers):
    slow = [[f"{kind}{file}{test}" for test in range(file)] for file in range(5) for kind in ("s", "map")]
    slow = [file for file in slow if file]
    fast = [[f"f{file}{test}" for test in range(file)] for file in range(8)]
    dealt = deal(share_out(slow, workers, _systems_by_name, _load_by_name), fast)
    assert sorted(dealt) == sorted(test for file in slow + fast for test in file)


def test_temporary_files_are_in_memory_where_there_is_room(tmp_path, monkeypatch):
    monkeypatch.delenv("TMPDIR", raising=False)
    monkeypatch.setattr(pytest_runs, "_MEMORY", tmp_path)
    monkeypatch.setattr(pytest_runs, "_ENOUGH_BYTES", 1)
    assert pytest_runs.keep_files_in_memory() == {"TMPDIR": str(tmp_path)}
    monkeypatch.setattr(pytest_runs, "_ENOUGH_BYTES", 1 << 60)
    assert pytest_runs.keep_files_in_memory() == {}
    monkeypatch.setattr(pytest_runs, "_MEMORY", tmp_path / "missing")
    assert pytest_runs.keep_files_in_memory() == {}


def test_a_folder_for_temporary_files_that_is_set_is_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    assert pytest_runs.keep_files_in_memory() == {}
