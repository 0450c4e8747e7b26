"""The knowledge graph: entities, their classes, and the relations between entities."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import rerun as rr

from nodes.drawing.palette import colour_of
from nodes.recorder.state.map_relations import Relation
from schemas.entities import Entity

LIMIT = 400
"""Entities that are drawn; a force layout of more is neither legible nor quick."""

_ENTITY_RADIUS, _CLASS_RADIUS = 5.0, 9.0


class Graph(NamedTuple):
    """`classes`: each entity's class by its name. `edges`: pairs of names that are related."""

    classes: dict[str, str]
    edges: tuple[tuple[str, str], ...]


def graph_of(entities: Mapping[str, Entity], relations: Mapping[str, tuple[Relation, ...]]) -> Graph:
    """The graph of a map, of its first `LIMIT` entities if it has more."""
    classes = {name: entity.class_ for name, entity in sorted(entities.items())[:LIMIT]}
    pairs = {(name, other) for name in classes for _, other in relations.get(name, ()) if other in classes}
    return Graph(classes, tuple(sorted(pairs)))


def nodes_and_edges(graph: Graph) -> tuple[rr.GraphNodes, rr.GraphEdges]:
    """The graph in Rerun's terms: an entity has the colour of its class and an edge to it."""
    names, classes = list(graph.classes), sorted(set(graph.classes.values()))
    nodes = rr.GraphNodes(
        [*names, *map(_class_id, classes)],
        labels=[*names, *classes],
        colors=[colour_of(class_) for class_ in (*graph.classes.values(), *classes)],
        radii=[_ENTITY_RADIUS] * len(names) + [_CLASS_RADIUS] * len(classes),
    )
    kinds = [(name, _class_id(class_)) for name, class_ in graph.classes.items()]
    return nodes, rr.GraphEdges([*kinds, *graph.edges], graph_type="directed")


def _class_id(class_: str) -> str:
    """No name of an entity holds a colon."""
    return f"class:{class_}"
