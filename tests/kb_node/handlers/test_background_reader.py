"""Files are read beside the node, a limited number at a time."""

from __future__ import annotations

import threading

import pytest

from semmap.nodes.kb_node.handlers import background_reader
from semmap.nodes.kb_node.handlers.background_reader import BackgroundReader
from semmap.schemas import errors


class Reading:
    """A reader whose finished work is used when the test says so, as on the thread of a node."""

    def __init__(self):
        self.ready = []
        self.arrived = threading.Semaphore(0)
        self.reader = BackgroundReader(self.run_soon)

    def run_soon(self, function):
        self.ready.append(function)
        self.arrived.release()

    def use_next(self):
        assert self.arrived.acquire(timeout=60)
        self.ready.pop(0)()


@pytest.fixture
def reading():
    made = Reading()
    yield made
    made.reader.close()


def test_the_result_is_used_on_the_thread_of_the_map(reading):
    here = threading.get_ident()
    future = reading.reader.run(threading.get_ident, lambda there: (there, threading.get_ident()))
    reading.use_next()
    there, used = future.result(0)
    assert (used, there != here) == (here, True)


def test_an_error_of_the_work_or_of_its_use_is_that_of_the_future(reading):
    def fail(*_):
        raise errors.BadFile("not RDF")

    for future in (reading.reader.run(fail, str), reading.reader.run(str, fail)):
        reading.use_next()
        with pytest.raises(errors.BadFile, match="not RDF"):
            future.result(0)


def test_further_files_are_rejected_until_one_is_done(reading, monkeypatch):
    monkeypatch.setattr(background_reader, "_MOST_READ", 2)
    futures = [reading.reader.run(lambda n=n: n, lambda n: n) for n in range(2)]
    with pytest.raises(errors.Busy, match="2 files are being read") as caught:
        reading.reader.run(str, str)
    assert caught.value.again_s == 5.0
    reading.use_next()
    futures.append(reading.reader.run(lambda: 2, lambda n: n))
    reading.use_next()
    reading.use_next()
    assert [future.result(0) for future in futures] == [0, 1, 2]
