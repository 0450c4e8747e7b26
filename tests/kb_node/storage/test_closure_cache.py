import pytest

from semmap.nodes.kb_node.reasoner import compiled
from semmap.nodes.kb_node.storage import closure_cache, conclusions_format
from semmap.ontology import vocabulary as v
from tests.kb_node.home import TBOX

CHAIR, OBJECT = v.dm("Chair"), v.dm("Object")


@pytest.fixture
def closings(monkeypatch):
    """Count how often a closure was computed."""
    close, counted = compiled.Closure, []

    def closure(triples):
        counted.append(1)
        return close(triples)

    monkeypatch.setattr(compiled, "Closure", closure)
    return counted


def check(folder):
    reasoner = closure_cache.load_reasoner(TBOX, folder)
    assert OBJECT in reasoner.superclasses(CHAIR)
    assert set(reasoner.asserted()) == set(TBOX)


def test_a_tbox_is_closed_once(tmp_path, closings):
    for _ in range(3):
        check(tmp_path)
    assert len(closings) == 1
    closure_cache.load_reasoner(TBOX[::-1], tmp_path)
    assert len(closings) == 1


def test_another_tbox_replaces_the_closure(tmp_path, closings):
    check(tmp_path)
    closure_cache.load_reasoner(
        [*TBOX, (CHAIR, v.RDFS_LABEL, '"Stuhl"@de'), (OBJECT, v.RDFS_SUB_CLASS_OF, OBJECT)], tmp_path
    )
    assert len(closings) == 2
    assert len(list(tmp_path.iterdir())) == 1


def test_another_format_computes_the_closure_again(tmp_path, closings, monkeypatch):
    check(tmp_path)
    monkeypatch.setattr(conclusions_format, "format_mark", lambda: b"other")
    check(tmp_path)
    assert len(closings) == 2


@pytest.mark.parametrize(
    "damage", [lambda content: content[:-1], lambda content: b"", lambda c: c[:40] + b"!" + c[41:]]
)
def test_a_damaged_cache_is_ignored(tmp_path, closings, damage):
    check(tmp_path)
    (path,) = tmp_path.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    check(tmp_path)
    assert len(closings) == 2
    check(tmp_path)
    assert len(closings) == 2


def test_an_unwritable_folder_is_accepted(tmp_path, closings):
    check(tmp_path / "absent")
    assert len(closings) == 1


def test_a_past_tbox_keeps_the_current_closure(tmp_path, closings):
    check(tmp_path)
    (present,) = tmp_path.iterdir()
    before = [*TBOX, (CHAIR, v.RDFS_LABEL, '"Stuhl"@de')]
    closure_cache.load_reasoner(before, tmp_path, of_the_past=True)
    assert [*tmp_path.iterdir()] == [present]
    assert len(closings) == 2
    closure_cache.load_reasoner(TBOX, tmp_path, of_the_past=True)
    assert len(closings) == 2
