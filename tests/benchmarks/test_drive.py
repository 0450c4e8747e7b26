"""The counts of found things on a drive."""

from __future__ import annotations

from benchmarks.sim.drive import Score, score, stops
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.schemas.entities import Entity, Pose, Provenance

KNOWN = ClassHierarchy({"Chair": frozenset({"Furniture"}), "Armchair": frozenset({"Chair", "Furniture"})})
SAID = Provenance(commit=1, stamp_ns=0, source="operator")


def _at(class_name: str, x: float) -> Entity:
    name = f"{class_name.lower()}_{x:g}"
    return Entity(
        name=name, class_=class_name, iri=name, types=(), pose=Pose(position_m=(x, 0.0, 0.0)),
        provenance=SAID, pose_provenance=SAID, shape_provenance=SAID, reference_provenance=SAID,
    )  # fmt: skip


def test_a_thing_is_found_by_its_class_and_by_any_above_it() -> None:
    for name in ("Chair", "Furniture", "Object"):
        assert score([_at("Chair", 0.0)], [_at(name, 0.1)], KNOWN) == Score(1, 0, 0)


def test_a_thing_is_not_found_by_what_is_taken_for_something_else() -> None:
    for name in ("Cup", "Armchair"):
        assert score([_at("Chair", 0.0)], [_at(name, 0.1)], KNOWN) == Score(0, 0, 0)
        assert score([_at("Chair", 0.0)], [_at(name, 0.1)]) == Score(1, 0, 0)


def test_one_seen_thing_finds_one_thing_and_a_second_is_a_double() -> None:
    assert score([_at("Chair", 0.0), _at("Chair", 0.3)], [_at("Chair", 0.05)], KNOWN) == Score(1, 0, 0)
    assert score([_at("Chair", 0.0)], [_at("Chair", 0.05), _at("Chair", 0.1)], KNOWN) == Score(1, 1, 0)


def test_over_20_cm_is_a_wrong_place_and_over_60_cm_is_not_found() -> None:
    assert score([_at("Chair", 0.0)], [_at("Chair", 0.3)], KNOWN) == Score(1, 0, 1)
    assert score([_at("Chair", 0.0)], [_at("Chair", 0.7)], KNOWN) == Score(0, 0, 0)


def test_each_seed_is_a_course_of_its_own_near_the_first() -> None:
    first, second, third = stops(0), stops(1), stops(2)
    assert second == stops(1)
    assert second != third
    for (at, yaw), (other, turned) in zip(first, second, strict=True):
        assert 0.0 < max(abs(a - b) for a, b in zip(at, other, strict=True)) <= 0.08
        assert abs(yaw - turned) <= 0.12
