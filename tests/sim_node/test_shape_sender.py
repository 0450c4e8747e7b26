"""The shapes of a world's bodies go to every process of the knowledge base."""

from concurrent.futures import Future

import pytest
from msgspec import json, structs

from semmap.nodes.sim_node.shape_sender import ShapeSender
from semmap.ontology.model_shapes import ModelShape, WorldShapes
from semmap.schemas import errors
from semmap.schemas.health import Health
from semmap.schemas.replies import Done

CUP = ModelShape(size_m=(0.1, 0.1, 0.1))
READY = Health(node="kb_node", host="robot", pid=1, started_ns=1, stamp_ns=2, state="ready")


class Sent:
    """What was sent and reported."""

    def __init__(self):
        self.messages, self.replies, self.reports = [], [], []
        self.sender = ShapeSender({"cup1": CUP}, self.send, self.reports.append)

    def send(self, message):
        self.messages.append(message)
        self.replies.append(Future())
        return self.replies[-1]


@pytest.fixture
def sent():
    return Sent()


def test_shapes_are_sent_at_the_start_and_once_to_each_process_that_follows(sent):
    (message,) = sent.messages
    assert json.decode(message.content, type=WorldShapes) == WorldShapes.of({"cup1": CUP})
    sent.sender.on_health(READY)
    sent.sender.on_health(structs.replace(READY, stamp_ns=3))
    assert len(sent.messages) == 1
    again = structs.replace(READY, started_ns=4)
    sent.sender.on_health(structs.replace(again, state="starting"))
    sent.sender.on_health(structs.replace(again, node="recorder"))
    assert len(sent.messages) == 1
    sent.sender.on_health(again)
    sent.sender.on_health(again)
    assert sent.messages == [message, message]
    sent.sender.on_health(structs.replace(again, host="other"))
    assert len(sent.messages) == 3


def test_an_error_is_reported(sent):
    sent.replies[0].set_result(Done(text="shapes of 1 body"))
    sent.sender.on_health(READY)
    sent.sender.on_health(structs.replace(READY, started_ns=4))
    sent.replies[1].set_exception(errors.Refused("the disk is full"))
    assert sent.reports == ["relations do not use the shapes of the world's bodies: the disk is full"]
