"""The file of each model."""

import os

import pytest

from semmap.nodes.sim_node.models.library import ModelError
from semmap.nodes.sim_node.models.library import build as built_in
from semmap.nodes.sim_node.models.sources import Models, ignored_files, is_one_of

MODELS = {"chair", "table", "sofa.obj", "/elsewhere/lamp.stl"}
PLINTH = """<mujoco><worldbody><body>
  <geom type="box" size="{} 0.2 0.25" pos="0 0 0.25"/>
</body></worldbody></mujoco>"""


def plinth(folder, name, half_m=0.3):
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_text(PLINTH.format(half_m))
    return path


def test_files_that_are_nobodys_model_are_passed_over(tmp_path):
    names = ("chair.glb", "sofa.obj", "chiar.stl", "Table.xml", "table.GLB", "zebra.obj", "chair.png")
    for name in names:
        (tmp_path / name).touch()
    assert ignored_files(tmp_path, MODELS) == [
        "Table.xml (did you mean table?)",
        "chiar.stl (did you mean chair?)",
        "table.GLB (did you mean table?)",
        "zebra.obj",
    ]


def test_a_file_may_be_named_by_its_whole_path(tmp_path):
    (tmp_path / "vacuum.glb").touch()
    assert ignored_files(tmp_path, {str(tmp_path / "vacuum.glb")}) == []
    assert not is_one_of(tmp_path / "chair.png", {"chair", "chair.png"})


def test_a_model_of_the_folder_takes_the_place_of_the_library_s_and_others_stay(tmp_path):
    models = Models(tmp_path)
    assert models("chair", None) == built_in("chair", None)
    plinth(tmp_path, "chair.xml")
    assert models("chair", None).size_m == pytest.approx((0.6, 0.4, 0.5))
    assert models("chair", (1.2, 0.4, 0.5)).size_m == pytest.approx((1.2, 0.4, 0.5))
    assert models("table", None) == built_in("table", None)
    assert models("", None) == built_in("", None)
    assert Models()("chair", None) == built_in("chair", None)


def test_a_model_may_be_a_file_s_name_or_a_path_in_the_folder_or_the_data_of_the_system(tmp_path):
    own, data = tmp_path / "own", tmp_path / "data"
    in_own, in_data = plinth(own, "plinth.xml", 0.3), plinth(data, "stele.xml", 0.4)
    models = Models(own, data)
    assert models("plinth.xml", None).size_m[0] == pytest.approx(0.6)
    assert models(str(in_own), None).size_m[0] == pytest.approx(0.6)
    assert models(str(in_data), None).size_m[0] == pytest.approx(0.8)
    assert Models(None, data)(str(in_data), None).size_m[0] == pytest.approx(0.8)


def test_what_lies_elsewhere_is_not_read(tmp_path):
    own, other = tmp_path / "own", plinth(tmp_path / "other", "plinth.xml")
    own.mkdir()
    with pytest.raises(ModelError):
        Models(own)(str(other), None)


def test_nor_is_what_a_model_of_the_folder_refers_to_there(tmp_path):
    (tmp_path / "secret.stl").write_bytes(b"secret")
    own = tmp_path / "own"
    own.mkdir()
    mesh = '<asset><mesh name="m" file="../secret.stl"/></asset>'
    (own / "leak.xml").write_text(f"<mujoco>{mesh}<worldbody><geom/></worldbody></mujoco>")
    with pytest.raises(ModelError, match="secret"):
        Models(own)("leak", None)


def test_a_file_s_name_without_a_folder_and_a_file_that_is_not_there_are_told(tmp_path):
    with pytest.raises(ModelError, match="semmap up --models DIR"):
        Models()("plinth.xml", None)
    with pytest.raises(ModelError, match=r"plinth\.xml"):
        Models(tmp_path)("plinth.xml", None)


def test_a_file_that_has_changed_is_read_once_more(tmp_path):
    models = Models(tmp_path)
    path = plinth(tmp_path, "chair.xml", 0.3)
    assert models("chair", None).size_m[0] == pytest.approx(0.6)
    path.write_text(PLINTH.format(0.5))
    os.utime(path, ns=(1, 1))
    assert models("chair", None).size_m[0] == pytest.approx(1.0)
