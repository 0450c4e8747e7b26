"""Exemplars are learned and removed over the network."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.perception_node.exemplar_commands import ExemplarCommands, view_message
from semmap.nodes.perception_node.exemplar_store import ExemplarStore
from semmap.nodes.perception_node.exemplar_views import ExemplarView, exemplar_view_of
from semmap.nodes.perception_node.pipeline import observe_clouds, parts_in, shipped
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.runtime.loop import Node
from semmap.schemas import errors, keys
from semmap.schemas.calls import reply_type
from semmap.schemas.commands import Forget, Learn, Learned
from tests.conftest import PATIENCE_S, free_endpoint, handling
from tests.perception_node.scenes import shot
from tests.perception_node.things import CLASSES, at, seen


@pytest.fixture(scope="module")
def sessions():
    endpoint = free_endpoint()
    here = bus.Network(connect=(), listen=(endpoint,), mode="peer")
    there = bus.Network(connect=(endpoint,), listen=("tcp/127.0.0.1:0",), mode="peer")
    with bus.open_session(here) as session, bus.open_session(there) as other:
        yield session, other


@pytest.fixture(scope="module")
def things():
    return [thing for thing in parts_in([segment_cloud(shot().clouds[0])]).things if thing.whole]


class Asked:
    """A perception node and a client."""

    def __init__(self, session, path: Path):
        self._session = session
        self.path = path
        self.learnt = []

    def __call__(self, call):
        kind = type(call)
        return bus.ask(
            self._session,
            keys.PERCEPTION,
            kind.VERB,
            call,
            reply_type(kind),
            timeout_s=PATIENCE_S,
            patience_s=PATIENCE_S,
        )


@pytest.fixture
def asked(sessions, things, tmp_path):
    session, other = sessions
    asked = Asked(session, tmp_path / "lessons.npz")
    node = Node("perception_node", other)
    teaching = ExemplarCommands(
        node, ExemplarStore(asked.path, shipped()), lambda: CLASSES, asked.learnt.append
    )
    named = [structs.replace(seen("Cup", at(0.0, 0.0)), entity=name) for name in ("thing1", "")]
    teaching.see(things[:2], named)
    with handling(node):
        yield asked


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
    view = exemplar_view_of(things[0], shipped())
    told = asked(Learn(class_="Gizmo", views=(view_message(view), view_message(view)), shown="2 frames"))
    assert (told.class_, told.views, told.shown) == ("Gizmo", 2, "2 frames")
    assert told.size_m == pytest.approx(view.size_m)


def test_a_class_that_perception_never_learnt_has_what_the_map_has_above_it(asked, things):
    asked(Learn(class_="Gizmo", views=(view_message(exemplar_view_of(things[0], shipped())),)))
    assert asked.learnt[-1].exemplars.exemplars[0].ancestors == ()
    asked(Learn(class_="Cup", entity="thing1"))
    assert asked.learnt[-1].exemplars.exemplars[1].ancestors == shipped().ancestors["Cup"]


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
