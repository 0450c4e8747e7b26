"""A user's models have shapes like the library's."""

import pytest

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.sim_node.models.write_shapes import own_shapes, write_own
from semmap.ontology import model_shapes
from tests.kb_node.relations.entities import thing

PLINTH = """<mujoco><worldbody>
  <body>
    <geom type="box" size="0.3 0.2 0.05" pos="0 0 0.45"/>
    <geom type="cylinder" size="0.05 0.2" pos="0 0 0.2"/>
  </body>
</worldbody></mujoco>"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "plinth.xml").write_text(PLINTH)
    (tmp_path / "broken.obj").write_text("no mesh")
    (tmp_path / "notes.txt").write_text("nothing")
    return tmp_path


def test_they_are_read_off_the_files_that_can_be_used(folder):
    found = own_shapes(folder)
    assert found.keys() == {"plinth", "plinth.xml"}
    shape = found["plinth"]
    assert shape.size_m == pytest.approx((0.6, 0.4, 0.5))
    assert shape.surfaces[0].height == pytest.approx(0.5)
    assert len(shape.parts) == 2
    assert not shape.turns


def test_the_knowledge_base_reads_them_and_an_entity_without_a_size_has_its_model_s(
    folder, tmp_path, monkeypatch
):
    target = tmp_path / "model_shapes.json"
    write_own(folder, target)
    known = dict(model_shapes.shapes())
    monkeypatch.setattr(model_shapes, "shapes", lambda: known)
    monkeypatch.setattr(model_shapes, "_own", {})
    model_shapes.add_own(target)
    facts = Facts()
    facts.update([thing("plinth1", (0.0, 0.0, 0.0)), thing("cup1", (0.1, 0.0, 0.5))])
    assert ("cup1", "isOn", "plinth1") in facts
    assert facts.space.solids["plinth1"].size == pytest.approx((0.6, 0.4, 0.5))


def test_without_a_folder_there_are_none_any_more(tmp_path):
    target = tmp_path / "model_shapes.json"
    target.write_text("{}")
    write_own(None, target)
    assert not target.exists()
    model_shapes.add_own(target)


def test_shapes_that_cannot_be_written_leave_the_former_file(folder, tmp_path):
    target = tmp_path / "model_shapes.json"
    write_own(folder, target)
    before = target.read_bytes()
    target.with_name(f"{target.name}.partly").mkdir()
    with pytest.raises(OSError, match="directory"):
        write_own(folder, target)
    assert target.read_bytes() == before
