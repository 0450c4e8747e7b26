"""The store on disk of a large map: created in the background, kept, cloned and updated."""

import gzip
import queue
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pyoxigraph as ox
import pytest

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.sparql.triples import large_map
from semmap.nodes.kb_node.sparql.triples.dataset import Delta, DiskDataset, as_stored
from semmap.nodes.kb_node.sparql.triples.disk_stores import FOLDER, clone_path, clone_store
from semmap.nodes.kb_node.sparql.triples.large_map import LargeMap
from semmap.nodes.kb_node.storage import seed
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Sparql, Watch
from tests.conftest import until
from tests.kb_node.home import chair, new_map, transaction

WAIT_S = 60.0
COUNT = "SELECT (COUNT(?c) AS ?n) { ?c a dm:Chair }"


class Node:
    """A map with its SPARQL service; the test's thread acts as the node's."""

    def __init__(self, semantic_map, large=40):
        self.map = semantic_map
        self.events = queue.SimpleQueue()
        self.news = queue.SimpleQueue()
        self.made = 0
        journal = semantic_map._journal
        large_map = LargeMap(journal, lambda: self.map.reasoner, self.events.put, large=large)
        fill = large_map.fill

        def counted(*arguments):
            self.made += 1
            return fill(*arguments)

        large_map.fill = counted
        self.large_map = large_map
        self.service = SparqlService(lambda: self.map.reasoner.asserted(), self.news.put, large_map)
        self.map.prepare = self.service.prepare

    def commit(self, number, insert=(), retract=()):
        commit = self.map.commit(transaction(number, insert, retract))
        self.service.follow(commit)
        return commit

    def until(self, future):
        """Return the result of a future, and run the node's tasks in the meantime."""
        while not future.done():
            try:
                self.events.get(timeout=0.05)()
            except queue.Empty:
                continue
        return future.result()

    def ask(self, query, **fields):
        return self.until(self.service.ask(Sparql(query=query, **fields), self.map.seq))

    def count(self):
        ((found,),) = self.ask(COUNT).rows
        return int(v.lexical(found))

    def close(self):
        self.service.close()
        self.map._journal.close()


@pytest.fixture
def node(tmp_path):
    node = Node(new_map(tmp_path))
    for i in range(3):
        node.map.commit(transaction(i, chair(f"chair{i}")))
    yield node
    node.close()


def stores(node):
    folder = node.map._journal.path.parent / FOLDER
    return [path for path in folder.iterdir() if path.name[0].isdigit()] if folder.exists() else []


def test_a_large_map_is_queried_on_disk_and_kept_up_to_date(node):
    assert node.count() == 3
    assert (node.made, len(stores(node))) == (1, 1)
    node.commit("more", chair("more"))
    assert node.count() == 4
    node.commit("gone", retract=chair("chair0"))
    assert node.count() == 3


def test_a_small_map_is_in_memory(tmp_path):
    node = Node(new_map(tmp_path), large=10_000)
    try:
        node.commit(1, chair("chair1"))
        assert node.count() == 1
        assert (node.made, stores(node)) == (0, [])
    finally:
        node.close()


def test_the_store_survives_a_restart_and_catches_up(node, tmp_path):
    assert node.count() == 3
    node.commit("more", chair("more"))
    node.close()
    again = Node(SemanticMap(Journal(tmp_path / "journal.sqlite")))
    try:
        again.commit("later", chair("later"))
        assert again.count() == 5
        assert again.made == 0
    finally:
        again.close()


def test_another_journal_has_another_store(node, tmp_path):
    assert node.count() == 3
    node.close()
    seed.archive_journal(tmp_path)
    assert not (tmp_path / FOLDER).exists()
    (tmp_path / FOLDER).mkdir()
    (tmp_path / FOLDER / f"1-{'00' * 16}").mkdir()  # as if the same number were another commit
    again = Node(new_map(tmp_path))
    try:
        again.commit(1, chair("chair1"))
        assert again.count() == 1
    finally:
        again.close()


def test_commits_during_the_creation_are_in_the_store(node):
    answer = node.service.ask(Sparql(query=COUNT), node.map.seq)
    assert not answer.done()
    node.commit("more", chair("more"))
    node.commit("gone", retract=chair("chair1"))
    node.until(answer)
    assert {row[0] for row in node.ask("SELECT ?c { ?c a dm:Chair }").rows} == {
        v.entity_iri(name) for name in ("chair0", "chair2", "more")
    }


def test_no_answer_mixes_two_commits(node):
    """The store may contain parts of a later commit; earlier queries are answered as of that commit."""
    answer = node.service.ask(
        Sparql(query="SELECT ?c ?p { ?c a dm:Chair ; dm:hasPosition ?p }"), node.map.seq
    )
    node.commit("more", chair("more"))
    result = node.until(answer)
    assert (result.seq, len(result.rows)) == (node.map.seq, 4)


def test_the_store_is_created_after_a_large_commit(tmp_path):
    node = Node(new_map(tmp_path), large=50)
    try:
        node.commit("many", [t for i in range(30) for t in chair(f"chair{i}")])
        assert node.made == 1
        assert node.count() == 30
        assert node.made == 1
    finally:
        node.close()


def chairs(count):
    return [t for i in range(count) for t in chair(f"chair{i}")]


def test_the_store_is_begun_with_the_commit(tmp_path, monkeypatch):
    node = Node(new_map(tmp_path), large=50)
    node.map.commit(transaction("one", chair("one")))
    try:
        monkeypatch.setattr(large_map, "_FRAME", 7)
        monkeypatch.setattr(node.map.reasoner, "by_subject", None)  # nothing is read again
        node.commit("many", chairs(30))
        node.commit("two", chair("two"))
        assert (node.count(), node.made, len(stores(node))) == (32, 1, 1)
    finally:
        node.close()


@pytest.mark.parametrize(
    "kind", ["it contradicts itself", "the disk does not take it", "it is one of several"]
)
def test_the_store_of_an_aborted_commit_is_deleted(tmp_path, monkeypatch, kind):
    node = Node(new_map(tmp_path), large=50)
    try:
        wrong = [(v.entity_iri("chair3"), v.RDF_TYPE, v.dm("Kitchen"))] if "contradicts" in kind else []
        with monkeypatch.context() as patched:
            if not wrong:
                patched.setattr(Journal, "append", refuse)
            if "several" in kind:
                assert all(map(is_refusal, node.map.commit_together([transaction("a", chairs(30))])))
            else:
                with pytest.raises(errors.Refused):
                    node.commit("a", [*chairs(30), *wrong])
        folder = node.map._journal.path.parent / FOLDER
        until(lambda: not list(folder.iterdir()), "nothing is left")
        node.commit("b", chairs(29))
        assert (node.count(), len(stores(node))) == (29, 1)
    finally:
        node.close()


def test_a_store_prepared_for_an_undone_commit_is_not_used_for_another(tmp_path):
    node = Node(new_map(tmp_path), large=50)
    try:
        node.map.commit(transaction("a", chairs(30)))  # and it is not reported again
        node.map.commit(transaction("b", retract=chairs(20)))
        node.commit("c", [t for i in range(30) for t in chair(f"stool{i}")])
        assert node.count() == 40
    finally:
        node.close()


def turtle(triples):
    return "".join(f"{s} {p} {o} .\n" for s, p, o in triples).encode()


@pytest.mark.parametrize("is_packed", [False, True])
def test_the_store_is_filled_from_a_document_while_it_is_read(tmp_path, monkeypatch, is_packed):
    node = Node(new_map(tmp_path), large=50)
    node.map.commit(transaction("one", chair("one")))
    try:
        said = [*chairs(30), *chairs(2), *chair("one")]  # some of it twice, and some that exists already
        packed = gzip.compress(turtle(said)) if is_packed else b""
        node.service.prefetch("many", turtle(said), v.ABOX, packed=packed)
        monkeypatch.setattr(node.map.reasoner, "by_subject", None)  # nothing is read again
        monkeypatch.setattr(large_map, "_frames", None)
        node.commit("many", said)
        node.commit("two", chair("two"))
        assert (node.count(), node.made, len(stores(node))) == (32, 1, 1)
    finally:
        node.close()


@pytest.mark.parametrize("why", ["another commit", "something else in it", "no commit", "it retracts, too"])
def test_a_document_without_a_commit_leaves_no_store(tmp_path, why):
    node = Node(new_map(tmp_path), large=50)
    node.map.commit(transaction("one", chair("one")))
    try:
        node.service.prefetch("many", turtle(chairs(30)), v.ABOX)
        if why in ("no commit", "something else in it"):
            node.service.discard_prepared()
        if why != "no commit":
            gone = chair("one") if "too" in why else ()
            node.commit("other" if "another" in why else "many", chairs(29), gone)
        left = {"no commit": 1, "it retracts, too": 29}.get(why, 30)
        assert (node.count(), len(stores(node))) == (left, left > 1)
        until(lambda: not list((tmp_path / FOLDER).glob("filling-*")), "nothing else is left")
    finally:
        node.close()


@pytest.mark.parametrize(
    "text", ["_:a :p _:b .", ":a :p [] .", ":a :p (1) .", "\ufeff:a :p 1 .", ":a :p 1 ."]
)
def test_a_document_with_unusual_content_or_a_short_one_is_not_prefetched(tmp_path, text):
    node = Node(new_map(tmp_path), large=50)
    try:
        content = text.encode() + b"#" * (3000 if text != ":a :p 1 ." else 100)
        node.service.prefetch("many", content, v.ABOX)
        assert not (tmp_path / FOLDER).exists()
    finally:
        node.close()


def refuse(*_, **__):
    raise NotWritten("the disk is full")


def is_refusal(result):
    return isinstance(result, errors.Refused)


def test_a_large_commit_over_a_store_in_memory(tmp_path):
    node = Node(new_map(tmp_path), large=100)
    try:
        node.commit("one", chair("one"))
        assert node.count() == 1
        assert node.made == 0
        node.commit("many", [t for i in range(30) for t in chair(f"chair{i}")])
        node.commit("two", chair("two"))
        assert node.count() == 32
        assert node.made == 1
    finally:
        node.close()


def test_literals_that_differ_only_in_spelling_are_kept_in_memory(node):
    chair1 = v.entity_iri("chair1")
    spelled = [(chair1, v.dm("weight"), f'"{one}"^^{v.XSD_FLOAT}') for one in ("1.0", "1.00")]
    node.commit("spelled", spelled)
    weight = f"ASK {{ <{v.bare(chair1)}> dm:weight ?w }}"
    assert node.ask(weight).verdict
    assert stores(node) == []
    node.commit("less", retract=spelled[:1])
    assert node.ask(weight).verdict


def test_inferences_are_kept_in_memory(node):
    assert node.count() == 3
    ((found,),) = node.ask("SELECT (COUNT(?c) AS ?n) { ?c a dm:Seat }", inferred=True).rows
    assert v.lexical(found) == "3"
    node.commit("more", chair("more"))
    assert node.count() == 4


def test_a_standing_query_over_a_store_on_disk(node):
    node.until(node.service.ask(Watch(query="SELECT ?c { ?c a dm:Chair }", watch="w"), node.map.seq))
    node.commit("more", chair("more"))
    news = node.news.get(timeout=WAIT_S)
    assert [row[0] for row in news.rows.appeared] == [v.entity_iri("more")]


def test_a_query_that_takes_too_long_is_cancelled_and_its_clone_deleted(node, tmp_path):
    node.commit("many", [t for i in range(300) for t in chair(f"seat{i}")])
    with pytest.raises(errors.Refused, match="time limit"):
        node.ask("SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(?a < ?i) }", timeout=0.5)
    assert node.count() == 303


def test_a_long_log_is_merged_into_the_store(node):
    assert node.count() == 3
    (path,) = stores(node)
    seq = node.map.seq
    commit = node.commit("more", chair("more"))
    delta = Delta(seq=commit.seq, inserted=commit.inserted)
    # as in the SPARQL process: one that has itself opened a store on disk must not fork
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        merged = pool.submit(_read_after_merging, path, seq, delta).result(WAIT_S)
    assert merged == [(s, p, as_stored(o)) for s, p, o in sorted(commit.inserted)]


def _read_after_merging(path, seq, delta):
    """Merge a commit into a store of `seq`, and return what the store then has about its subjects."""
    kept = DiskDataset(path, seq, seq)
    kept.apply(delta)
    kept.merge_log([delta])
    opened = kept.open_in_reader()
    assert opened.seq == delta.seq
    subjects = {s for s, _, _ in delta.inserted}
    found = [(str(q.subject), str(q.predicate), str(q.object)) for q in opened.store]
    return sorted(triple for triple in found if triple[0] in subjects)


def test_a_clone_does_not_change_the_store(tmp_path):
    path = tmp_path / FOLDER / "1-00"
    path.parent.mkdir()
    store = ox.Store(str(path))
    quad = ox.Quad(ox.NamedNode("x:a"), ox.NamedNode("x:b"), ox.NamedNode("x:c"))
    store.bulk_extend([quad])
    store.flush()
    del store
    clone = clone_store(path)
    clone.remove(quad)
    assert len(clone) == 0
    assert len(ox.Store(str(path))) == 1
    assert clone_path(path, 1).parent == path.parent
