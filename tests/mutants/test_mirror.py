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
    own = OwnTests(("tests/a/b/test_d.py",), True, (("tests/a/test_b.py",),))
    assert find_own_tests(root, "nodes/a/b/d.py") == own
    assert find_own_tests(root, "schemas/codec.py").files == ("tests/schemas/test_codec.py",)


def test_the_mirrored_file_may_be_in_a_folder_above(root):
    own = find_own_tests(root, "nodes/a/b/c.py")
    assert own.files == ("tests/a/test_c.py",)
    assert own.is_mirrored


def test_a_package_itself_is_tried_against_the_file_of_its_name(root):
    assert find_own_tests(root, "nodes/a/b/__init__.py").files == ("tests/a/test_b.py",)


def test_without_a_mirrored_file_it_is_tried_against_those_of_its_folder(root):
    own = OwnTests(("tests/a/b/test_d.py", "tests/a/test_b.py"), is_mirrored=False)
    assert find_own_tests(root, "nodes/a/b/other.py") == own
    assert find_own_tests(root, "nodes/a/other.py").files == ("tests/a/test_b.py", "tests/a/test_c.py")


@pytest.mark.parametrize(
    "line",
    [
        "from semmap.nodes.a.b import other",
        "from semmap.nodes.a.b.other import function",
        "import semmap.nodes.a.b.other",
        "import json, semmap.nodes.a.b.other as o",
    ],
)
def test_a_change_that_they_miss_is_tried_against_what_imports_the_module(root, line):
    (root / "tests" / "a" / "test_c.py").write_text(f"{line}\n")
    own = find_own_tests(root, "nodes/a/b/other.py")
    assert own.groups == (("tests/a/b/test_d.py", "tests/a/test_b.py"), ("tests/a/test_c.py",))


@pytest.mark.parametrize("line", ["from semmap.nodes.a.b import another", "from semmap.other import b"])
def test_a_module_of_a_similar_name_is_not_the_module(root, line):
    (root / "tests" / "a" / "test_c.py").write_text(f"{line}\n")
    assert find_own_tests(root, "nodes/a/b/other.py").wider == ()


def test_those_of_folders_above_come_next_but_not_those_of_the_whole_node(root):
    (root / "tests" / "a" / "b" / "c").mkdir()
    (root / "tests" / "a" / "b" / "c" / "test_e.py").touch()
    own = OwnTests(("tests/a/b/c/test_e.py",), True, (("tests/a/b/test_d.py", "tests/a/test_b.py"),))
    assert find_own_tests(root, "nodes/a/b/c/e.py") == own


def test_tests_of_other_nodes_are_not_taken(root):
    assert find_own_tests(root, "nodes/e/c.py").files == ()
