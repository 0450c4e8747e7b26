"""The size of an entity in a reply: from the map, its model, or none."""

from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.local_queries import LocalQueries
from semmap.schemas.entities import BodyState
from tests.kb_node.relations.entities import thing

BODY = SimpleNamespace(size_m=(0.3, 0.3, 0.3))


def seen(entity, body=BODY):
    """The entity as `list` and `get` return it, with its body."""
    state = BodyState(status="unknown" if body is None else "present")
    reconciler = SimpleNamespace(
        body_state=lambda _: state, scene=SimpleNamespace(bodies={} if body is None else {entity.name: body})
    )
    return LocalQueries("map", None, reconciler, None, None, None, None)._with_body(entity)


@pytest.mark.parametrize("body", [BODY, None])
def test_an_object_without_known_size_has_none(body):
    found = seen(structs.replace(thing("probe1", (0.0, 0.0, 0.0), ""), size_m=None), body)
    assert (found.size_m, found.body.own_size) == (None, False)
    stands_in = "shown as a box of 0.3 x 0.3 x 0.3 m"
    assert found.body.detail.startswith(stands_in) if body else not found.body.detail


def test_a_size_that_is_stated_or_a_model_s():
    stated = seen(thing("probe1", (0.0, 0.0, 0.0), "", size=(1.0, 2.0, 3.0)))
    assert (stated.size_m, stated.body.own_size) == ((1.0, 2.0, 3.0), False)
    cup = thing("cup1", (0.0, 0.0, 0.0))
    for body in (SimpleNamespace(size_m=cup.size_m), None):
        found = seen(structs.replace(cup, size_m=None), body)
        assert found.size_m == pytest.approx(cup.size_m, abs=1e-4)
        assert found.body.own_size
