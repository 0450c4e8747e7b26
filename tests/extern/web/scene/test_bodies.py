"""Bodies: only changes are sent."""

import pytest

from semmap.nodes.extern.web.scene.bodies import Bodies
from semmap.nodes.extern.web.scene.drawables import Drawable
from tests.extern.web.scene.sample_scenes import pose


class Handle:
    """A mesh that records what is sent to it."""

    def __init__(self, sent: list[str]) -> None:
        object.__setattr__(self, "_sent", sent)

    def __setattr__(self, name: str, value: object) -> None:
        self._sent.append(name)

    def remove(self) -> None:
        self._sent.append("removed")


class Scene:
    def __init__(self) -> None:
        self.sent: list[str] = []

    def add_batched_glb(self, *_: object, **__: object) -> Handle:
        self.sent.append("added")
        return Handle(self.sent)

    def take(self) -> list[str]:
        sent, self.sent[:] = self.sent[:], []
        return sent


MOVED = ["batched_positions", "batched_wxyzs"]


def thing(model: str, x: float) -> Drawable:
    return Drawable("solid", model, (0.5, 0.5, 1.0), (10, 20, 30), pose(x))


@pytest.fixture
def scene():
    return Scene()


@pytest.fixture
def bodies(scene):
    bodies = Bodies(scene, lambda key: b"")  # type: ignore[arg-type]
    bodies.show({"chair1": thing("chair", 0.0), "chair2": thing("chair", 1.0), "cup1": thing("cup", 2.0)})
    assert scene.take() == ["added", "added"]
    return bodies


def test_unchanged_bodies_are_not_sent_again(scene, bodies):
    things = {"chair1": thing("chair", 0.0), "chair2": thing("chair", 1.0), "cup1": thing("cup", 2.0)}
    bodies.show(things)
    bodies.show(things)
    assert scene.take() == []


def test_the_batch_of_a_moved_body_is_sent(scene, bodies):
    things = {"chair1": thing("chair", 0.0), "chair2": thing("chair", 1.5), "cup1": thing("cup", 2.0)}
    bodies.show(things)
    assert scene.take() == MOVED


def test_moved_bodies_return_when_shown_at_the_old_pose(scene, bodies):
    things = {"chair1": thing("chair", 0.0), "chair2": thing("chair", 1.0), "cup1": thing("cup", 2.0)}
    bodies.show(things)
    bodies.move({"cup1": pose(5.0)})
    assert scene.take() == MOVED
    bodies.show(things)
    assert scene.take() == MOVED


def test_bodies_can_be_removed_and_added_again(scene, bodies):
    chairs = {"chair1": thing("chair", 0.0), "chair2": thing("chair", 1.0)}
    bodies.show(chairs)
    assert scene.take() == ["removed"]
    bodies.show({**chairs, "cup1": thing("cup", 2.0)})
    assert scene.take() == ["added"]


def test_a_new_order_is_sent(scene, bodies):
    one, other, cup = thing("chair", 0.0), thing("chair", 1.0), thing("cup", 2.0)
    bodies.show({"chair1": one, "chair2": other, "cup1": cup})
    bodies.show({"chair2": other, "chair1": one, "cup1": cup})
    assert scene.take() == MOVED
    bodies.move({"chair1": pose(9.0)})
    assert scene.take() == MOVED
