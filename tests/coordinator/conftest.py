"""A dispatcher with a real knowledge base, without Zenoh."""

from __future__ import annotations

from concurrent.futures import Future
from pathlib import Path

import pytest

from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.kb_node.answers import answers as kb_answers
from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.answers.pages import Pages
from semmap.nodes.kb_node.handlers.changes import effects
from semmap.nodes.kb_node.relations.free_room import find_room
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.undo import undo
from semmap.nodes.runtime.class_names import ClassNames
from semmap.nodes.runtime.futures import settle
from semmap.schemas import errors
from semmap.schemas.bridge import Outcome
from tests.kb_node.handlers.test_loading import loading

TBOX = """
@prefix : <http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix xsd: <http://www.w3.org/2001/XMLSchema#> .
:Physical_Thing a owl:Class . :Property a owl:Class .
:Location a owl:Class ; rdfs:subClassOf :Physical_Thing ; owl:disjointWith :Object .
:Kitchen a owl:Class ; rdfs:subClassOf :Location .
:Object a owl:Class ; rdfs:subClassOf :Physical_Thing .
:Furniture a owl:Class ; rdfs:subClassOf :Object .
:Chair a owl:Class ; rdfs:subClassOf :Furniture , [ owl:onProperty :fits ; owl:hasValue :kitchen ] ;
  rdfs:label "chair"@en .
:fits a owl:ObjectProperty .
:Living_Room_Table a owl:Class ; rdfs:subClassOf :Furniture .
:Color a owl:Class ; rdfs:subClassOf :Property .
:Coordinates a owl:Class ; rdfs:subClassOf :Property .
:hasPosition a owl:ObjectProperty , owl:FunctionalProperty ;
  rdfs:domain :Physical_Thing ; rdfs:range :Coordinates .
:isDirectPartOf a owl:ObjectProperty .
:isGraspedBy a owl:ObjectProperty , owl:FunctionalProperty ; owl:inverseOf :grasps ;
  rdfs:label "è tenuto da"@it .
:grasps a owl:ObjectProperty .
:isSwitchedOn a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:range xsd:boolean .
:isOpen a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:range xsd:boolean .
:openness a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:range xsd:float .
:jointPositions a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:range xsd:string .
:note a owl:DatatypeProperty .
:float_coordinates_x a owl:DatatypeProperty , owl:FunctionalProperty ; rdfs:range xsd:float .
""".encode()


@pytest.fixture
def semantic_map(tmp_path: Path):
    journal = Journal.create(tmp_path / "journal.sqlite", TBOX)
    yield SemanticMap(journal)
    journal.close()


@pytest.fixture
def dispatcher(semantic_map):
    return new_dispatcher(semantic_map)


def new_dispatcher(semantic_map):
    """Return a dispatcher whose knowledge base is this map."""
    answers = {
        "commit": lambda transaction: _changed(
            semantic_map, lambda: semantic_map.commit(transaction), transaction.dry_run
        ),
        "load": lambda load: _result(loading(semantic_map, []).on_load(load)),
        "classes": lambda _: tuple(semantic_map.class_table()),
        "snapshot": Pages(semantic_map).snapshot,
        "commits": lambda several: tuple(
            Outcome(error=errors.to_message(result))
            if isinstance(result, errors.SemmapError)
            else Outcome(commit=effects(result))
            for result in semantic_map.commit_together(several.transactions)
        ),
        "find-room": lambda query: find_room(
            semantic_map.places.space(), query, semantic_map.find(query.name)
        ),
        "get": CurrentState(semantic_map).entity,
        "infer": lambda query: kb_answers.infer(semantic_map, query.name),
        "properties": lambda _: tuple(semantic_map.classes.property_table.rows()),
        "made-by": lambda query: tuple(effects(semantic_map._journal.commit_of(i)) for i in query.ids),
        "undo": lambda command: _changed(
            semantic_map, lambda: undo(semantic_map, semantic_map._journal, command), command.dry_run
        ),
    }
    dispatcher = CommandDispatcher(lambda call: answers[call.VERB](call))
    dispatcher.map.classes = ClassNames(semantic_map.class_table())
    dispatcher.map.begin(semantic_map.snapshot())
    return dispatcher


def immediate(dispatcher):
    """Return `change(change)` of a dispatcher, executed immediately."""

    def change(change):
        future = Future()
        settle(future, lambda: dispatcher.change(change))
        return future

    return change


def _result(loaded):
    return loaded.result(60) if isinstance(loaded, Future) else loaded


def _changed(semantic_map, change, dry_run):
    return dry_runs.dry_run(semantic_map, change) if dry_run else effects(change())
