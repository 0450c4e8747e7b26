"""The size of an entity in a reply: from the map, its model, or none."""

from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.local_queries import LocalQueries
from semmap.schemas import bridge, errors
from semmap.schemas import commands as c
from semmap.schemas.entities import BodyState
from semmap.schemas.relations import Described
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


class Here:
    """A map with two cups, one with a body, and a knowledge base that has another one."""

    def __init__(self, class_names=("Cup",)):
        def find(word):
            if word.capitalize() in class_names:
                return SimpleNamespace(name=word.capitalize())
            raise errors.UnknownClass(f"no class is named '{word}'")

        self.asked = []
        view = MapView()
        view.entities = {name: thing(name, (0.0, 0.0, 0.0)) for name in ("cup2", "cup1")}
        view.classes = SimpleNamespace(find=find, by_name={"Cup": SimpleNamespace(iri="urn:Cup")})
        reconciler = SimpleNamespace(
            body_state=lambda entity: BodyState(status="present"), scene=SimpleNamespace(bodies={})
        )
        kb = SimpleNamespace(ask_later=self._ask)
        self.queries = LocalQueries("map", SimpleNamespace(map=view), reconciler, None, kb, None, None)

    def _ask(self, query, patience_s):
        self.asked.append(query)
        future = Future()
        entity = structs.replace(thing("cup3", (0.0, 0.0, 0.0)), size_m=None)
        future.set_result((entity,) if isinstance(query, bridge.Entities) else Described.of(entity))
        return future

    def listed(self, **fields):
        """Return the name, the status of the body and whether there is a size, of each entity."""
        found = self.queries.list(c.List(**fields))
        there = found.result() if isinstance(found, Future) else found
        return [(entity.name, entity.body and entity.body.status, bool(entity.size_m)) for entity in there]


def test_the_present_is_listed_without_the_knowledge_base():
    here = Here()
    assert [name for name, _, _ in here.listed()] == ["cup1", "cup2"]
    assert {status for _, status, _ in here.listed(class_="cup")} == {"present"}
    assert here.asked == []


def test_entities_are_selected_by_the_knowledge_base_and_have_their_bodies():
    here = Here()
    assert here.listed(class_="cup", on="table1") == [("cup3", "present", True)]
    assert here.asked == [bridge.Entities(class_="Cup", where=c.List(on="table1").where)]


def test_the_past_is_listed_by_the_knowledge_base_without_bodies():
    here = Here()
    assert here.listed(as_of=4) == [("cup3", None, True)]
    assert here.listed(as_of=4, class_="mug") == [("cup3", None, True)]  # a class that there was then
    assert here.asked == [bridge.Entities(as_of=4), bridge.Entities(class_="mug", as_of=4)]


def test_all_individuals_are_listed_by_the_knowledge_base():
    here = Here()
    assert here.listed(all=True) == [("cup3", "present", True)]
    here.listed(all=True, class_="cup")
    here.listed(all=True, class_="person")  # a class that only the map may use
    assert here.asked == [bridge.Entities(class_=name, all=True) for name in (None, "Cup", "person")]
    for fields in ({"as_of": 4}, {"on": "table1"}, {"format": "lu4r"}):
        with pytest.raises(errors.BadRequest, match="remove --all or the other option"):
            here.listed(all=True, **fields)


def test_what_is_not_in_space_has_no_body_and_is_returned_by_the_knowledge_base():
    here = Here()
    person = structs.replace(thing("anna", (0.0, 0.0, 0.0)), in_space=False, size_m=None)
    assert here.queries._with_body(person) is person
    here.queries.get(c.Get(name="anna"))
    assert [query.name for query in here.asked] == ["anna"]


def test_a_class_that_only_the_map_may_declare_is_left_to_the_knowledge_base():
    here = Here()
    here.listed(class_="mug")
    assert here.asked == [bridge.Entities(class_="mug")]


def test_an_entity_is_returned_from_the_present_or_the_past():
    here = Here()
    assert here.queries.get(c.Get(name="cup1")).body.status == "present"
    assert here.asked == []
    then = here.queries.get(c.Get(name="cup1", as_of=4)).result()
    assert (then.body, bool(then.size_m)) == (None, True)
    where = here.queries.get(c.Get(name="cup1", where=True)).result()
    assert where.body.status == "present"
    assert [query.name for query in here.asked] == ["cup1", "cup1"]


def test_the_list_has_the_formats_of_other_systems():
    here = Here()
    assert [one["atom"] for one in here.queries.list(c.List(format="lu4r"))["entities"]] == ["cup1", "cup2"]
    assert {one["type_full"] for one in here.queries.list(c.List(format="legacy")).values()} == {"urn:Cup"}
