"""A model file costs the reader's process at most."""

from contextlib import suppress

import pytest

from semmap.nodes.sim_node.models.library import ModelError
from semmap.nodes.sim_node.models.model_files import read_model
from semmap.nodes.sim_node.models.model_reader import ModelReader, answer
from semmap.nodes.sim_node.models.sources import Models
from semmap.schemas import errors

BOX = "<mujoco><worldbody><body><geom type='box' size='.1 .2 .3'/></body></worldbody></mujoco>"
MANY = """<mujoco><worldbody><replicate count='{}' offset='.1 0 0'>
  <body><geom size='.1'/></body>
</replicate></worldbody></mujoco>"""


@pytest.mark.process
def test_a_model_is_read_in_another_process_and_a_hanging_one_is_rejected(tmp_path):
    (tmp_path / "box.xml").write_text(BOX)
    (tmp_path / "many.xml").write_text(MANY.format(300_000))
    with ModelReader(cpu_s=1.0) as reader:
        models = Models(tmp_path, read=reader)
        with pytest.raises(ModelError, match=r"many\.xml takes longer than 1 s to read; simplify the model"):
            models("many.xml", None)
        assert models("box.xml", None).size_m == read_model(tmp_path / "box.xml", None, 0).size_m


def test_errors_are_remembered(tmp_path, monkeypatch):
    reader, requests = ModelReader(), []

    def exchange(request, subject):
        requests.append(subject)
        return answer(request)

    monkeypatch.setattr(reader, "exchange", exchange)
    path = tmp_path / "broken.xml"
    path.write_text("<mujoco")
    for version in (1, 1, 2):
        with pytest.raises(ModelError, match="cannot use model file"):
            reader(path, None, version)
    with pytest.raises(ModelError, match=r"cannot read model file .*none\.xml: No such file"):
        reader(tmp_path / "none.xml", None, 1)
    assert len(requests) == 3


@pytest.mark.parametrize("failure", [errors.BadFile("it takes longer"), errors.Refused("it does not start")])
def test_a_failed_process_is_tried_again_after_a_pause_and_three_times_at_most(
    tmp_path, monkeypatch, failure
):
    path, now, failures, requests = tmp_path / "box.xml", [0.0], [1], []
    path.write_text(BOX)

    def exchange(request, subject):
        requests.append(subject)
        if failures[0] > 0:
            failures[0] -= 1
            raise failure
        return answer(request)

    monkeypatch.setattr("time.monotonic", lambda: now[0])
    reader = ModelReader()
    monkeypatch.setattr(reader, "exchange", exchange)

    def is_read(version):
        with suppress(ModelError):
            return reader(path, None, version) is not None
        return False

    assert not is_read(1)
    assert not is_read(1)
    assert len(requests) == 1, "the simulator asks often, and each attempt takes long"
    now[0] += 61.0
    assert is_read(1)
    assert is_read(1)
    assert len(requests) == 2

    failures[0] = 10
    for _ in range(5):
        assert not is_read(2)
        now[0] += 61.0
    assert len(requests) == 2 + 3


def test_a_model_of_very_many_geoms_is_rejected(tmp_path):
    path = tmp_path / "many.xml"
    path.write_text(MANY.format(2001))
    with pytest.raises(ModelError, match="it has 2,001 geoms, and a model has 2,000 at most"):
        read_model(path, None, 0)
