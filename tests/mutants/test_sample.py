"""Mutants are drawn by a seed, one for a line, and are other programs."""

import pytest

from tests.mutants.sample import draw

CODE = '''"""Not 1 + 1."""
import logging
log = logging.getLogger(__name__)

def area(width: int | None, *, height=2, strict=True):
    if width is None or height < 0:
        log.warning("%s", 1 + 1)
        return 0
    return width * height * 3
'''


@pytest.fixture
def root(tmp_path):
    (tmp_path / "nodes").mkdir()
    (tmp_path / "nodes" / "area.py").write_text(CODE)
    return tmp_path


def test_each_line_that_can_be_changed_is_drawn_once(root):
    assert sorted(mutant.line for mutant in draw(root, "nodes", 60, 1)) == [5, 6, 8, 9]


def test_a_mutant_is_the_module_with_one_line_changed(root):
    for mutant in draw(root, "nodes/area.py", 60, 1):
        there, here = CODE.splitlines(), mutant.code.splitlines()
        changed = [i for i, (a, b) in enumerate(zip(there, here, strict=True), 1) if a != b]
        assert changed == [mutant.line]
        compile(mutant.code, mutant.path, "exec")
        assert mutant.describe().startswith(f"nodes/area.py:{mutant.line}  {there[mutant.line - 1].strip()}  ->")


def test_the_same_seed_draws_the_same(root):
    assert draw(root, "nodes", 3, 7) == draw(root, "nodes", 3, 7)
    assert len({draw(root, "nodes", 1, seed)[0].line for seed in range(20)}) > 1
