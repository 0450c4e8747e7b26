"""A standing query whose system is replaced by one with another map."""

from semmap.nodes import bus
from semmap.nodes.extern import sparql_client
from semmap.nodes.extern.client import connect
from semmap.schemas import errors, keys
from semmap.schemas.sparql import Watching
from tests.conftest import free_endpoint


def test_the_rows_of_another_map_are_reported_though_its_numbers_are_lower(monkeypatch):
    monkeypatch.setattr(sparql_client, "_RENEW_S", 0.1)
    maps = [(168, (("<a>",), ("<b>",))), (2, (("<b>",), ("<c>",)))]
    endpoint = free_endpoint()

    def answer(request):
        if request.verb == "renew":
            request.refuse(errors.UnknownName("no such standing query"))
        else:
            seq, rows = maps.pop(0)
            request.reply(Watching(watch="w", seq=seq, variables=("s",), rows=rows, lease_s=30.0))

    network = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    with bus.open_session(network) as session, connect(endpoint) as client:
        bus.serve(session, keys.CMD, answer)
        with client.watch("SELECT ?s {?s ?p ?o}") as standing:
            news = next(standing.changes(timeout=10.0))
    assert (news.seq, news.appeared, news.disappeared) == (2, (("<c>",),), (("<a>",),))
