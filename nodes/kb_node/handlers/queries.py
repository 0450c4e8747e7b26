"""Handlers for queries on the current map. Long ones run in other threads or processes."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from functools import partial
from typing import TypeVar

from msgspec import structs

from semmap.nodes.kb_node.answers import answers, entity_queries, questions
from semmap.nodes.kb_node.answers.command_parser import CommandParser
from semmap.nodes.kb_node.answers.descriptions import Descriptions, describe_past
from semmap.nodes.kb_node.answers.entity_search import EntitySearch, describe_missing, find_past
from semmap.nodes.kb_node.answers.live_poses import LiveEntities
from semmap.nodes.kb_node.answers.location_queries import LocationQueries
from semmap.nodes.kb_node.answers.past import fact_intervals, individual_dates, past_map
from semmap.nodes.kb_node.answers.past.episodes.replying import answer_questions
from semmap.nodes.kb_node.answers.past.episodes.resolving import PastQuestionReader
from semmap.nodes.kb_node.answers.past.trail_recording import TrailRecorder
from semmap.nodes.kb_node.answers.route_planning import RoutePlanning
from semmap.nodes.kb_node.answers.sightings import Sightings
from semmap.nodes.kb_node.handlers.map_copies import MapCopyHandlers
from semmap.nodes.kb_node.handlers.past_queries import PastQueryHandlers
from semmap.nodes.kb_node.reasoner import GivenFacts
from semmap.nodes.kb_node.reasoner.entailment.explaining import nearby
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.relations.free_room import find_room
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.shacl import violations
from semmap.nodes.kb_node.shacl.validation_process import ShapeValidator
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.storage import history, trail_file
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime.fair_queue import FairPool
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import Entities, FindRoom, LoadOf, PlanOf, Room, WayOf
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commands import (
    Check,
    Classes,
    Could,
    Explain,
    Export,
    Find,
    Get,
    Infer,
    Properties,
    Relations,
    Renew,
    Rules,
    Sparql,
    Tell,
    Understand,
    Watch,
)
from semmap.schemas.entities import ClassInfo, Entity, PropertyInfo, RuleInfo
from semmap.schemas.explanations import Explanation
from semmap.schemas.language import Account, Found, Understood
from semmap.schemas.live import LivePoses
from semmap.schemas.relations import Described, Relation
from semmap.schemas.replies import Checked, Document, Done, Inferred, Possible
from semmap.schemas.sparql import SparqlResult, Watching

log = logging.getLogger(__name__)

R = TypeVar("R", Explanation, Possible)


class QueryHandlers:
    """Answers queries about the current and past map. Changes nothing."""

    def __init__(
        self,
        semantic_map: SemanticMap,
        journal: Journal,
        sparql: SparqlService,
        location_queries: LocationQueries,
        asker: Callable[[], str] = str,
        report: Callable[[str], None] = log.error,
    ) -> None:
        """Create the handlers. The node passes each commit to `sparql` and `location_queries`.

        `asker()` returns the client of the current request. `report(text)` reports an error of the node.
        """
        self._asker = asker
        self._map = semantic_map
        self._sparql = sparql
        self._location_queries = location_queries
        self._journal = journal
        self._past = history.HistoryReader(journal)
        self._now = entity_queries.CurrentState(semantic_map)
        self.live = LiveEntities(semantic_map)
        """Receives live poses."""
        self.trail = TrailRecorder(trail_file.TrailFile(journal.path.parent), self._list_solids, report)
        """Records live poses."""
        self._search = EntitySearch(semantic_map)
        self._parser = CommandParser(semantic_map, self._search, self._seen)
        self._past_reader = PastQuestionReader(semantic_map, self._search, journal, self._past)
        self._then = entity_queries.PastState(semantic_map, self._past)
        self.sightings = Sightings(self._past)
        """Receives the observations of perception."""
        self._descriptions = Descriptions(semantic_map, self._now, self.sightings)
        self._aside = FairPool(2, asker)
        self._routes = RoutePlanning(semantic_map, self._past, self._aside.submit)
        self._second_opinions = FairPool(1, asker)
        """For checks with owlrl, which take seconds to minutes, so that no other work waits behind them."""
        self._validations = FairPool(1, asker)
        """For checks with shapes, which clients may send and which may take a minute."""
        self._validator = ShapeValidator()
        self._is_over = threading.Event()
        self.copies = MapCopyHandlers(semantic_map, journal, self._past, self._aside)
        """Returns copies of the map."""
        self.past = PastQueryHandlers(
            semantic_map, journal, self._past, self.live, self.trail, self.sightings, self._aside
        )
        """Answers queries about the past."""

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        own = by_verb(
            LoadOf.answered_by(self.on_load_of),
            FindRoom.answered_by(self.on_find_room),
            Classes.answered_by(self.on_classes),
            Properties.answered_by(self.on_properties),
            Rules.answered_by(self.on_rules),
            Entities.answered_by(self.on_list),
            Get.answered_by(self.on_get),
            Infer.answered_by(self.on_infer),
            Explain.answered_by(self.on_explain),
            Could.answered_by(self.on_could),
            Relations.answered_by(self.on_relations),
            Understand.answered_by(self.on_understand),
            Tell.answered_by(self.on_tell),
            Find.answered_by(self.on_find),
            Export.answered_by(self.on_export),
            PlanOf.answered_by(self._routes.compute_plan),
            WayOf.answered_by(self._routes.compute_route),
            Check.answered_by(self.on_check),
            Sparql.answered_by(self.on_sparql),
            Watch.answered_by(self.on_watch),
            Renew.answered_by(self.on_renew),
        )
        return {**own, **self.copies.handlers(), **self.past.handlers()}

    def _list_solids(self) -> tuple[int, Iterable[Solid], Thresholds]:
        """Return the version of the map, its solids and the thresholds of relations."""
        return self._map.seq, self._map.places.space().solids.values(), self._map.classes.limits

    def on_live_poses(self, message: LivePoses) -> None:
        """Use and record the live poses of all tracked entities."""
        self.live.update(message)
        self.trail.update(message)

    def on_load_of(self, query: LoadOf) -> tuple[str, ...]:
        """Return what an object supports."""
        return tuple(self._map.places.supported_by(query.name, query.leave))

    def on_find_room(self, query: FindRoom) -> Room:
        """Return a free pose for an object on, in or next to another one."""
        contents = self._map.places.supported_by(query.name) if query.carry else ()
        with self.live.applied():
            return find_room(self._map.places.space(), query, self._map.find(query.name), contents)

    def on_classes(self, _: Classes) -> tuple[ClassInfo, ...]:
        """Return the class table."""
        return tuple(self._map.class_table())

    def on_properties(self, _: Properties) -> tuple[PropertyInfo, ...]:
        """Return the property table."""
        return tuple(self._map.classes.property_table.rows())

    def on_rules(self, _: Rules) -> tuple[RuleInfo, ...]:
        """Return the SWRL rules of the TBox."""
        return tuple(answers.list_rules(self._map.reasoner))

    def on_list(self, query: Entities) -> tuple[Entity, ...] | Future[tuple[Entity, ...]]:
        """Return the entities of a class, or those that match `where`, now or in the past."""
        if query.as_of is None:
            if query.where is None:
                return self._now.entities(query)
            with self.live.applied():
                return self._now.entities(query)
        return self._aside.submit(self._then.entities, query)

    def on_relations(self, query: Relations) -> tuple[Relation, ...] | Future[tuple[Relation, ...]]:
        """Return the relations of an entity, now or in the past."""
        if query.as_of is None:
            with self.live.applied():
                return self._now.relations(query)
        return self._aside.submit(self._then.relations, query)

    def on_get(self, query: Get) -> Described | Future[Described]:
        """Return one entity, now or in the past."""
        if query.as_of is not None:
            return self._aside.submit(self._then.entity, query)
        if not query.where:
            found = self._now.entity(query)
        else:
            with self.live.applied():
                found = self._now.entity(query)
        if found.in_space:
            return found
        described = individual_dates.find_described(self._map.reasoner, v.iri(found.iri))
        dates = partial(individual_dates.find_dates, self._journal, described, self._map.seq)
        return self._aside.submit(lambda: dates().of(found))

    def on_infer(self, query: Infer) -> Inferred | Future[Inferred]:
        """Return the inferred facts about an entity, or about all in another thread."""
        if query.name is not None:
            return answers.infer(self._map, query.name)
        return self._aside.submit(answers.infer_all, answers.inference_input(self._map))

    def on_explain(self, query: Explain) -> Explanation | Future[Explanation]:
        """Return why a statement holds or cannot hold, with measurements.

        Raises Refused if it does not hold.
        """
        if (measured := self._now.explain_measured(query)) is not None:
            return measured
        asked = questions.parse_explain(self._map, query)
        found = self._now.explain(query, asked)
        if found is None:
            return self._test_on_copy(questions.explain, asked)
        if not found.measured:
            return found.explanation
        look_up = partial(
            fact_intervals.look_up_starts, self._journal, self._past, limits=self._map.classes.limits
        )
        return self._aside.submit(found.with_dates, look_up)

    def on_could(self, query: Could) -> Possible | Future[Possible]:
        """Return whether a statement could hold."""
        asked = questions.parse_could(self._map, query)
        against = self._now.describe_conflict(asked.triples[0])
        return self._test_on_copy(partial(questions.could, against=against), asked)

    def _test_on_copy(self, answer: Callable[..., R], asked: questions.StatementQuestion) -> R | Future[R]:
        """Assume a statement in the map's reasoner, or in a copy in another thread if that takes long."""
        reasoner, names = self._map.reasoner, self._map.classes.prefixed
        held: GivenFacts | None = None
        self._map.ensure_derived()
        if questions.is_quick(reasoner, asked):
            try:
                return answer(reasoner, asked, recompute=False)
            except questions.Undecided:
                needed = nearby(reasoner, asked.terms)
                computed = dict.fromkeys(filter(reasoner.is_computed, needed))
                held = GivenFacts([triple for triple in needed if triple not in computed], list(computed))
            except NotCompilable:
                pass
        copied = reasoner.given_facts() if held is None else held
        return self._aside.submit(lambda: answer(questions.copy_reasoner(copied, names), asked))

    def on_export(self, query: Export) -> Future[Document]:
        """Return the map as a document, now or in the past; it is checked and written in another thread."""
        if query.as_of is not None:
            return self._aside.submit(past_map.export_past, self._journal, self._past, query)
        return self._aside.submit(
            answers.export, answers.export_snapshot(self._map, query.inferred), query.format
        )

    def _seen(self, name: str) -> str:
        """Return when an entity of the map was last seen or placed, in words."""
        entity = self._map.find(name)
        return "" if entity is None else self.sightings.describe_present(entity).text.partition(";")[0]

    def on_understand(self, query: Understand) -> Understood | Future[Understood]:
        """Return the frames and steps of a command, or the answers to questions about the past."""
        language, asked = self._past_reader.read(query.text, query.language)
        if not asked:
            return self._parser.parse(query)
        timeline = self.past.timeline()
        return self._aside.submit(answer_questions, timeline, query.text, language, asked)

    def on_find(self, query: Find) -> Found | Future[Found]:
        """Return the entities that a description means.

        If there are none, also say when they were last there, unless the question is about the past.
        """
        if query.as_of is not None:
            labels, limits = self._search.terms(), self._map.classes.limits
            return self._aside.submit(find_past, query, self._past, labels, limits)
        with self.live.applied():
            sought = self._search.find(query)
        if sought.missing is None:
            return sought.found
        missing, there = sought.missing, frozenset(self._map.names)
        limits = self._map.classes.limits
        return self._aside.submit(
            lambda: sought.with_last_times(
                describe_missing(self._journal, self._past, missing, there, limits)
            )
        )

    def on_tell(self, query: Tell) -> Account | Future[Account]:
        """Return a description of the map, a place or an object, now or in the past."""
        if query.as_of is None:
            return self._descriptions.describe(query)
        return self._aside.submit(describe_past, query, self._past, self._descriptions.past_writer())

    def on_check(self, query: Check) -> Future[Checked]:
        """Check the consistency in another thread, and validate the facts in another process."""
        violations.require_size(query)
        self._map.derive_all()
        held, denied = self._map.reasoner.given_facts(), self._now.find_denied()
        withheld, crowds = tuple(answers.suppressed_facts(self._map)), self._map.places.crowds()
        names = violations.Names.of(self._map)

        def check() -> Checked:
            checked = answers.check(held.asserted, query.engine, self._is_over.is_set)
            checked = structs.replace(checked, denied=denied, withheld=withheld, crowds=crowds)
            return violations.with_validation(checked, self._validator, query, held, names)

        if query.engine == "owlrl":
            return self._second_opinions.submit(check)
        has_shapes = violations.may_have_shapes(query, self._map.reasoner)
        return (self._validations if has_shapes else self._aside).submit(check)

    def on_sparql(self, query: Sparql) -> Future[SparqlResult]:
        """Evaluate a query in another process."""
        if query.as_of is not None:
            return self._aside.submit(past_map.query_past, self._journal, self._past, query)
        return self._sparql.ask(query, self._map.seq, self._asker())

    def on_watch(self, query: Watch) -> Watching | Future[Watching]:
        """Start a standing query, by SPARQL or by location."""
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
        return self._location_queries.watch(query)

    def on_renew(self, renewal: Renew) -> Done | Future[Done]:
        """Renew or end a standing query."""
        return self._location_queries.renew(renewal) or self._sparql.ask(renewal, self._map.seq)

    def close(self) -> None:
        """Stop the threads, and write the end of the live poses."""
        self.trail.close()
        self._is_over.set()
        self._validator.close()
        self._second_opinions.close()
        self._validations.close()
        self._aside.close()
