"""The SPARQL process from outside: queries, commits, memory limits and kills."""

import os
import queue
import random
import signal
from collections import Counter
from concurrent.futures import Future
from pathlib import Path

import pyoxigraph as ox
import pytest
from msgspec import structs

from semmap.nodes.kb_node.derived_facts import DerivedChanges, DerivedFacts
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.sparql import readers, service
from semmap.nodes.kb_node.sparql.protocol import (
    Committed,
    Load,
    LoadFromDisk,
    MeasurementRequest,
    Placements,
)
from semmap.nodes.kb_node.sparql.queries import text
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.sparql.triples.consequences import inferred
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.nodes.kb_node.sparql.triples.large_map import FilledStore
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL, entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import Renew, Sparql, Watch
from semmap.schemas.commits import Commit, Departed
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.relations.entities import ROOM, TABLE, TOP, thing
from tests.waiting import until

WAIT_S = 60.0
FOR_EVER = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l FILTER(?a < ?l) }"
GREEDY = "SELECT DISTINCT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i } ORDER BY ?c ?f"


class Home:
    """A map without a node: a reasoner as reference, and the service that follows it."""

    def __init__(self, triples):
        self.reasoner = Reasoner(triples)
        self.seq = 0
        self.news = queue.SimpleQueue()
        self.there = {}
        self.derived_facts = DerivedFacts(self.reasoner)
        self.service = SparqlService(
            lambda: self.reasoner.asserted(),
            self.news.put,
            derived_changes=lambda: self.derived_facts.all(),
            closed=lambda: self.reasoner.closed,
        )

    def commit(self, insert=(), retract=(), changed=(), removed=()):
        insert, retract = tuple(insert), tuple(retract)
        self.derived_facts.begin()
        self.derived_facts.change(retract, insert)
        self.derived_facts.follow(changed, removed, self.there.get, retract, insert)
        self.seq += 1
        self.there.update((entity.name, entity) for entity in changed)
        for name in removed:
            del self.there[name]
        commit = Commit(
            seq=self.seq,
            stamp_ns=0,
            id="",
            source="operator",
            inserted=insert,
            retracted=retract,
            changed=tuple(changed),
            removed=tuple(Departed(name=name, types=()) for name in removed),
        )
        self.service.follow(commit, self.derived_facts.derived_changes)

    def replace(self, triples):
        """Replace the TBox."""
        self.reasoner = Reasoner(triples)
        self.derived_facts = DerivedFacts(self.reasoner)
        self.seq += 1
        self.service.follow(Commit(seq=self.seq, stamp_ns=0, id="", source="operator", tbox=True))

    def ask(self, query, **fields):
        return self.service.ask(Sparql(query=query, **fields), self.seq).result(WAIT_S)

    def watch(self, query, **fields):
        return self.service.ask(Watch(query=query, **fields), self.seq).result(WAIT_S)

    def renew(self, watch, **fields):
        return self.service.ask(Renew(watch=watch, **fields), self.seq).result(WAIT_S)

    def hear(self):
        return self.news.get(timeout=WAIT_S)


@pytest.fixture
def at_home():
    made = Home(home.TBOX)
    yield made
    made.service.close()


@pytest.fixture(scope="module")
def flat():
    """One service for all tests; it survives cancelled queries."""
    files = (HOUSEHOLD_TTL, FLAT_TTL)
    made = Home(
        [t for file in files for t in rdf.parse(file.read_bytes(), file.name, label_prefix=file.stem)]
    )
    yield made
    made.service.close()


def iri(name):
    return v.entity_iri(name)


def chair(name):
    return entity_triples.describe(name, v.dm("Chair"), pose=Pose(position_m=(1.0, 2.0, 0.0)))


CHAIRS = "SELECT ?c { ?c a dm:Chair } ORDER BY ?c"
SEATS = "SELECT ?c { ?c a dm:Seat } ORDER BY ?c"


def test_a_query_sees_every_earlier_commit(at_home):
    for number in range(20):
        at_home.commit(chair(f"c{number:02}"))
        result = at_home.ask(CHAIRS)
        assert result.rows == tuple((iri(f"c{n:02}"),) for n in range(number + 1))
        assert result.seq == at_home.seq
    assert not at_home.ask(SEATS).rows
    assert len(at_home.ask(SEATS, inferred=True).rows) == 20
    at_home.commit(retract=chair("c00"))
    assert len(at_home.ask(SEATS, inferred=True).rows) == len(at_home.ask(CHAIRS).rows) == 19


def test_computed_facts_that_change_without_a_commit_are_sent_again(at_home):
    at_home.commit(chair("c1"))
    rows = at_home.ask(SEATS, inferred=True).rows
    fact = (v.entity_iri("c2"), v.RDF_TYPE, v.dm("Chair"))
    at_home.reasoner.update_computed(add=[fact])
    at_home.service.reload()
    until(lambda: len(at_home.ask(SEATS, inferred=True).rows) == len(rows) + 1, "the new fact is seen")


def test_readers_without_open_files_note_unknown_terms(flat):
    note = "unknown term dm:isOnn; did you mean dm:isOn"
    for with_inferred in (False, True):
        found = flat.ask("SELECT ?x { ?x dm:isOnn :table1 }", inferred=with_inferred)
        assert [text.partition(",")[0].removesuffix("?") for text in found.notes] == [note]
    assert "did you mean :table1" in flat.ask("ASK { ?x dm:isOn :tabel1 }").notes[0]
    watching = flat.watch("SELECT ?x { ?x dm:isOnn ?y }")
    assert watching.notes[0].startswith(note)
    flat.renew(watching.watch, end=True)


QUERIES = [
    "SELECT ?x ?c { ?x a ?c }",
    "SELECT ?x { ?x a dm:Seat }",
    "SELECT ?x ?p ?y { ?x ?p ?y }",
    "SELECT ?x ?r { ?x dm:isLocatedIn ?r }",
    "SELECT ?r (COUNT(?x) AS ?n) { ?r dm:contains ?x } GROUP BY ?r",
    "SELECT ?x { ?x a dm:Object FILTER NOT EXISTS { ?x dm:isLocatedIn ?r } }",
    "SELECT ?c { ?c rdfs:subClassOf dm:Object }",
    "SELECT ?x ?y { ?x (dm:isOn|^dm:supports)+ ?y }",
]


def test_with_inferred_it_equals_a_query_over_the_full_materialisation(flat):
    dice = random.Random(7)
    names = [name for name in ("kitchen1", "fridge1", "table1", "chair1", "chair2") if _is_there(flat, name)]
    own = []
    for round_ in range(8):
        truth = ox.Store()
        document = "".join(
            f"{s} {p} {o} .\n" for s, p, o in {*flat.reasoner.asserted(), *inferred(flat.reasoner)}
        )
        truth.bulk_extend(ox.Quad(*q.triple) for q in ox.parse(document.encode(), ox.RdfFormat.N_TRIPLES))
        for query in QUERIES:
            expected = truth.query(query, prefixes=text.PREFIXES)
            found = flat.ask(query, inferred=True, limit=100_000)
            assert sorted(found.rows) == sorted(tuple(map(str, row)) for row in expected), query
        for _ in range(3):
            insert = [(iri(f"n{round_}"), v.RDF_TYPE, v.dm(dice.choice(["Cup", "Chair", "Shelf"])))]
            insert += [(iri(f"n{round_}"), v.dm("isOn"), iri(dice.choice(names)))]
            insert += [(iri(dice.choice(names)), v.dm("touches"), iri(dice.choice(names)))]
            retract = dice.sample(own, min(len(own), 2))
            said = [t for t in insert if not any(True for _ in flat.reasoner.asserted(*t))]
            try:
                flat.commit(said, retract)
            except Inconsistent:
                continue
            own = [t for t in own if t not in retract] + said
    assert len(own) > 5


def _is_there(flat, name):
    return any(True for _ in flat.reasoner.asserted(iri(name), None, None))


def test_an_endless_query_is_cancelled_and_others_are_answered(flat):
    flat.ask(CHAIRS)
    endless = flat.service.ask(Sparql(query=FOR_EVER, timeout=2.0), 0)
    answered = 0
    while not endless.done():
        assert flat.ask(CHAIRS).rows
        answered += not endless.done()
    assert answered
    with pytest.raises(errors.Refused, match="the query was cancelled after 2 s"):
        endless.result(WAIT_S)
    assert flat.ask(CHAIRS).rows


def test_more_queries_than_readers_are_answered_in_turn(flat):
    asked = [flat.service.ask(Sparql(query=FOR_EVER, timeout=0.3), 0) for _ in range(6)]
    last = flat.service.ask(Sparql(query=CHAIRS), 0)
    for future in asked:
        with pytest.raises(errors.Refused, match=r"cancelled after 0.3 s"):
            future.result(WAIT_S)
    assert last.result(WAIT_S).rows


def test_a_query_that_needs_too_much_memory_is_cancelled(flat):
    with pytest.raises(errors.Refused, match=r"cancelled: it needs more than 1024 MB|cancelled after"):
        flat.ask(GREEDY, timeout=30.0)
    assert flat.ask(CHAIRS).rows


def test_an_answer_that_is_too_long_is_rejected(at_home):
    at_home.commit(chair("c"))
    doubled = "".join(f"BIND(CONCAT(?s{n}, ?s{n}) AS ?s{n + 1}) " for n in range(24))
    with pytest.raises(errors.Refused, match=f"longer than {readers.ANSWER_BYTES >> 20} MB"):
        at_home.ask(f'SELECT ?s24 {{ BIND("abcd" AS ?s0) {doubled} }}', timeout=60.0)
    assert at_home.ask(CHAIRS).rows


def test_rows_appear_and_disappear_with_their_commits(at_home):
    at_home.commit(chair("a"))
    watching = at_home.watch(SEATS, inferred=True, watch="seats")
    assert (watching.watch, watching.rows, watching.seq) == ("seats", ((iri("a"),),), 1)
    at_home.commit(chair("b"))
    at_home.commit([(iri("b"), v.dm("hasSize"), iri("s"))])
    at_home.commit(chair("c"), chair("a"))
    gained, changed = at_home.hear().rows, at_home.hear().rows
    assert (gained.seq, gained.since, gained.appeared, gained.disappeared) == (2, 1, ((iri("b"),),), ())
    assert (changed.seq, changed.appeared, changed.disappeared) == (4, ((iri("c"),),), ((iri("a"),),))
    assert at_home.renew("seats", end=True).text == "seats has ended"
    assert at_home.hear().ended
    with pytest.raises(errors.UnknownName):
        at_home.renew("seats")


def test_a_burst_of_commits_is_published_one_by_one(at_home):
    at_home.watch(CHAIRS)
    for number in range(50):
        at_home.commit(chair(f"c{number}"))
    heard = [at_home.hear().rows for _ in range(50)]
    assert [(rows.seq, rows.appeared) for rows in heard] == [(n + 1, ((iri(f"c{n}"),),)) for n in range(50)]


def test_the_lease_of_a_standing_query_ends(at_home):
    at_home.watch(CHAIRS, watch="kept", lease=WAIT_S)
    with pytest.raises(errors.NameTaken):
        at_home.watch(CHAIRS, watch="kept")
    at_home.watch(CHAIRS, watch="w", lease=1.0)
    news = at_home.hear()
    assert (news.watch, news.ended) == ("w", True)
    at_home.watch(CHAIRS, watch="w")


def test_a_standing_query_that_takes_too_long_is_rejected(flat):
    with pytest.raises(errors.Refused, match="cancelled after 2 s"):
        flat.watch(FOR_EVER)
    assert flat.watch(CHAIRS).rows


def test_a_standing_query_that_gets_too_many_rows_ends_with_the_reason(at_home):
    everything = "SELECT * { ?door a dm:Door . ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }"
    assert at_home.watch(everything, watch="w").rows == ()
    at_home.commit([(iri("door"), v.RDF_TYPE, v.dm("Door"))])
    news = at_home.hear()
    assert news.ended
    assert "more than 10000 rows" in news.rows.error


def test_a_new_process_answers_after_a_kill(at_home):
    at_home.commit(chair("a"))
    at_home.ask(CHAIRS)
    endless = at_home.service.ask(Sparql(query=FOR_EVER, timeout=60.0), 1)
    os.kill(at_home.service._worker._process.pid, signal.SIGKILL)
    with pytest.raises(errors.Refused, match="repeat the query"):
        endless.result(WAIT_S)
    at_home.commit(chair("b"))
    assert len(at_home.ask(CHAIRS).rows) == 2


def test_a_replaced_tbox_is_used(at_home):
    at_home.commit(chair("a"))
    at_home.watch(SEATS, inferred=True)
    no_seat = (v.dm("Chair"), v.RDFS_SUB_CLASS_OF, v.dm("Seat"))
    at_home.replace([t for t in at_home.reasoner.asserted() if t != no_seat])
    news = at_home.hear().rows
    assert (news.seq, news.since, news.disappeared) == (2, 1, ((iri("a"),),))
    assert not at_home.ask(SEATS, inferred=True).rows
    assert at_home.ask(CHAIRS).rows


@pytest.mark.parametrize("inferred", [False, True])
def test_commits_around_a_replaced_tbox_are_published_one_by_one(at_home, inferred):
    at_home.watch(CHAIRS, inferred=inferred)
    for number in range(30):
        at_home.commit(chair(f"before{number}"))
    at_home.replace([*at_home.reasoner.asserted(), *chair("by_the_tbox")])
    for number in range(30):
        at_home.commit(chair(f"after{number}"))
    names = [*(f"before{n}" for n in range(30)), "by_the_tbox", *(f"after{n}" for n in range(30))]
    heard = [at_home.hear().rows for _ in names]
    assert [(rows.seq, rows.appeared) for rows in heard] == [
        (seq, ((iri(name),),)) for seq, name in enumerate(names, start=1)
    ]


def test_a_backlog_of_two_replaced_tboxes_is_published_in_one_step(at_home):
    at_home.watch(CHAIRS)
    for _ in range(4):
        at_home.commit(chair(f"c{at_home.seq}"))
        at_home.replace(list(at_home.reasoner.asserted()))
    appeared = []
    while len(appeared) < 4:
        appeared += at_home.hear().rows.appeared
    assert appeared == [(iri(f"c{n}"),) for n in (0, 2, 4, 6)]


def test_the_first_query_starts_the_process(at_home):
    at_home.commit(chair("a"))
    with pytest.raises(errors.UnknownName):
        at_home.renew("w")
    assert at_home.service._worker is None


ON = "SELECT ?x ?y { ?x dm:isOn ?y }"
IN = "SELECT ?x ?y { ?x dm:isLocatedIn ?y }"


def _there(entity):
    return structs.replace(entity, iri=v.bare(iri(entity.name)))


def test_computed_facts_are_published_as_a_new_query_finds_them(at_home):
    """Standing location queries over random moves have the rows of a new query."""
    at_home.replace(rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="h"))
    dice = random.Random(5)
    room, table = _there(ROOM), _there(structs.replace(TABLE, name="oak1"))
    at_home.commit(changed=[room, table])
    rows = {}
    for query in (ON, IN):
        watching = at_home.watch(query, inferred=True)
        rows[watching.watch] = (query, Counter(watching.rows))
    on_oak = 0
    for number in range(40):
        name = f"cup{dice.randrange(8) + 60}"
        if name in at_home.there and dice.random() < 0.2:
            at_home.commit(removed=[name])
        elif dice.random() < 0.1:
            at_home.commit(
                changed=[structs.replace(table, pose=Pose(position_m=(float(number % 3), 0.0, 0.0)))]
            )
        else:
            at = (dice.uniform(-1.0, 2.0), 0.0, dice.choice([0.0, TOP, TOP, TOP + 0.1]))
            at_home.commit(changed=[_there(thing(name, at, "cup"))])
        if number % 8 == 7:
            asked = {query: Counter(at_home.ask(query, inferred=True).rows) for query in (ON, IN)}
            assert not any(at_home.ask(f"SELECT ?x {{ ?x dm:isOn <{v.bare(iri('oak1'))}> }}").rows)
            on_oak += len([row for row in asked[ON] if row[1] == iri("oak1")])
            while any(rows[watch][1] != asked[rows[watch][0]] for watch in rows):
                news = at_home.hear().rows
                query, known = rows[news.watch]
                rows[news.watch] = (query, known + Counter(news.appeared) - Counter(news.disappeared))
    assert on_oak > 2


def test_suppressed_assertions_are_not_in_the_result(at_home):
    at_home.replace(rdf.parse(HOUSEHOLD_TTL.read_bytes(), "household.ttl", label_prefix="h"))
    said = (iri("cup1"), v.dm("isOn"), iri("table1"))
    on_it = "SELECT ?x { ?x dm:isOn :table1 }"
    cup = _there(thing("cup1", (4.0, 0.0, 0.0)))
    at_home.commit([said], changed=[cup, _there(TABLE)])
    assert at_home.ask(on_it).rows == ((iri("cup1"),),)
    assert not at_home.ask(on_it, inferred=True).rows
    assert at_home.ask(on_it).rows == ((iri("cup1"),),)  # in another graph, but still asserted
    at_home.commit(changed=[structs.replace(cup, pose=Pose(position_m=(0.0, 0.0, TOP)))])
    assert at_home.ask(on_it, inferred=True).rows == at_home.ask(on_it).rows == ((iri("cup1"),),)


class Sent:
    """In place of the process: the messages to it, and the commands that wait for its replies."""

    def __init__(self):
        self.is_alive = True
        self.messages = []
        self.asked = []
        self.demands = []

    def send(self, message):
        self.messages.append(message)

    def ask(self, command, seq, demand=0, asker=""):
        self.asked.append((command, seq))
        self.demands.append(demand)
        return Future()


class Large:
    """A large map whose stores are filled when the test says so. Commits of two triples are large."""

    is_large = True

    def __init__(self):
        self.kept = None
        self.fillings = []
        self.prepared = []

    def find_store(self, seq):
        return self.kept

    def is_large_change(self, commit):
        return len(commit.inserted) > 1

    def fill(self, seq, now, commit=None):
        self.fillings.append((seq, commit, Future()))
        return self.fillings[-1][2]

    def prepare(self, commit):
        self.prepared.append(commit.seq)
        return lambda: self.prepared.append("aborted")

    def prefetch(self, commit_id, turtle, base, *, packed=b""):
        self.prepared.append(commit_id)

    def discard(self):
        self.prepared.append("discarded")

    def fill_last(self):
        seq, _, future = self.fillings[-1]
        future.set_result(FilledStore(Path(f"store{seq}"), seq, seq))


class Filling:
    """The service of a large map, without a process: its messages are only noted."""

    service_class = SparqlService

    def __init__(self, monkeypatch, asserted=(), **options):
        self.sent, self.large = Sent(), Large()
        monkeypatch.setattr(service, "_Worker", lambda publish: self.sent)
        options = options or {"large_map": self.large}
        self.service = self.service_class(lambda: asserted, lambda _: None, **options)

    def commit(self, seq, triples=0, **fields):
        inserted = tuple(("<urn:s>", "<urn:p>", f"<urn:{seq}-{k}>") for k in range(triples))
        made = Commit(seq=seq, stamp_ns=0, id="", source="operator", inserted=inserted, **fields)
        self.service.follow(made)
        return made

    def told(self):
        """Return what the process was told: the stores by their commit, and the commits."""
        kinds = {LoadFromDisk: "store", Committed: "commit", Load: "load"}
        return [
            (kinds[type(one)], one.delta.seq if isinstance(one, Committed) else one.seq)
            for one in self.sent.messages
        ]


@pytest.fixture
def filling(monkeypatch):
    return Filling(monkeypatch)


WATCH = Watch(query=CHAIRS, watch="w")


def test_commits_while_a_store_is_filled_follow_it(filling):
    filling.service.ask(Sparql(query=CHAIRS), 3)
    filling.commit(4, 1)
    filling.commit(5, 1)
    assert filling.told() == []
    assert [seq for seq, _, _ in filling.large.fillings] == [3]
    filling.large.fill_last()
    filling.commit(6, 1)
    assert filling.told() == [("store", 3), ("commit", 4), ("commit", 5), ("commit", 6)]


def test_standing_queries_wait_for_the_store_and_others_for_their_commit(filling):
    filling.service.ask(WATCH, 3)
    filling.service.ask(Sparql(query=CHAIRS), 3)
    filling.commit(4, 1)
    assert [type(command) for command, _ in filling.sent.asked] == [Sparql]
    filling.large.fill_last()
    filling.service.ask(Renew(watch="w"), 4)
    assert [(type(command), seq) for command, seq in filling.sent.asked] == [
        (Sparql, 3),
        (Watch, 4),
        (Renew, 4),
    ]


@pytest.mark.parametrize("is_asked_before", [True, False])
def test_a_tbox_that_is_replaced_while_a_store_is_filled_needs_another_store(filling, is_asked_before):
    if is_asked_before:
        filling.service.ask(WATCH, 3)
    else:
        filling.commit(3, 2)  # a large commit, whose store is created before any query
    filling.commit(4, tbox=True)
    first = filling.large.fillings[0]
    if not is_asked_before:
        filling.service.ask(WATCH, 4)
    first[2].set_result(FilledStore(Path("old"), 3, 3))
    assert filling.told() == []
    assert filling.sent.asked == []
    filling.commit(5, 1)
    filling.large.fill_last()
    assert [seq for seq, _, _ in filling.large.fillings] == [3, 4]
    assert filling.told() == [("store", 4), ("commit", 5)]
    assert len(filling.sent.asked) == 1


def test_a_large_commit_begins_a_store_and_a_small_one_is_sent(filling):
    filling.commit(1, 1)  # nothing was asked
    assert not filling.large.fillings
    large = filling.commit(2, 2)
    assert filling.large.fillings[0][:2] == (2, large)
    filling.large.fill_last()
    assert filling.told() == []
    filling.large.kept = FilledStore(Path("kept"), 2, 2), [Delta(seq=3)]
    filling.service.ask(Sparql(query=CHAIRS), 3)
    assert filling.told() == [("store", 2), ("commit", 3)]
    filling.commit(4, 1)
    assert filling.told()[2:] == [("commit", 4)]


def test_inferred_triples_are_in_memory(filling):
    filling.service.ask(Sparql(query=CHAIRS), 3)
    filling.service.ask(Sparql(query=CHAIRS, inferred=True), 3)
    filling.commit(4, 2)
    filling.large.fillings[0][2].set_result(FilledStore(Path("old"), 3, 3))
    assert filling.told() == [("load", 3), ("commit", 4)]
    assert filling.sent.messages[0].infers
    filling.service.reload()
    filling.service.ask(Sparql(query=CHAIRS, inferred=True), 4)
    assert filling.told()[2:] == [("load", 4)]


def test_without_a_store_the_triples_are_in_memory(filling, caplog):
    filling.service.ask(WATCH, 3)
    filling.large.fillings[0][2].set_exception(errors.Refused("the disk is full"))
    assert filling.told() == [("load", 3)]
    assert len(filling.sent.asked) == 1
    assert "SPARQL keeps its triples in memory: the disk is full" in caplog.text
    assert not filling.sent.messages[0].infers


def test_a_process_that_has_ended_is_replaced(filling):
    with pytest.raises(errors.UnknownName, match="there is no standing query 'w'"):
        filling.service.ask(Renew(watch="w"), 1)
    filling.large.is_large = False
    filling.service.ask(Sparql(query=CHAIRS, inferred=True), 1)
    ended, filling.sent = filling.sent, Sent()
    ended.is_alive = False
    with pytest.raises(errors.UnknownName):
        filling.service.ask(Renew(watch="w"), 2)
    filling.service.ask(Sparql(query=CHAIRS), 2)
    assert [one.infers for one in (*ended.messages, *filling.sent.messages)] == [True, False]
    filling.commit(3, tbox=True)
    assert filling.told() == [("load", 2), ("load", 3)]


def test_a_store_is_begun_in_advance_only_if_it_will_be_used(filling):
    commit = Commit(seq=1, stamp_ns=0, id="a", source="operator")
    filling.service.prefetch("a", b"", "")
    filling.service.prepare(commit)()
    filling.service.discard_prepared()
    assert filling.large.prepared == ["a", 1, "aborted", "discarded"]
    filling.service.ask(Sparql(query=CHAIRS), 3)  # a store is being filled
    filling.service.prefetch("b", b"", "")
    filling.service.prepare(commit)()
    filling.large.fill_last()
    filling.service.ask(Sparql(query=CHAIRS, inferred=True), 3)  # triples are in memory from now on
    filling.service.prefetch("c", b"", "")
    filling.service.prepare(commit)()
    assert len(filling.large.prepared) == 4


NEAR_CUP = "SELECT ?x { ?x dm:isNear :cup1 }"
IS_NEAR = [(v.dm("isNear"), v.RDF_TYPE, v.iri(v.OWL + "ObjectProperty"))]


@pytest.fixture
def measuring(monkeypatch):
    """A service that can measure, and the messages to its process."""
    made = Filling(
        monkeypatch,
        IS_NEAR,
        derived_changes=lambda: DerivedChanges(come=IS_NEAR),
        placements=lambda: Placements(placed=(), limits=Thresholds()),
    )
    return made.service, made.sent


def test_poses_are_sent_once_a_query_needs_measurements(measuring):
    made, sent = measuring
    asked = [
        Sparql(query=CHAIRS, inferred=True),
        Sparql(query=NEAR_CUP),
        Sparql(query=NEAR_CUP, inferred=True),
        Sparql(query=CHAIRS, inferred=True),
        Watch(query=NEAR_CUP, inferred=True),
        Renew(watch="w"),
    ]
    for command in asked:
        made.ask(command, 1)
    assert sent.demands == [0, 0, 1, 0, 2, 0]
    kinds = [Load, Placements, MeasurementRequest, MeasurementRequest]
    assert [type(message) for message in sent.messages] == kinds
    assert [one.demand for one in sent.messages if isinstance(one, MeasurementRequest)] == [1, 2]
    made.reload()
    assert sent.messages[-1].placements is not None
    assert sent.messages[0].placements is None


@pytest.mark.parametrize(
    ("query", "infers", "has_poses"),
    [
        (Sparql(query=CHAIRS), False, False),
        (Sparql(query=CHAIRS, inferred=True), True, False),
        (Sparql(query=NEAR_CUP, inferred=True), True, True),
    ],
)
def test_a_commit_has_the_computed_facts_and_poses_that_the_process_needs(
    measuring, query, infers, has_poses
):
    made, sent = measuring
    changed = (thing("cup1", (0.0, 0.0, 0.0)),)
    commit = Commit(
        seq=2,
        stamp_ns=0,
        id="",
        source="operator",
        changed=changed,
        removed=(Departed(name="cup2", types=()),),
    )
    come = DerivedChanges(come=[("<urn:a>", v.dm("isOn"), "<urn:b>")])
    made.follow(commit, come)  # nothing was asked yet
    assert sent.messages == []
    made.ask(query, 1)
    made.follow(commit, come)
    committed = sent.messages[-1]
    assert (committed.derived_changes == come) == infers
    assert [entity.name for entity in committed.placed] == ["cup1"] * has_poses
    assert committed.removed == ("cup2",) * has_poses
    assert bool(sent.messages[0].derived_changes.come) == infers
