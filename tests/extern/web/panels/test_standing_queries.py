import asyncio
import threading

from semmap.nodes.extern.web.panels.standing_queries import QuerySubscription
from semmap.schemas import errors
from semmap.schemas.sparql import RowsChanged


class Query:
    """A stub of a standing query with these changes, and then an error or none until it is closed."""

    def __init__(self, *news, error=None):
        self._news = news
        self._error = error
        self.ended = threading.Event()

    def changes(self):
        yield from self._news
        if self._error is not None:
            raise self._error
        self.ended.wait(10.0)


def told_by(query, count):
    async def follow():
        told = asyncio.Queue()
        following = QuerySubscription(query, query.ended.set, told.put_nowait)
        found = [await asyncio.wait_for(told.get(), 10.0) for _ in range(count)]
        following.close()
        following.close()
        return found

    return asyncio.run(follow())


def test_changes_arrive_in_order_on_the_event_loop():
    news = [RowsChanged(watch="q", seq=seq, since=seq - 1) for seq in (2, 3)]
    query = Query(*news)
    assert told_by(query, 2) == news
    assert query.ended.wait(10.0)


def test_the_error_that_ends_a_query_is_delivered():
    assert told_by(Query(error=errors.Refused("too many rows")), 1) == ["too many rows"]


def test_a_closed_subscription_delivers_nothing():
    async def follow():
        told = []
        following = QuerySubscription(Query(), lambda: None, told.append)
        following.close()
        following._deliver("late")
        await asyncio.sleep(0.05)
        return told

    assert asyncio.run(follow()) == []
