"""What is asked of the map: each question is answered by one call, long ones beside the node's own work."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from typing import TypeVar

from msgspec import structs

from semmap.nodes.kb_node.answers import (
    answers,
    beginnings,
    differences,
    hidden,
    map_then,
    questions,
    whereabouts,
)
from semmap.nodes.kb_node.answers.accounts import Accounts
from semmap.nodes.kb_node.answers.finding import Finding
from semmap.nodes.kb_node.answers.gone import gone
from semmap.nodes.kb_node.answers.live import LiveEntities
from semmap.nodes.kb_node.answers.pages import Pages
from semmap.nodes.kb_node.answers.sightings import Sightings
from semmap.nodes.kb_node.answers.standing_places import StandingPlaces
from semmap.nodes.kb_node.answers.understanding import Understanding
from semmap.nodes.kb_node.answers.ways import Ways
from semmap.nodes.kb_node.reasoner import Held
from semmap.nodes.kb_node.reasoner.entailment.explaining import nearby
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.storage import history
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime.fair_pool import FairPool
from semmap.schemas import errors
from semmap.schemas.bridge import (
    CopyQuery,
    Entities,
    LoadOf,
    MapCopy,
    PlanOf,
    Recall,
    SnapshotQuery,
    StarQuery,
    WayOf,
)
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commands import (
    Check,
    Classes,
    Could,
    Diff,
    Explain,
    Export,
    Find,
    Get,
    History,
    Infer,
    LastSeen,
    Properties,
    Relations,
    Renew,
    Sparql,
    Tell,
    Understand,
    WasWhen,
    Watch,
)
from semmap.schemas.commits import Commit, Snapshot, Star
from semmap.schemas.entities import ClassInfo, Entity, PropertyInfo
from semmap.schemas.explanations import Explanation
from semmap.schemas.language import Found
from semmap.schemas.map_history import Difference, Spells
from semmap.schemas.relations import Described, Relation
from semmap.schemas.replies import Checked, Document, Done, Inferred, LoggedCommit, Possible, Sighting
from semmap.schemas.sparql import SparqlResult, Watching

R = TypeVar("R", Explanation, Possible)


class Asking:
    """Answers questions about the map as it is and as it was; changes nothing."""

    def __init__(
        self,
        semantic_map: SemanticMap,
        journal: Journal,
        sparql: SparqlService,
        standing_places: StandingPlaces,
        asker: Callable[[], str] = str,
    ) -> None:
        """`sparql` and `standing_places` are told of each commit by the node; `asker()` is who asks."""
        self._asker = asker
        self._map = semantic_map
        self._sparql = sparql
        self._standing_places = standing_places
        self._journal = journal
        self._past = history.Past(journal)
        self._pages = Pages(semantic_map)
        self._now = whereabouts.Now(semantic_map)
        self.live = LiveEntities(semantic_map)
        """To be told where tracked entities are."""
        self._finding = Finding(semantic_map)
        self._understanding = Understanding(semantic_map, self._finding)
        self._then = whereabouts.Then(semantic_map, self._past)
        self.sightings = Sightings(self._past)
        """To be told of what perception sees."""
        self._accounts = Accounts(semantic_map, self._now, self.sightings)
        self._aside = FairPool(2, asker)
        self._ways = Ways(semantic_map, self._past, self._aside.submit)
        self._second_opinions = FairPool(1, asker)
        """Of owlrl, which take seconds to minutes: nothing else waits behind them."""
        self._is_over = threading.Event()

    def handlers(self) -> dict[str, Handler]:
        """By verb."""
        return by_verb(
            SnapshotQuery.answered_by(self.on_snapshot),
            CopyQuery.answered_by(self.on_copy),
            Recall.answered_by(self.on_recall),
            StarQuery.answered_by(self.on_star),
            LoadOf.answered_by(self.on_load_of),
            Classes.answered_by(self.on_classes),
            Properties.answered_by(self.on_properties),
            Entities.answered_by(self.on_list),
            Get.answered_by(self.on_get),
            Infer.answered_by(self.on_infer),
            Explain.answered_by(self.on_explain),
            Could.answered_by(self.on_could),
            Relations.answered_by(self.on_relations),
            Diff.answered_by(self.on_diff),
            WasWhen.answered_by(self.on_when),
            Understand.answered_by(self._understanding.understand),
            Tell.answered_by(self._accounts.tell),
            Find.answered_by(self.on_find),
            Export.answered_by(self.on_export),
            PlanOf.answered_by(self._ways.plan),
            WayOf.answered_by(self._ways.way),
            History.answered_by(self.on_history),
            LastSeen.answered_by(self.on_last_seen),
            Check.answered_by(self.on_check),
            Sparql.answered_by(self.on_sparql),
            Watch.answered_by(self.on_watch),
            Renew.answered_by(self.on_renew),
        )

    @property
    def is_being_fetched(self) -> bool:
        """Whether somebody fetches the map page by page, or is about to as after a start."""
        return self._pages.may_follow

    def on_snapshot(self, query: SnapshotQuery) -> Snapshot:
        """The entities as of the last commit, or a page of them."""
        return self._pages.snapshot(query)

    def on_copy(self, query: CopyQuery) -> MapCopy:
        """The map whole, or which it is."""
        map_id, begun_ns = self._journal.origin()
        seq = self._map.seq
        return MapCopy(
            map_id=map_id,
            begun_ns=begun_ns,
            seq=seq,
            digest=self._map.digest,
            stamp_ns=self._stamp_of_last(seq),
            triples=tuple(self._map.abox()) if query.content else (),
            entities=tuple(self._map.entities()) if query.content else (),
        )

    def _stamp_of_last(self, seq: int) -> int:
        begins = self._journal.beginning
        return self._journal.stamps.of(seq) if seq > begins.seq else begins.stamp_ns

    def on_recall(self, query: Recall) -> Future[tuple[Commit, ...]]:
        """Commits of the history, whole."""
        return self._aside.submit(self._past.commits, query.seqs)

    def on_star(self, query: StarQuery) -> tuple[Star, ...]:
        """The triples about some entities."""
        return self._map.stars(query.names)

    def on_load_of(self, query: LoadOf) -> tuple[str, ...]:
        """What a thing bears."""
        return tuple(self._map.places.borne_by(query.name, query.leave))

    def on_classes(self, _: Classes) -> tuple[ClassInfo, ...]:
        """The class table."""
        return tuple(self._map.class_table())

    def on_properties(self, _: Properties) -> tuple[PropertyInfo, ...]:
        """The property table."""
        return tuple(self._map.classes.stated.rows())

    def on_list(self, query: Entities) -> tuple[Entity, ...] | Future[tuple[Entity, ...]]:
        """The entities of a class, now or as of then; with `where` those that are there."""
        if query.as_of is None:
            if query.where is None:
                return self._now.entities(query)
            with self.live.supposed():
                return self._now.entities(query)
        return self._aside.submit(self._then.entities, query)

    def on_relations(self, query: Relations) -> tuple[Relation, ...] | Future[tuple[Relation, ...]]:
        """Where a thing is relative to others, now or as of then."""
        if query.as_of is None:
            with self.live.supposed():
                return self._now.relations(query)
        return self._aside.submit(self._then.relations, query)

    def on_get(self, query: Get) -> Described | Future[Described]:
        """One entity, now or as of then."""
        if query.as_of is None:
            if not query.where:
                return self._now.entity(query)
            with self.live.supposed():
                return self._now.entity(query)
        return self._aside.submit(self._then.entity, query)

    def on_infer(self, query: Infer) -> Inferred | Future[Inferred]:
        """What follows about an entity; about all, it is worked out beside the node's own work."""
        if query.name is not None:
            return answers.infer(self._map, query.name)
        return self._aside.submit(answers.infer_all, answers.inferring(self._map))

    def on_explain(self, query: Explain) -> Explanation | Future[Explanation]:
        """Why it follows or cannot, or what was measured of where a thing is; or why it does not hold."""
        if (measured := self._now.measured(query)) is not None:
            return measured
        asked = questions.of_explain(self._map, query)
        found = self._now.explained(query, asked)
        if found is None:
            return self._tried(questions.explain, asked)
        if not found.measured:
            return found.explanation
        look_up = partial(beginnings.looked_up, self._journal, self._past, limits=self._map.classes.limits)
        return self._aside.submit(found.dated, look_up)

    def on_diff(self, query: Diff) -> Future[Difference]:
        """What changed between two commits or times."""
        limits = self._map.classes.limits
        return self._aside.submit(differences.difference, self._journal, self._past, query, limits)

    def on_when(self, query: WasWhen) -> Future[Spells]:
        """When one thing was on, in or at another."""
        limits = self._map.classes.limits
        return self._aside.submit(differences.spells, self._journal, self._past, query, limits)

    def on_could(self, query: Could) -> Possible | Future[Possible]:
        """Whether it could be."""
        asked = questions.of_could(self._map, query)
        against = self._now.against(asked.triples[0])
        return self._tried(partial(questions.could, against=against), asked)

    def _tried(self, answer: Callable[..., R], asked: questions.Asked) -> R | Future[R]:
        """Answer by supposing something of the map itself, or, if that takes long, of a copy beside it."""
        reasoner, names = self._map.reasoner, self._map.classes.prefixed
        held: Held | None = None
        self._map.believe_places()
        if questions.is_quick(reasoner, asked):
            try:
                return answer(reasoner, asked, anew=False)
            except questions.Undecided:
                needed = nearby(reasoner, asked.terms)
                computed = dict.fromkeys(filter(reasoner.is_computed, needed))
                held = Held([triple for triple in needed if triple not in computed], list(computed))
            except NotCompilable:
                pass
        copied = reasoner.held() if held is None else held
        return self._aside.submit(lambda: answer(questions.copy_of(copied, names), asked))

    def on_export(self, query: Export) -> Future[Document]:
        """The map as a document, now or as of then; checked first, and written beside the node's own work."""
        if query.as_of is not None:
            return self._aside.submit(map_then.export_then, self._journal, self._past, query)
        return self._aside.submit(answers.export, answers.picture(self._map, query.inferred), query.format)

    def on_history(self, query: History) -> Future[tuple[LoggedCommit, ...]]:
        """Commits of the history."""
        return self._aside.submit(self._past.history, query)

    def on_last_seen(self, query: LastSeen) -> Sighting | Future[Sighting]:
        """Where an entity was last; where it is, if it is there."""
        entity = self._map.find(query.name)
        if entity is not None and not self.sightings.is_gone(entity):
            found = self.sightings.there(entity)
            closed = hidden.closed_around(self._map, entity)
            if closed is None:
                return found
            return structs.replace(found, text=f"{found.text}; {hidden.in_words(closed)}")
        return self._aside.submit(self.sightings.gone, query.name, entity)

    def on_find(self, query: Find) -> Found | Future[Found]:
        """What a description means; where nothing fits, also when it was last there."""
        with self.live.supposed():
            sought = self._finding.find(query)
        if sought.missing is None:
            return sought.found
        missing, there, limits = sought.missing, frozenset(self._map.names), self._map.classes.limits
        return self._aside.submit(
            lambda: sought.with_the_past(gone(self._journal, self._past, missing, there, limits))
        )

    def on_check(self, query: Check) -> Future[Checked]:
        """Consistency, worked out beside the node's own work."""
        self._map.follow_places()
        held, denied = self._map.reasoner.held(), self._now.denied()
        withheld, crowds = tuple(answers.withheld(self._map)), self._map.places.crowds()

        def check() -> Checked:
            checked = answers.check(held.asserted, query.engine, self._is_over.is_set)
            return structs.replace(checked, denied=denied, withheld=withheld, crowds=crowds)

        return (self._second_opinions if query.engine == "owlrl" else self._aside).submit(check)

    def on_sparql(self, query: Sparql) -> Future[SparqlResult]:
        """A query, evaluated beside the node's own work; of the past, in a process of its own."""
        if query.as_of is not None:
            return self._aside.submit(map_then.ask_then, self._journal, self._past, query)
        return self._sparql.ask(query, self._map.seq, self._asker())

    def on_watch(self, query: Watch) -> Watching | Future[Watching]:
        """A standing query, or a standing question of where things are."""
        asks_where = query.where is not None or query.class_ is not None
        if (query.query is None) != asks_where:
            raise errors.BadRequest(
                "watch either a SELECT query or what is on, in or near something: --on, --in, --near"
            )
        if not asks_where:
            return self._sparql.ask(query, self._map.seq, self._asker())
        if query.where is None or query.inferred:
            raise errors.BadRequest(
                "--class and --inferred: watch classes with --on, --in or --near, inferences with --sparql"
            )
        return self._standing_places.watch(query)

    def on_renew(self, renewal: Renew) -> Done | Future[Done]:
        """A standing query goes on, or ends."""
        return self._standing_places.renew(renewal) or self._sparql.ask(renewal, self._map.seq)

    def close(self) -> None:
        """Answer no more."""
        self._is_over.set()
        self._second_opinions.close()
        self._aside.close()
