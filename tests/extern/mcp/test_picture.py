import base64
import io
import json

import numpy as np
import pytest
from PIL import Image

from semmap.schemas import errors
from tests.extern.mcp.conftest import by_stdio, run


@pytest.fixture(scope="module")
def simulated(flat_scene):
    return flat_scene


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def test_names_are_written_on_a_picture_of_one_place(simulated):
    with simulated.client() as client:
        plain = pixels(client.picture(place="kitchen1", width=480, height=360))
        labelled = pixels(client.picture(place="kitchen1", labels=True, width=480, height=360))
        everything = pixels(client.picture(labels=True, width=480, height=360))
        with pytest.raises(errors.Refused, match="cup1 is not a place"):
            client.picture(place="cup1")
        with pytest.raises(errors.BadRequest, match="either a camera or a place"):
            client.picture("front", place="kitchen1")
    assert plain.shape == labelled.shape == (360, 480, 3)
    written = (np.abs(labelled - plain) > 60).any(axis=2).mean()
    assert 0.01 < written < 0.4
    assert (np.abs(labelled - everything) > 60).any(axis=2).mean() > 0.2


def test_an_agent_is_given_a_png(simulated):
    async def session():
        async with by_stdio(simulated.endpoint) as agent:
            found = await agent.raw("picture", place="kitchen1", width=320, height=240)
            refused = await agent.refused("picture", place="cup1")
            return found, refused

    found, refused = run(session())
    image, text = found.content
    assert image.mime_type == "image/png"
    assert pixels(base64.b64decode(image.data)).shape == (240, 320, 3)
    assert json.loads(text.text)["of"] == "kitchen1"
    assert "not a place" in refused


def test_without_a_simulator_there_is_none(flat):
    async def session():
        async with by_stdio(flat.endpoint) as agent:
            return await agent.refused("picture")

    assert "no simulator is running" in run(session())
