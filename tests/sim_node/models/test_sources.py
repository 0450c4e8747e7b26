"""Which file is whose model."""

from nodes.sim_node.models.sources import passed_over

MODELS = {"chair", "table", "sofa.obj", "/elsewhere/lamp.stl"}


def test_files_that_are_nobodys_model_are_passed_over(tmp_path):
    names = ("chair.glb", "sofa.obj", "chiar.stl", "Table.xml", "table.GLB", "zebra.obj", "chair.png")
    for name in names:
        (tmp_path / name).touch()
    assert passed_over(tmp_path, MODELS) == [
        "Table.xml (did you mean table?)",
        "chiar.stl (did you mean chair?)",
        "table.GLB (did you mean table?)",
        "zebra.obj",
    ]


def test_a_file_may_be_named_by_its_whole_path(tmp_path):
    (tmp_path / "vacuum.glb").touch()
    assert passed_over(tmp_path, {str(tmp_path / "vacuum.glb")}) == []
