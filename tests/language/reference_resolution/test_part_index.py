import pytest

from semmap.nodes.language.reference_resolution.part_index import PartIndex


def index(**values):
    found = PartIndex()
    for name, (prop, others) in values.items():
        found.add(name, {prop: frozenset(others)})
    return found


def test_parts_of_parts_are_parts():
    parts = index(fridge=("hasPhysicalComponent", ["door"]), handle=("isDirectPartOf", ["door"]))
    assert parts.is_part("door", "fridge")
    assert parts.is_part("handle", "fridge")
    assert not parts.is_part("fridge", "handle")
    assert not parts.is_part("handle", "oven")


@pytest.mark.parametrize(
    "prop", ["hasPart", "hasComponent", "dul:hasConstituent", "properPhysicalParts", "containsElement"]
)
def test_properties_of_several_ontologies_state_parts(prop):
    assert index(a=(prop, ["b"])).is_part("b", "a") == (prop != "containsElement")


@pytest.mark.parametrize("prop", ["isPartOf", "isDirectPartOf", "soma:isPhysicalComponentOf"])
def test_inverse_properties_state_wholes(prop):
    assert index(a=(prop, ["b"])).is_part("a", "b")


def test_other_properties_and_values_state_nothing():
    parts = index(a=("isOwnedBy", ["b"]), c=("hasPart", [True, 3]))
    assert not parts.is_part("a", "b")
    assert not parts.is_part("b", "a")


def test_a_cycle_ends():
    parts = index(a=("hasPart", ["b"]), b=("hasPart", ["a"]))
    assert parts.is_part("a", "b")
    assert parts.is_part("a", "a")
    assert not parts.is_part("a", "c")


def test_statements_are_removed_with_their_entity():
    parts = index(a=("hasPart", ["b"]), b=("isPartOf", ["a"]))
    parts.remove("a")
    assert parts.is_part("b", "a")
    parts.remove("b")
    parts.remove("b")
    assert not parts.is_part("b", "a")
