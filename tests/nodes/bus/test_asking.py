"""Asking, between real sessions on loopback."""

from __future__ import annotations

import queue
import threading

import pytest

from nodes import bus
from schemas import commands, errors, replies
from tests.nodes.bus.conftest import PREFIX, answer


def test_a_question_is_answered(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: replies.Done(text=request.read(commands.Get).name)))
    reply = bus.ask(client, PREFIX, "get", commands.Get(name="chair1"), replies.Done)
    assert reply == replies.Done(text="chair1")


def test_an_error_reply_is_raised_with_its_code(pair):
    server, client = pair

    def refuse(request):
        raise errors.NameTaken("the name 'x' is taken")

    bus.serve(server, PREFIX, answer(refuse))
    with pytest.raises(errors.NameTaken, match="taken"):
        bus.ask(client, PREFIX, "add", commands.Get(name="x"), replies.Done)


def test_nobody_is_no_answer(pair):
    _, client = pair
    with pytest.raises(errors.NoAnswer, match="nobody serves it"):
        bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, patience_s=0.2)


def test_one_who_does_not_answer_in_time_is_no_answer(pair):
    server, client = pair
    kept = []
    bus.serve(server, PREFIX, kept.append)
    with pytest.raises(errors.NoAnswer, match=r"within 0\.2 s"):
        bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, timeout_s=0.2)


def test_patience_lasts_until_somebody_serves(pair):
    server, client = pair
    serve = threading.Timer(
        0.4, lambda: bus.serve(server, PREFIX, answer(lambda _: replies.Done(text="here")))
    )
    serve.start()
    assert bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done).text == "here"
    serve.join()


def test_ask_later_answers_once_also_when_nobody_is_there(pair):
    _, client = pair
    answers: queue.SimpleQueue = queue.SimpleQueue()
    bus.ask_later(client, PREFIX, "get", commands.Get(name="x"), replies.Done, answers.put)
    read = answers.get(timeout=5)
    with pytest.raises(errors.NoAnswer, match="nobody serves it"):
        read()
    assert answers.empty()
