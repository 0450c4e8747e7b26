from types import SimpleNamespace

import numpy as np
import pytest

from semmap.nodes.perception_node.image_features import network
from semmap.nodes.perception_node.image_features.efficientnet import SIDE
from semmap.schemas.errors import BadFile


def test_the_network_recognises_what_it_was_trained_on():
    if not network.available():
        pytest.skip("the network's packages are not installed")
    rows, columns = np.mgrid[:SIDE, :SIDE]
    colours = np.full((SIDE, SIDE, 3), 40, np.uint8)
    colours[(rows - 112) ** 2 + (columns - 112) ** 2 < 80**2] = (235, 130, 20)
    found = network.load_network()([colours, np.zeros_like(colours)])
    assert found.features.shape == (2, 1280)
    orange, lemon, power_drill = 950, 951, 740
    assert found.scores[0, orange] > found.scores[0, power_drill]
    assert found.scores[0, [orange, lemon]].max() > np.quantile(found.scores[0], 0.98)


@pytest.mark.parametrize(("content", "problem"), [(b"other", "unexpected content"), (None, "cannot read")])
def test_other_weights_are_rejected(tmp_path, monkeypatch, content, problem):
    folder = tmp_path / "models"
    folder.mkdir()
    if content is not None:
        (folder / network._FILE).write_bytes(content)
    spec = SimpleNamespace(origin=str(tmp_path / "__init__.py"))
    monkeypatch.setattr(network, "find_spec", lambda _: spec)
    with pytest.raises(BadFile, match=problem):
        network.load_network.__wrapped__()


def test_missing_weights_are_told(monkeypatch):
    monkeypatch.setattr(network, "find_spec", lambda _: None)
    assert not network.available()
    with pytest.raises(BadFile, match="not installed"):
        network.load_network.__wrapped__()
