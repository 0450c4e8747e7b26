"""glTF files and colours."""

import json
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.extern.web.scene.meshes import cube, glb, linear, opacity_of, srgb, tinted
from tests.extern.web.scene.sample_scenes import surface


def parts(file):
    """Return the JSON and the binary part of a binary glTF file."""
    magic, version, length = struct.unpack_from("<4sII", file)
    assert (magic, version, length) == (b"glTF", 2, len(file))
    size, kind = struct.unpack_from("<I4s", file, 12)
    assert kind == b"JSON"
    text, rest = file[20 : 20 + size], file[20 + size :]
    binary_size, kind = struct.unpack_from("<I4s", rest)
    assert (kind, binary_size) == (b"BIN\0", len(rest) - 8)
    return json.loads(text), rest[8:]


def array(scene, binary, number, dtype):
    view = scene["bufferViews"][scene["accessors"][number]["bufferView"]]
    return np.frombuffer(binary[view["byteOffset"] :][: view["byteLength"]], dtype)


def test_the_gltf_file_contains_the_surface():
    scene, binary = parts(glb(surface((2.0, 1.0, 3.0))))
    points = array(scene, binary, 0, "<f4").reshape(-1, 3)
    triangles = array(scene, binary, 3, "<u4")
    assert np.ptp(points, axis=0) == pytest.approx((2.0, 1.0, 3.0))
    assert scene["accessors"][0]["min"] == pytest.approx(points.min(axis=0))
    assert (len(triangles), triangles.max()) == (36, 23)
    assert array(scene, binary, 2, "<f4").reshape(-1, 3)[0] == pytest.approx((1.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("appearance", "mode"), [("solid", "OPAQUE"), ("past", "OPAQUE"), ("ghost", "BLEND")]
)
def test_transparent_appearances_are_blended(appearance, mode):
    material = parts(glb(surface(), appearance))[0]["materials"][0]
    assert material["alphaMode"] == mode
    assert material["pbrMetallicRoughness"]["baseColorFactor"][3] == opacity_of(appearance)


def test_the_past_is_tinted():
    red = np.array([(1.0, 0.0, 0.0)])
    assert tinted(red, "solid") == pytest.approx(red)
    assert np.abs(tinted(red, "past") - red).max() > 0.2


@given(st.lists(st.integers(0, 255), min_size=3, max_size=3))
def test_colours_survive_conversion_to_linear_and_back(rgb):
    assert srgb(linear(np.array([rgb], dtype=np.uint8))).tolist() == [rgb]


def test_the_cube_has_its_origin_at_the_bottom_and_outward_faces():
    points, triangles = cube()
    assert points.min(axis=0) == pytest.approx((-0.5, -0.5, 0.0))
    assert points.max(axis=0) == pytest.approx((0.5, 0.5, 1.0))
    a, b, c = (points[triangles[:, i]] for i in range(3))
    outward = (a + b + c) / 3.0 - (0.0, 0.0, 0.5)
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), outward) > 0.0).all()
