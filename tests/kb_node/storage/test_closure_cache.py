import pytest

from semmap.nodes.kb_node.reasoner import compiled
from semmap.nodes.kb_node.storage import closure_cache, conclusions_format
from semmap.ontology import vocabulary as v
from tests.kb_node.home import TBOX

CHAIR, OBJECT = v.dm("Chair"), v.dm("Object")


@pytest.fixture
def closings(monkeypatch):
    """How often a schema was closed."""
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


def test_another_tbox_takes_its_place(tmp_path, closings):
    check(tmp_path)
    closure_cache.load_reasoner(
        [*TBOX, (CHAIR, v.RDFS_LABEL, '"Stuhl"@de'), (OBJECT, v.RDFS_SUB_CLASS_OF, OBJECT)], tmp_path
    )
    assert len(closings) == 2
    assert len(list(tmp_path.iterdir())) == 1


def test_other_code_closes_it_anew(tmp_path, closings, monkeypatch):
    check(tmp_path)
    monkeypatch.setattr(conclusions_format, "format_mark", lambda: b"other")
    check(tmp_path)
    assert len(closings) == 2


@pytest.mark.parametrize(
    "damage", [lambda content: content[:-1], lambda content: b"", lambda c: c[:40] + b"!" + c[41:]]
)
def test_what_is_damaged_does_not_count(tmp_path, closings, damage):
    check(tmp_path)
    (path,) = tmp_path.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    check(tmp_path)
    assert len(closings) == 2
    check(tmp_path)
    assert len(closings) == 2


def test_a_folder_that_takes_no_file_is_no_obstacle(tmp_path, closings):
    check(tmp_path / "absent")
    assert len(closings) == 1


def test_one_of_the_past_leaves_the_present_one(tmp_path, closings):
    check(tmp_path)
    (present,) = tmp_path.iterdir()
    before = [*TBOX, (CHAIR, v.RDFS_LABEL, '"Stuhl"@de')]
    closure_cache.load_reasoner(before, tmp_path, of_the_past=True)
    assert [*tmp_path.iterdir()] == [present]
    assert len(closings) == 2
    closure_cache.load_reasoner(TBOX, tmp_path, of_the_past=True)
    assert len(closings) == 2
