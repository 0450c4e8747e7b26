"""The knowledge cache, with a stub of the system."""

import asyncio

import pytest

from semmap.nodes.extern.web import knowledge_cache
from semmap.nodes.extern.web.knowledge_cache import KnowledgeCache
from semmap.nodes.extern.web.live import LiveEvent
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Properties
from semmap.schemas.commits import Extent
from semmap.schemas.sparql import SparqlResult
from tests.extern.web.scene.sample_scenes import body, pose, scene
from tests.extern.web.views.sample_maps import commit, fact, thing

CUP = thing("cup1")


class Live:
    """A stub that replies when `may_answer` is set."""

    classes = ()
    scene = None

    def __init__(self, seq, *facts):
        self.commit = seq
        self.may_answer = asyncio.Event()
        self.fails = 0
        self._answer = SparqlResult(kind="select", rows=facts, seq=seq)
        self._told = None

    def listen(self, told):
        self._told = told

    def happen(self, kind, *commits):
        self._told(LiveEvent(kind=kind, commits=commits))

    async def ask(self, command, timeout_s=10.0):
        await self.may_answer.wait()
        if isinstance(command, Properties):
            return ()
        if self.fails:
            self.fails -= 1
            raise errors.NoAnswer("no response")
        return self._answer


async def settled():
    for _ in range(10):
        await asyncio.sleep(0)


def test_commits_during_a_read_are_applied_after_it():
    async def scenario():
        live = Live(5, fact("cup1", "isOn", "table1"))
        known = KnowledgeCache(live)
        await settled()
        live.happen("commit", commit(5, came=[fact("cup1", "isOn", "old1")]))
        moved = commit(6, came=[fact("cup1", "isOn", "desk1")], went=[fact("cup1", "isOn", "table1")])
        live.happen("commit", moved)
        live.may_answer.set()
        await settled()
        assert known.locations.find_support(CUP) == "desk1"

    asyncio.run(scenario())


def test_listeners_receive_the_names_of_changed_entities():
    async def scenario():
        live = Live(5)
        live.may_answer.set()
        known = KnowledgeCache(live)
        told = []
        stop = known.listen(told.append)
        await settled()
        assert told == [None]
        live.happen("commit", commit(6, came=[fact("cup1", "isOn", "desk1")], changed=(thing("lamp1"),)))
        assert told[1:] == [frozenset({"cup1", "lamp1"})]
        live.happen("commit", commit(7, tbox=True))
        assert told[-1] is None
        stop()
        live.happen("commit", commit(8))
        await settled()
        assert len(told) == 3

    asyncio.run(scenario())


@pytest.mark.parametrize("fails", [1, 2])
def test_failed_reads_are_repeated(monkeypatch, fails):
    monkeypatch.setattr(knowledge_cache, "_AGAIN_S", 0.0)

    async def scenario():
        live = Live(5, fact("cup1", "isOn", "table1"))
        live.fails = fails
        live.may_answer.set()
        known = KnowledgeCache(live)
        for _ in range(5):
            await settled()
        assert known.locations.find_support(CUP) == "table1"

    asyncio.run(scenario())


def test_a_reset_during_a_read_causes_another_read():
    async def scenario():
        live = Live(5)
        KnowledgeCache(live)
        await settled()
        live._answer = SparqlResult(kind="select", rows=(fact("cup1", "isOn", "new1"),), seq=1)
        live.happen("reset")
        live.may_answer.set()
        known = KnowledgeCache(live)
        await settled()
        assert known.locations.find_support(CUP) == "new1"

    asyncio.run(scenario())


def test_a_scene_change_reports_changed_bodies_only():
    async def scenario():
        live = Live(5)
        live.may_answer.set()
        known = KnowledgeCache(live)
        await settled()
        told = []
        known.listen(told.append)
        live.scene = scene(body("chair1"), body("cup1"))
        live.happen("scene")
        live.scene = scene(body("chair1", pose(2.0)), body("cup1", ghost=True), body("cup2"))
        live.happen("scene")
        live.happen("scene")
        live.scene = None
        live.happen("scene")
        assert told == [None, frozenset(("cup1", "cup2")), None]

    asyncio.run(scenario())


AXIOM = (v.dm("Cup"), v.RDFS_SUB_CLASS_OF, v.dm("Vessel"))


@pytest.mark.parametrize(
    ("kind", "fields", "changes"),
    [
        ("commit", {}, False),
        ("commit", {"inserted": (fact("cup1", "isOn", "desk1"),)}, False),
        ("commit", {"inserted": (AXIOM,)}, True),
        ("commit", {"retracted": (AXIOM,)}, True),
        ("commit", {"tbox": True}, True),
        ("commit", {"abridged": Extent(inserted=1, retracted=0, changed=0, removed=0)}, True),
        ("reset", {}, True),
    ],
)
def test_the_version_of_the_ontology_follows_its_axioms(kind, fields, changes):
    async def scenario():
        live = Live(5)
        live.may_answer.set()
        known = KnowledgeCache(live)
        versions = []
        known.listen(lambda _: versions.append(known.ontology_version))
        before = known.ontology_version
        live.happen(kind, *([commit(6, **fields)] if kind == "commit" else []))
        assert (versions[0] != before) is changes  # listeners already have the new one

    asyncio.run(scenario())
