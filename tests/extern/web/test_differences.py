"""Differences between two states of the map."""

from msgspec import structs

from semmap.nodes.extern.web.differences import compare, find_differences, format_counts
from semmap.schemas.entities import orientation_from_yaw
from tests.recorder.messages import entity, pose


def by_name(*entities):
    return {e.name: e for e in entities}


CHAIR, CUP, TABLE = entity("chair1"), entity("cup1", "Cup", pose(1.0)), entity("table1", "Table")


def test_additions_removals_moves_and_changes_are_found():
    moved = structs.replace(CUP, pose=pose(2.0))
    renamed = structs.replace(TABLE, preferred_reference="desk", pose=pose(0.5))
    found = find_differences(by_name(CHAIR, CUP, TABLE), by_name(moved, renamed, entity("box1", "Box")))
    assert {name: d.mark for name, d in found.items()} == {
        "cup1": "moved",
        "table1": "changed",
        "box1": "added",
        "chair1": "removed",
    }
    assert (found["cup1"].was, found["cup1"].now) == (CUP, moved)
    assert found["cup1"].text == "moved from (1, 0, 0) to (2, 0, 0)"
    assert (found["chair1"].was, found["chair1"].now) == (CHAIR, None)
    assert format_counts(found) == "1 added, 1 removed, 1 moved, 1 changed"


def test_a_rotation_is_a_move():
    turned = structs.replace(CUP, pose=pose(1.0, wxyz=orientation_from_yaw(1.0)))
    assert compare(CUP, turned).mark == "moved"


def test_equal_entities_and_default_sizes_are_not_differences():
    again = structs.replace(CUP, size_m=(0.1, 0.1, 0.1))
    assert find_differences(by_name(CHAIR, CUP), by_name(CHAIR, again)) == {}
    assert find_differences(by_name(CHAIR, again), by_name(CHAIR, CUP)) == {}
    assert format_counts({}) == "no differences"
    larger = structs.replace(CUP, size_m=(0.2, 0.1, 0.1))
    assert compare(again, larger).mark == "changed"
