"""A watcher whose system goes down and comes back, with the same map and with another."""

import contextlib

from semmap.nodes import bus
from semmap.nodes.extern import availability
from semmap.nodes.extern.client import connect
from semmap.schemas import keys, replies
from tests.conftest import free_endpoint, until


@contextlib.contextmanager
def system_at(endpoint, began_ns, asked):
    """A coordinator and a knowledge base whose map began then; what it was `asked`."""
    answers = {
        "status": replies.SystemStatus(
            commit=7, entities=3, bodies=0, truth="map", in_agreement=True, nodes=()
        ),
        "history": (
            replies.LoggedCommit(
                seq=1, stamp_ns=began_ns, source="file", agent="", verb="", reason="begun from a.ttl",
                confidence=None, undoes=(), tbox=False, inserted=1, retracted=0, changed=(), removed=(),
            ),
        ),
    }  # fmt: skip
    with bus.open_session(bus.Network(mode="peer", connect=(), listen=(endpoint,))) as session:

        def answer(request):
            request.reply(answers[request.verb])
            asked.append(request.verb)

        bus.serve(session, keys.CMD, answer)
        token = session.liveliness().declare_token(keys.live_key("kb_node", str(began_ns)))
        yield
        token.undeclare()


def test_a_watcher_learns_that_the_system_goes_and_which_map_comes():
    endpoint, said, asked = free_endpoint(), [], []
    with contextlib.ExitStack() as watching:
        with system_at(endpoint, 1, asked):
            client = watching.enter_context(connect(endpoint))
            watching.enter_context(availability.report_availability(client, said.append))
            until(lambda: asked == ["history"], "the first commit of the map is requested")
        until(lambda: said == [availability.WENT_DOWN], "it is reported that the system is down")
        with system_at(endpoint, 1, asked):
            until(lambda: said[1:] == [availability.CAME_BACK], "it is reported that the system is back")
        with system_at(endpoint, 2, asked):
            until(lambda: len(said) == 4, "another map is reported")
    another = "the endpoint now serves another map (begun from a.ttl; 3 entities, commit 7); "
    assert said[2:4] == [availability.WENT_DOWN, f"{another}further output is about it"]
