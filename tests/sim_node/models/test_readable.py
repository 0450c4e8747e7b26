"""Names in a map make the simulator read only model files."""

from __future__ import annotations

import os
import struct

import pytest

from semmap.nodes.sim_node.models.library import ModelError
from semmap.nodes.sim_node.models.sources import Models

BOX = '<mujoco>{}<worldbody><body><geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>'


@pytest.fixture
def folders(tmp_path):
    for name in ("models", "data", "elsewhere"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "box.xml").write_text(BOX.format(""))
    return tmp_path


@pytest.fixture
def models(folders):
    return Models(folders / "models", folders / "data")


def test_models_of_both_folders_are_read(folders, models):
    assert models("box.xml", None).size_m == pytest.approx((0.2, 0.2, 0.2))
    for folder in ("models", "data"):
        assert models(str(folders / folder / "box.xml"), None).size_m == pytest.approx((0.2, 0.2, 0.2))


@pytest.mark.parametrize(
    "name",
    ["../elsewhere/box.xml", "{}/elsewhere/box.xml", "/etc/passwd.xml", "link.xml", "../models/../box.obj"],
)
def test_no_other_file_is(folders, models, name):
    (folders / "models" / "link.xml").symlink_to(folders / "elsewhere" / "box.xml")
    with pytest.raises(ModelError, match=r"only files in .*models or .*data are allowed"):
        models(name.format(folders), None)


def test_without_a_folder_there_is_none_to_read(folders):
    with pytest.raises(ModelError, match="are allowed"):
        Models()(str(folders / "models" / "box.xml"), None)


@pytest.mark.parametrize(
    "inside",
    [
        '<include file="{}/elsewhere/box.xml"/>',
        '<include file="../elsewhere/box.xml"/>',
        '<compiler meshdir="{}/elsewhere"/>',
        '<compiler assetdir=".."/><asset><mesh name="m" file="elsewhere/m.obj"/></asset>',
        '<asset><mesh name="m" file="/etc/passwd"/></asset>',
        '<asset><texture name="t" type="cube" fileright="../elsewhere/t.png"/></asset>',
        '<include file="within.xml"/>',
        '<asset><model name="m" file="within.xml"/></asset>',
        '<asset><model name="m" file="parts/attached.xml"/></asset>',
    ],
)
def test_nor_what_a_model_refers_to(folders, models, inside):
    (folders / "models" / "spy.xml").write_text(BOX.format(inside.format(folders)))
    (folders / "models" / "within.xml").write_text(
        "<mujocoinclude><include file='../elsewhere/box.xml'/></mujocoinclude>"
    )
    (folders / "models" / "parts").mkdir()
    (folders / "models" / "parts" / "attached.xml").write_text(
        BOX.format('<include file="../../elsewhere/box.xml"/>')
    )
    with pytest.raises(ModelError, match="are allowed"):
        models("spy.xml", None)


def test_what_it_refers_to_within_is_read(folders, models):
    (folders / "models" / "whole.xml").write_text(BOX.format('<include file="parts/assets.xml"/>'))
    (folders / "models" / "parts").mkdir()
    (folders / "models" / "parts" / "assets.xml").write_text(
        "<mujocoinclude><option gravity='0 0 0'/></mujocoinclude>"
    )
    assert models("whole.xml", None).size_m == pytest.approx((0.2, 0.2, 0.2))


@pytest.mark.parametrize("inside", ["", '<asset><mesh name="m" file="pipe.stl"/></asset>'])
def test_a_pipe_is_not_waited_for(folders, models, inside):
    for name in ("pipe.xml", "pipe.stl"):
        os.mkfifo(folders / "models" / name)
    (folders / "models" / "whole.xml").write_text(BOX.format(inside))
    with pytest.raises(ModelError, match="not a regular file"):
        models("whole.xml" if inside else "pipe.xml", None)


@pytest.mark.parametrize("inside", ["<body>" * 250 + "</body>" * 250, '<text name="&e;" data="1"/>'])
def test_a_model_that_is_nested_too_deeply_is_rejected(folders, models, inside):
    declared = "".join(f'<!ENTITY e{n} "&e{n + 1};">' for n in range(200_000))
    head = f'<!DOCTYPE mujoco [<!ENTITY e "&e0;">{declared}<!ENTITY e200000 "x">]>' if "&e" in inside else ""
    (folders / "models" / "deep.xml").write_text(head + BOX.format(inside))
    with pytest.raises(ModelError, match="nested deeper than 200 levels"):
        models("deep.xml", None)


def test_a_texture_is_not_decoded_if_it_is_too_large(folders, models):
    texture = '<asset><texture name="t" type="2d" file="t.png"/></asset>'
    (folders / "models" / "painted.xml").write_text(BOX.format(texture))
    head = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII", 13, b"IHDR", 30_000, 30_000)
    (folders / "models" / "t.png").write_bytes(head)
    with pytest.raises(ModelError, match=r"cannot use texture .*t\.png: the image has 30000 x 30000 pixels"):
        models("painted.xml", None)
