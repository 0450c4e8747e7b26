"""Commands about exemplars."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from semmap.nodes.coordinator.exemplar_commands import ExemplarCommands
from semmap.nodes.runtime.class_names import ClassNames
from semmap.schemas import errors, keys
from semmap.schemas.commands import Forget, Learn
from semmap.schemas.entities import ClassInfo
from semmap.schemas.exemplars import ShownView
from tests.perception_node.things import at, entity

VIEW = ShownView(features=b"", size_m=(0.1, 0.1, 0.1))


def info(name, *, spatial=True, place=False):
    return ClassInfo(
        name=name,
        iri=f"http://example.org/{name}",
        parents=(),
        ancestors=(),
        labels={},
        spatial=spatial,
        place=place,
        fixed=False,
        model="",
    )


CLASSES = ClassNames([info("Cup"), info("Kitchen", place=True), info("Pose", spatial=False)])
THINGS = {"cup1": entity("cup1", "Cup", at(1.0, 1.0))}


def find(name):
    if name not in THINGS:
        raise errors.UnknownName(f"no entity is named '{name}'")
    return THINGS[name]


def teaching(*, perceives=True):
    dispatcher = SimpleNamespace(map=SimpleNamespace(classes=CLASSES, entity=find))
    return ExemplarCommands(dispatcher, lambda: perceives)


@pytest.mark.parametrize("shown", [{"entity": "cup1"}, {"views": (VIEW,)}])
def test_an_exemplar_is_forwarded_with_its_class_of_the_tbox(shown):
    relay = teaching().learn(Learn(class_="cup", **shown))
    assert (relay.prefix, relay.call) == (keys.PERCEPTION, Learn(class_="Cup", **shown))


@pytest.mark.parametrize(
    ("command", "error", "said"),
    [
        (Learn(class_="Cupp", entity="cup1"), errors.UnknownClass, "did you mean Cup.*learn --new-class"),
        (Learn(class_="Kitchen", entity="cup1"), errors.UnknownClass, "is a class of places"),
        (Learn(class_="Pose", entity="cup1"), errors.UnknownClass, "not a spatial class"),
        (Learn(class_="Cup", entity="cup2"), errors.UnknownName, "no entity is named 'cup2'"),
        (Learn(class_="Cup"), errors.BadRequest, "give either an entity"),
        (Learn(class_="Cup", entity="cup1", views=(VIEW,)), errors.BadRequest, "give either an entity"),
    ],
)
def test_an_invalid_exemplar_is_rejected(command, error, said):
    with pytest.raises(error, match=said):
        teaching().learn(command)


def test_without_perception_the_error_has_the_next_step():
    with pytest.raises(errors.NoAnswer, match="semmap up --perception"):
        teaching(perceives=False).relay(Forget(number=1))
