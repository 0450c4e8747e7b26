"""Places on the floor of the scene."""

from types import SimpleNamespace

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.extern.web.scene.rooms import Rooms
from semmap.schemas.polygons import EXTENT, box_around, read_wkt
from tests.extern.web.scene.sample_scenes import entity, pose

L = "POLYGON ((2 1, 6 1, 6 3, 4 3, 4 5, 2 5, 2 1))"


class Drawn:
    """A stub of viser that records nodes by name."""

    def __init__(self):
        self.there = {}

    def remove_by_name(self, name):
        self.there.pop(name, None)

    def add_mesh_simple(self, name, vertices, faces, **how):
        self.there[name] = (vertices, faces, how)
        return SimpleNamespace(remove=lambda: self.there.pop(name))

    def add_batched_meshes_simple(self, name, _points, _triangles, **how):
        self.there[name] = how


@pytest.fixture
def there():
    at, size = box_around(read_wkt(L), 0.0, 2.5)
    box = structs.replace(entity("kitchen1", at=pose(9.0, 0.0)), place=True, size_m=(2.0, 3.0, 2.5))
    polygon = structs.replace(
        entity("hall1", at=pose(*at[:2])), place=True, size_m=size, properties={EXTENT: L}
    )
    return {"kitchen1": box, "hall1": polygon}


def test_polygons_are_drawn_in_their_shape(there):
    drawn = Drawn()
    Rooms(drawn).show(there)
    assert [tuple(size[:2]) for size in drawn.there["/rooms/floors"]["batched_scales"]] == [(2.0, 3.0)]
    vertices, faces, how = drawn.there["/rooms/outlines/hall1"]
    a, b, c = (vertices[faces[:, k], :2].astype(float) for k in range(3))
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2.0
    assert areas.sum() == pytest.approx(12.0)
    assert tuple(how["position"][:2]) == (4.0, 3.0)


def test_changed_extents_are_redrawn_and_removed_ones_deleted(there):
    drawn = Drawn()
    rooms = Rooms(drawn)
    rooms.show(there)
    before = drawn.there["/rooms/outlines/hall1"]
    rooms.show(there)
    assert drawn.there["/rooms/outlines/hall1"] is before  # nothing differs
    smaller = "POLYGON ((2 1, 6 1, 6 5, 2 5, 2 1))"
    rooms.show({**there, "hall1": structs.replace(there["hall1"], properties={EXTENT: smaller})})
    assert not np.array_equal(drawn.there["/rooms/outlines/hall1"][0], before[0])
    rooms.show({"kitchen1": there["kitchen1"]})
    assert set(drawn.there) == {"/rooms/floors"}
    rooms.show({"hall1": there["hall1"]})
    assert set(drawn.there) == {"/rooms/outlines/hall1"}
    rooms.show({})
    assert not drawn.there
