"""Exemplars are learned from what cameras see, listed and removed."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.perception_node import exemplar_commands
from semmap.nodes.perception_node.exemplar_commands import ExemplarCommands, view_message
from semmap.nodes.perception_node.exemplar_store import ExemplarStore
from semmap.nodes.perception_node.exemplar_views import ExemplarView, exemplar_view_of
from semmap.nodes.perception_node.image_features.efficientnet import FEATURES
from semmap.nodes.perception_node.pipeline import FrameResult, observe_clouds, parts_in, shipped
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.schemas import errors, keys
from semmap.schemas.commands import Forget, Learn, Learned
from semmap.schemas.exemplars import ShownView
from semmap.schemas.perception import Observations
from tests.perception_node.scenes import shot
from tests.perception_node.things import CLASSES, at, seen


@pytest.fixture(scope="module")
def things():
    return [thing for thing in parts_in([segment_cloud(shot().clouds[0])]).things if thing.whole]


class Asked:
    """A node that calls the handlers itself."""

    def __init__(self, path: Path):
        self.path = path
        self.learnt = []
        self.hierarchy = CLASSES

    def serve(self, prefix, handlers):
        assert prefix == keys.PERCEPTION
        self._handlers = handlers

    def __call__(self, call):
        kind, function = self._handlers[call.VERB]
        assert isinstance(call, kind)
        return function(call)


@pytest.fixture
def asked(things, tmp_path):
    asked = Asked(tmp_path / "lessons.npz")
    store = ExemplarStore(asked.path, shipped())
    asked.commands = ExemplarCommands(asked, store, lambda: asked.hierarchy, asked.learnt.append)
    asked.commands.see(frame(things[:2]), named("thing1", ""))
    return asked


def frame(things):
    return FrameResult(Observations(stamp_ns=0, views=(), observations=()), (), things=tuple(things))


def named(*names):
    return [structs.replace(seen("Cup", at(0.0, 0.0)), entity=name) for name in names]


def test_what_is_seen_is_shown_listed_and_forgotten(asked, things):
    told = asked(Learn(class_="Cup", entity="thing1"))
    assert (told.number, told.class_, told.views, told.shown) == (1, "Cup", 1, "entity thing1")
    assert asked(Learned()) == (told,)
    assert ExemplarStore(asked.path, shipped()).exemplars == (told,)
    (lesson,) = asked.learnt[-1].exemplars.exemplars
    assert lesson.views[0] == pytest.approx(exemplar_view_of(things[0], shipped()).features, rel=1e-6)
    (again,) = [
        thing
        for thing in observe_clouds(shot().clouds[:1], asked.learnt[-1]).observations.observations
        if thing.class_ == "Cup"
    ]
    assert again.size_m[2] == pytest.approx(told.size_m[2], abs=0.02)
    assert asked(Forget(number=1)) == told
    assert asked(Learned()) == ()
    assert [learnt.exemplars is None for learnt in asked.learnt] == [True, False, True]


def test_views_from_elsewhere_are_shown(asked, things):
    view = replace(exemplar_view_of(things[0], shipped()), image=np.full(FEATURES, 0.25))
    told = asked(Learn(class_="Gizmo", views=(view_message(view), view_message(view)), shown="2 frames"))
    assert (told.class_, told.views, told.shown) == ("Gizmo", 2, "2 frames")
    assert told.size_m == pytest.approx(view.size_m)
    assert (asked.learnt[-1].exemplars.exemplars[0].images == 0.25).all()


def test_a_class_that_perception_never_learnt_has_what_the_map_has_above_it(asked, things):
    asked(Learn(class_="Gizmo", views=(view_message(exemplar_view_of(things[0], shipped())),)))
    assert asked.learnt[-1].exemplars.exemplars[0].ancestors == ()
    asked(Learn(class_="Cup", entity="thing1"))
    assert asked.learnt[-1].exemplars.exemplars[1].ancestors == shipped().ancestors["Cup"]


def test_the_ancestors_of_a_class_of_the_map_alone_are_the_most_specific_first(asked, things):
    tree = {"Gizmo": {"Tool", "Device", "Object"}, "Device": {"Tool", "Object"}, "Tool": {"Object"}}
    asked.hierarchy = ClassHierarchy({name: frozenset(above) for name, above in tree.items()})
    asked(Learn(class_="Gizmo", views=(view_message(exemplar_view_of(things[0], shipped())),)))
    assert asked.learnt[-1].exemplars.exemplars[0].ancestors == ("Device", "Tool", "Object")


def test_an_entity_that_an_image_edge_cuts_is_not_learned(asked, things):
    cut = replace(things[0], segments=tuple(replace(s, cut=True) for s in things[0].segments))
    asked.commands.see(frame([cut]), named("thing1"))
    with pytest.raises(errors.Refused, match="only a part of thing1 is in view"):
        asked(Learn(class_="Cup", entity="thing1"))


def test_what_was_seen_seconds_ago_is_not_visible_any_more(asked, things, monkeypatch):
    start_s = time.monotonic()

    def wait_until(passed_s):
        clock = SimpleNamespace(monotonic=lambda: start_s + passed_s)
        monkeypatch.setattr(exemplar_commands, "time", clock)

    wait_until(2.0)
    asked.commands.see(frame(things[1:2]), named("thing2"))
    assert asked(Learn(class_="Cup", entity="thing1")).shown == "entity thing1"
    wait_until(4.0)
    with pytest.raises(errors.Refused, match="thing1 is not visible to perception; visible are: thing2"):
        asked(Learn(class_="Cup", entity="thing1"))
    wait_until(6.0)
    with pytest.raises(errors.Refused, match="thing1 is not visible to perception; no entity of the map is"):
        asked(Learn(class_="Cup", entity="thing1"))


def test_a_given_description_replaces_the_one_of_the_source(asked):
    assert asked(Learn(class_="Cup", entity="thing1", shown="the red one")).shown == "the red one"


def test_features_that_are_not_numbers_are_invalid(asked):
    with pytest.raises(errors.BadRequest, match="must be 32-bit floats"):
        asked(Learn(class_="Cup", views=(ShownView(features=b"12345", size_m=(1.0, 1.0, 1.0)),)))


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (Learn(class_="Cup", entity="cup9"), errors.Refused, "cup9 is not visible .* visible are: thing1"),
        (Forget(number=4), errors.Refused, "no exemplar with number 4; none is stored"),
        (Learn(class_="Object", entity="thing1"), errors.BadRequest, "name a more specific class"),
        (
            Learn(class_="Cup", views=(view_message(ExemplarView(np.zeros(5), (1.0, 1.0, 1.0))),)),
            errors.BadRequest,
            f"a view must have {WIDTH} features",
        ),
    ],
)
def test_what_cannot_be_is_refused(asked, call, error, said):
    with pytest.raises(error, match=said):
        asked(call)
    assert asked(Learned()) == ()
    assert not asked.path.exists()
