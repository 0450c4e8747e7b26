"""The mapping of modules to their tests."""

import pytest

from tests.mutants.mirror import OwnTests, find_own_tests


@pytest.fixture
def root(tmp_path):
    for file in ("a/test_c.py", "a/b/test_d.py", "a/test_b.py", "schemas/test_codec.py"):
        path = tmp_path / "tests" / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path


def test_a_module_is_tried_against_the_mirrored_file(root):
    assert find_own_tests(root, "nodes/a/b/d.py") == OwnTests(("tests/a/b/test_d.py",), is_mirrored=True)
    assert find_own_tests(root, "schemas/codec.py").files == ("tests/schemas/test_codec.py",)


def test_the_mirrored_file_may_be_in_a_folder_above(root):
    assert find_own_tests(root, "nodes/a/b/c.py") == OwnTests(("tests/a/test_c.py",), is_mirrored=True)


def test_a_package_itself_is_tried_against_the_file_of_its_name(root):
    assert find_own_tests(root, "nodes/a/b/__init__.py").files == ("tests/a/test_b.py",)


def test_without_a_mirrored_file_it_is_tried_against_those_of_its_folder(root):
    own = OwnTests(("tests/a/b/test_d.py", "tests/a/test_b.py"), is_mirrored=False)
    assert find_own_tests(root, "nodes/a/b/other.py") == own
    assert find_own_tests(root, "nodes/a/other.py").files == ("tests/a/test_b.py", "tests/a/test_c.py")


def test_tests_of_other_nodes_are_not_taken(root):
    assert find_own_tests(root, "nodes/e/c.py").files == ()
