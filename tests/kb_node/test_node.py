"""The knowledge base as a separate process, reached over Zenoh on loopback."""

import gzip
import queue
import resource
import subprocess
import sys
from contextlib import contextmanager, suppress

import pytest
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.storage.seed import seed
from semmap.nodes.supervisor.settings import Settings
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import codec, errors, keys
from semmap.schemas.bridge import (
    BRIDGE,
    Entities,
    LoadDocument,
    LoadTBox,
    Recall,
    SnapshotQuery,
    StarQuery,
    TakeBack,
    Transactions,
)
from semmap.schemas.calls import reply_type
from semmap.schemas.commands import Check, Export, Get, Infer, LastSeen, Relations, Sparql
from semmap.schemas.commits import Effects, NewEntity
from semmap.schemas.entities import Entity, Pose
from semmap.schemas.relations import Described
from tests.conftest import PATIENCE_S, free_endpoint
from tests.kb_node.home import PREFIXES, TBOX_TURTLE, chair, transaction


class Bench:
    """A data folder with a map, and an endpoint at which the test listens for its knowledge base."""

    def __init__(self, folder):
        tbox = folder / "tbox.ttl"
        tbox.write_text(TBOX_TURTLE)
        self.data = folder / "data"
        seed(self.data, tbox, None)
        self.endpoint = free_endpoint()
        settings = Settings(data=str(self.data), tbox=str(tbox), abox=None, world="", listen=self.endpoint)
        self.settings = folder / "settings.json"
        self.settings.write_bytes(codec.encode_json(settings))

    def start(self):
        """Start the process of a knowledge base."""
        command = [sys.executable, "-m", "semmap.nodes.supervisor.launch", "kb_node", str(self.settings)]
        return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)

    def session(self):
        """Open the session that the knowledge base connects to."""
        return bus.open_session(bus.Network(mode="peer", listen=(self.endpoint,), connect=()))

    def client(self):
        """Open the session of another client."""
        return bus.open_session(bus.Network(connect=(self.endpoint,)))


@contextmanager
def ended(process):
    """Kill a process if it is still running."""
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Bench(tmp_path_factory.mktemp("kb"))


@pytest.fixture(scope="module")
def session(bench):
    with bench.session() as session, ended(bench.start()) as process:
        await_answer(session)
        yield session
        process.terminate()
        assert process.wait(PATIENCE_S) == 0


def ask(session, verb, message, **limits):
    return bus.ask(session, keys.BRIDGE, verb, message, reply_type(BRIDGE[verb]), **limits)


def await_answer(session):
    """Wait for a knowledge base; requests are repeated, because those to a killed process are lost."""
    for _ in range(int(PATIENCE_S)):
        with suppress(errors.NoAnswer):
            return ask(session, "snapshot", SnapshotQuery(), patience_s=1.0, timeout_s=1.0)
    return pytest.fail("no knowledge base answers")


def until(publications, count):
    """Return the next `count` publications."""
    return [publications.get(timeout=PATIENCE_S) for _ in range(count)]


def since(publications, seq, count):
    """Return the next `count` commits from `seq` on; a new subscriber may receive earlier ones, too."""
    found = []
    while len(found) < count:
        ((_, message),) = until(publications, 1)
        found += [message] if message.seq >= seq else []
    return found


def followed(session, topic):
    """Subscribe to a topic and wait until earlier commits have arrived."""
    publications = queue.Queue()
    subscriber = bus.follow(session, topic, lambda key, message: publications.put((key, message)))
    ask(session, "snapshot", SnapshotQuery())  # answered after the earlier subscription
    while not publications.empty():
        publications.get()
    return publications, subscriber


def test_a_commit_is_replied_and_published(session):
    commits, subscriber = followed(session, keys.COMMIT)
    first = ask(session, "commit", transaction("a", chair("a")))
    second = ask(session, "commit", transaction("b", chair("b")))
    assert ask(session, "commit", transaction("a", chair("x"))) == first
    assert ask(session, "commit", transaction("c", chair("b"))) is None
    third = ask(session, "commit", transaction("d", retract=chair("b")))
    assert [Effects.of(message) for message in since(commits, first.seq, 3)] == [first, second, third]
    assert third.seq == second.seq + 1 == first.seq + 2
    subscriber.undeclare()


def test_the_coordinator_is_not_notified_twice(session):
    untold, subscriber = followed(session, keys.COMMIT_EFFECTS)
    commits, other = followed(session, keys.COMMIT)
    told = ask(session, "commit", structs.replace(transaction("t1", chair("t1")), told=True))
    several = Transactions(
        transactions=(
            structs.replace(transaction("t2", chair("t2")), told=True),
            transaction("t3", chair("t3")),
        )
    )
    _, third = ask(session, "commits", several)
    document = load("t5", PREFIXES + ":t5 a dm:Chair .")
    ask(session, "load", structs.replace(document, told=True))
    fourth = ask(session, "commit", transaction("t4", chair("t4")))
    assert since(untold, told.seq, 2) == [third.commit, fourth]
    assert [message.seq for message in since(commits, told.seq, 5)] == list(range(told.seq, fourth.seq + 1))
    subscriber.undeclare()
    other.undeclare()


def test_entities_are_published_under_each_class_and_deleted_at_their_end(session):
    entities, subscriber = followed(session, keys.ENTITY)
    commit = ask(session, "commit", transaction("pub1", chair("pub")))
    seen = dict(until(entities, 4))
    assert seen.keys() == {keys.entity_key(c, "pub") for c in ("Chair", "Seat", "Object", "Physical_Thing")}
    assert list(seen.values()) == [Described.of(entity, shape="model") for entity in commit.changed] * 4
    iri = v.entity_iri("pub")
    door = transaction("pub2", [(iri, v.RDF_TYPE, v.dm("Door"))], [(iri, v.RDF_TYPE, v.dm("Chair"))])
    ask(session, "commit", door)
    seen = dict(until(entities, 5))
    assert {key for key, entity in seen.items() if entity is None} == {
        keys.entity_key(c, "pub") for c in ("Chair", "Seat")
    }
    assert seen[keys.entity_key("Door", "pub")].class_ == "Door"
    ask(session, "commit", transaction("pub3", retract=[*chair("pub"), (iri, v.RDF_TYPE, v.dm("Door"))]))
    seen = dict(until(entities, 3))
    assert seen == {keys.entity_key(c, "pub"): None for c in ("Door", "Object", "Physical_Thing")}
    subscriber.undeclare()


def test_loading_the_current_tbox_changes_nothing(session):
    def load(number, text):
        order = LoadTBox(id=f"tbox{number}", source="file", content=text.encode(), filename="tbox.ttl")
        return ask(session, "load-tbox", order)

    text = TBOX_TURTLE + "dm:Chair rdfs:subClassOf [ owl:unionOf ( dm:Seat dm:Object ) ] ."
    commit = load(1, text).commit
    assert commit.tbox
    assert load(2, text).commit is None
    assert load(1, text).commit == commit
    seq = load(4, text + "dm:Chair rdfs:comment 'to sit on' .").commit.seq
    (more,) = ask(session, "recall", Recall(seqs=(seq,)))
    assert (len(more.inserted), more.retracted) == (1, ())  # blank nodes keep their labels
    assert load(3, TBOX_TURTLE).commit.seq == commit.seq + 2


STOOL = (
    PREFIXES
    + "dm:Stool a owl:Class ; rdfs:subClassOf dm:Chair , [ a owl:Restriction ; owl:onProperty dm:near ;"
    " owl:allValuesFrom [ owl:unionOf ( dm:Chair dm:Door ) ] ] ."
)


def test_a_tbox_is_extended_once(session):
    def extend(number, text=STOOL, **how):
        fields = {"source": "file", "content": text.encode(), "filename": "stool.ttl", "extend": True}
        return ask(session, "load-tbox", LoadTBox(id=f"extend{number}", **fields, **how))

    tried = extend(0, dry_run=True).commit
    assert tried.trial is not None
    commit = extend(1).commit
    (whole,) = ask(session, "recall", Recall(seqs=(commit.seq,)))
    assert commit.tbox
    assert whole.retracted == ()
    assert (v.dm("Stool"), v.RDFS_SUB_CLASS_OF, v.dm("Chair")) in whole.inserted
    assert extend(2).commit is None  # its blank nodes are those that are there
    assert extend(1).commit == commit
    with pytest.raises(errors.BadFile, match="load a map leave out --tbox --extend"):
        extend(3, PREFIXES + ":stool1 a dm:Stool .")
    only_label = extend(4, PREFIXES + "dm:Stool rdfs:label 'taburete'@es .").commit
    undone = ask(session, "undo", TakeBack(id="e5", source="operator", commit=only_label.seq))
    assert undone.tbox
    assert ask(session, "undo", TakeBack(id="e6", source="operator", commit=commit.seq)).tbox
    assert extend(7).commit.seq == commit.seq + 4


def test_two_clients_see_one_map(bench, session):
    ask(session, "commit", transaction("two", chair("two")))
    with bench.client() as other:
        assert ask(other, "get", Get(name="two")) == ask(session, "get", Get(name="two"))
        with pytest.raises(errors.NameTaken, match="the name 'two' is taken"):
            ask(
                other,
                "commit",
                transaction("again", add=[NewEntity(name="two", class_iri=v.bare(v.dm("Chair")))]),
            )
        ask(other, "commit", transaction("gone", retract=chair("two")))
    with pytest.raises(errors.UnknownName, match="label or class 'two'"):
        ask(session, "get", Get(name="two"))


def test_questions_are_answered(session):
    ask(session, "commit", transaction("q", chair("q", preferred="queen")))
    assert [e.name for e in ask(session, "list", Entities(class_="Chair")) if e.name == "q"] == ["q"]
    (star,) = ask(session, "star", StarQuery(names=("q",)))
    assert set(star.own) == set(chair("q", preferred="queen"))
    assert "q type Seat" in ask(session, "infer", Infer(name="q")).text
    assert ask(session, "check", Check()).consistent
    there = ask(session, "last-seen", LastSeen(name="q"))
    assert (there.pose, there.removed) == (ask(session, "get", Get(name="q")).pose, None)
    document = ask(session, "export", Export(format="turtle", inferred=True))
    assert (v.entity_iri("q"), v.RDF_TYPE, v.dm("Seat")) in rdf.parse(document.content, "export")


def test_asserted_locations_are_compared_with_the_geometry(session):
    kitchen = entity_triples.describe(
        "k9", v.dm("Kitchen"), pose=Pose(position_m=(50.0, 0.0, 0.0)), size_m=(4.0, 4.0, 2.5)
    )
    said = (v.entity_iri("sat"), v.dm("isLocatedIn"), v.entity_iri("k9"))
    ask(session, "commit", transaction("seen1", [*kitchen, *chair("sat", (51.0, 0.0, 0.0)), said]))
    there = ask(session, "get", Get(name="sat", where=True))
    assert [(r.relation, r.object) for r in there.whereabouts] == [("isLocatedIn", "k9")]
    assert not there.denied
    assert not ask(session, "check", Check()).denied
    assert not ask(session, "get", Get(name="sat")).whereabouts
    moved = transaction("seen2", chair("sat", (60.0, 0.0, 0.0)), chair("sat", (51.0, 0.0, 0.0)))
    commit = ask(session, "commit", moved)
    (note,) = commit.notes
    assert note.startswith("retracted: sat was asserted to be in k9; it stands 7.")
    away = ask(session, "get", Get(name="sat", where=True))
    assert (away.whereabouts, away.denied, away.properties) == ((), (), {})
    again = ask(session, "commit", transaction("seen3", [said]))
    away = ask(session, "get", Get(name="sat", where=True))
    (denied,) = away.denied
    assert again.notes == (denied.text,)
    checked = ask(session, "check", Check())
    assert checked.consistent
    assert denied in checked.denied
    then = ask(session, "get", Get(name="sat", where=True, as_of=commit.seq - 1))
    assert (then.whereabouts, then.denied) == (there.whereabouts, ())


def load(number, content, **fields):
    fields = {"replace": False, "skip_unknown": False, **fields}
    return LoadDocument(id=number, source="file", content=content.encode(), filename="f.ttl", **fields)


def test_look_ups_need_no_other_process(session):
    commit = ask(session, "commit", transaction("looked_up", chair("looked_up")))
    query = Sparql(query="SELECT ?class { :looked_up a ?class }")
    result = bus.ask(session, keys.CMD, "sparql", query, reply_type(BRIDGE["sparql"]))
    assert result.rows == ((v.dm("Chair"),),)
    assert result.seq == commit.seq


def test_documents_are_loaded_completely_or_not_at_all(session):
    loaded = ask(session, "load", load("l1", PREFIXES + ":l a dm:Chair . :m a dm:Moon .", skip_unknown=True))
    assert loaded.skipped == ("m (unknown class 'Moon')",)
    before = ask(session, "snapshot", SnapshotQuery())
    assert "l" in {e.name for e in before.entities}
    for content, error in (
        (PREFIXES + ":n a dm:Chair . :m a dm:Moon .", errors.UnknownClass),
        (PREFIXES + ":n a dm:Chair . :o a dm:Chair , dm:Kitchen .", errors.Inconsistent),
        (PREFIXES + ":n a dm:Chair . :o a dm:", errors.BadFile),
    ):
        with pytest.raises(error):
            ask(session, "load", load(f"bad {error.code}", content, replace=True))
    assert ask(session, "snapshot", SnapshotQuery()) == before
    replaced = ask(session, "load", load("l2", PREFIXES + ":only a dm:Chair .", replace=True))
    assert {gone.name for gone in replaced.commit.removed} == {e.name for e in before.entities}
    assert [e.name for e in ask(session, "snapshot", SnapshotQuery()).entities] == ["only"]


def test_compressed_documents_are_loaded(session):
    packed = structs.replace(load("gz1", ""), content=gzip.compress((PREFIXES + ":gz a dm:Chair .").encode()))
    assert ask(session, "load", packed).names == ("gz",)
    with pytest.raises(errors.BadFile, match="the gzip data is truncated"):
        ask(session, "load", structs.replace(packed, id="gz2", content=packed.content[:-9]))
    text = TBOX_TURTLE + "dm:Chair rdfs:comment 'packed' ."
    tbox = LoadTBox(id="gz3", source="file", content=gzip.compress(text.encode()), filename="t.ttl.gz")
    assert ask(session, "load-tbox", tbox).commit.tbox


@pytest.mark.parametrize(
    ("verb", "payload", "error", "text"),
    [
        ("destroy", b"\x80", errors.UnknownVerb, "unknown command 'destroy'; available: backup, check, "),
        ("commit", b"\xc1", errors.BadRequest, "malformed message: it is not valid MessagePack"),
        ("commit", b"\x80", errors.BadRequest, "malformed message: id is missing"),
        (
            "commit",
            codec.encode({"id": "", "source": "operator"}),
            errors.BadRequest,
            "id must be a text of 1 to",
        ),
        (
            "commit",
            codec.encode({"id": "x", "source": "operator", "insert": [["a", "b", "c"]]}),
            errors.BadRequest,
            "not a valid N-Triples statement: a b c",
        ),
        ("get", codec.encode({"name": "ghost9"}), errors.UnknownName, "label or class 'ghost9'"),
    ],
)
def test_an_invalid_request_is_answered_with_an_error(session, verb, payload, error, text):
    (reply,) = session.get(f"{keys.BRIDGE}/{verb}", payload=payload)
    with pytest.raises(error, match=text):
        bus.read_reply(verb, reply, Entity, 1.0)


def test_a_second_knowledge_base_on_the_same_data_is_rejected(bench, session):
    ask(session, "snapshot", SnapshotQuery())
    with ended(bench.start()) as second:
        _, text = second.communicate(timeout=PATIENCE_S)
        assert second.returncode == errors.Refused.exit_status
        assert "kb_node: another knowledge base is using" in text


def test_no_acknowledged_commit_is_lost_when_the_process_is_killed(tmp_path):
    bench = Bench(tmp_path)
    acknowledged = {}
    with bench.session() as session:
        for life in range(2):
            with ended(bench.start()) as process:
                await_answer(session)
                for i in range(20):
                    commit = ask(session, "commit", transaction(f"{life}-{i}", chair(f"c{life}-{i}")))
                    acknowledged[commit.seq] = commit
                pending = session.get(
                    f"{keys.BRIDGE}/commit",
                    payload=codec.encode(transaction("last", chair("last"))),
                    timeout=1.0,
                )
                process.kill()
                list(pending)
        with ended(bench.start()):
            snapshot = await_answer(session)
            for commit in acknowledged.values():
                assert ask(session, "commit", transaction(commit.id, chair("other"))) == commit
    names = {entity.name for entity in snapshot.entities} - {"last"}
    assert names == {f"c{life}-{i}" for life in range(2) for i in range(20)}
    assert snapshot.seq - 1 - len(acknowledged) in (0, 1)


def test_descriptions_use_the_labels(session):
    seat = chair("seat9", (80.0, 0.0, 0.0), preferred="the old seat")
    ask(session, "commit", transaction("seat", [*seat, *chair("seat10", (80.5, 0.0, 0.0))]))
    by_name = ask(session, "relations", Relations(name="seat9", other="seat10"))
    assert by_name
    assert ask(session, "relations", Relations(name="The old seat", other="seat10")) == by_name
    then = Relations(
        name="the old seat", other="seat10", as_of=str(ask(session, "snapshot", SnapshotQuery()).seq)
    )
    assert ask(session, "relations", then) == by_name
    with pytest.raises(errors.BadRequest, match=r"'Chair' is ambiguous: .* name one of them"):
        ask(session, "relations", Relations(name="Chair"))


def test_a_full_disk_is_waited_for(tmp_path):
    bench = Bench(tmp_path)
    with bench.session() as session:
        beats = queue.Queue()
        subscriber = bus.follow(session, keys.HEALTH, lambda _, health: beats.put(health))
        with ended(bench.start()):
            await_answer(session)
            ask(session, "commit", transaction("a", chair("a")))
        assert (bench.data / "journal.sqlite-wal").exists()  # the commit is not in the journal yet
        with ended(bench.start()) as process:
            limit_file_size(process.pid, 1)
            await_full_disk(beats, process.pid)
            limit_file_size(process.pid, resource.RLIM_INFINITY)
            assert "a" in {entity.name for entity in await_answer(session).entities}
        with ended(bench.start()) as process:
            limit_file_size(process.pid, 1)
            await_full_disk(beats, process.pid)
            process.terminate()
            assert process.wait(PATIENCE_S) == 0
        subscriber.undeclare()


def limit_file_size(pid, size):
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))


def await_full_disk(beats, pid):
    """Wait for a heartbeat of this process that reports a full disk."""
    while True:
        health = beats.get(timeout=PATIENCE_S)
        if health.pid == pid and health.detail.startswith("disk full: waiting for space in"):
            assert health.state == "starting"
            return
