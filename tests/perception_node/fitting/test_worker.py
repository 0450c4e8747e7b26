"""The worker thread that fits models."""

from __future__ import annotations

import threading

from semmap.nodes.perception_node.fitting.worker import FitWorker, Request
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.schemas.perception import Observations
from tests.conftest import until
from tests.perception_node.things import at, seen

LOOK = FrameResult(Observations(stamp_ns=0, views=(), observations=()), ())


def request(name):
    return Request(name, at(0, 0), seen("Cup", at(0, 0)), 1, (), LOOK)


def test_one_thing_is_fitted_at_a_time_and_the_others_are_asked_for_again():
    go, answers = threading.Event(), []

    def fit(asked):
        go.wait(10)
        return

    worker = FitWorker(fit, lambda asked, found: answers.append((asked.name, found)), lambda text: None)
    worker.ask(request("cup1"))
    assert worker.busy
    worker.ask(request("cup2"))
    go.set()
    until(lambda: not worker.busy, "it is done")
    worker.ask(request("cup3"))
    until(lambda: len(answers) == 2, "the next is done")
    worker.close()
    assert answers == [("cup1", None), ("cup3", None)]


def test_what_fails_is_told_and_the_thread_goes_on():
    complaints, answers = [], []

    def fit(asked):
        raise ZeroDivisionError("flat")

    worker = FitWorker(fit, lambda asked, found: answers.append(found), complaints.append)
    worker.ask(request("cup1"))
    until(lambda: not worker.busy, "it is done")
    worker.ask(request("cup2"))
    until(lambda: len(answers) == 2, "the next is done")
    worker.close()
    assert complaints == ["fitting a model failed: ZeroDivisionError: flat"] * 2
    assert answers == [None, None]
