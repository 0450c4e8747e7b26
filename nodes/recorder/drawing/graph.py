"""The knowledge graph as Rerun archetypes: the neighbourhood of the entities of the last commit."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Final

import rerun as rr

from semmap.nodes.drawing.neighbourhood import GraphEdge, GraphNode, Neighbourhood, around, by_place
from semmap.nodes.drawing.palette import GREY, colour_of
from semmap.schemas.entities import Entity

MANY: Final = 12
"""A commit of more entities is shown by places, with the number of things in each."""

Relation = tuple[str, str]
_RADII: Final = {"centre": 9.0, "entity": 5.0, "place": 6.0, "class": 4.0, "more": 3.0}
_RELATION_RADIUS: Final = 1.0
_FEW_LINKS: Final = 14


def graph_of(
    entities: Mapping[str, Entity],
    relations: Mapping[str, tuple[Relation, ...]],
    touched: Collection[str] = (),
) -> Neighbourhood:
    """Return the neighbourhood of the touched entities, or a graph by places for none or very many."""
    here = [name for name in sorted(touched) if name in entities]
    return around(here, entities, relations) if 0 < len(here) <= MANY else by_place(entities, relations)


def nodes_and_edges(graph: Neighbourhood) -> tuple[rr.GraphNodes, rr.GraphEdges]:
    """Convert the graph to Rerun. Its edges have no labels, so each label is a small node on its edge.

    In a graph with many edges, the labels would hide the nodes and are omitted.
    """
    labelled = [link for link in graph.links if link.label] if len(graph.links) <= _FEW_LINKS else []
    nodes = rr.GraphNodes(
        [*(knot.id for knot in graph.knots), *map(_relation_id, labelled)],
        labels=[*(knot.label for knot in graph.knots), *(link.label for link in labelled)],
        colors=[*map(_colour, graph.knots), *(GREY for _ in labelled)],
        radii=[*(_RADII[knot.kind] for knot in graph.knots), *(_RELATION_RADIUS for _ in labelled)],
    )
    edges = [pair for link in graph.links for pair in (_pairs(link) if labelled else (link[:2],))]
    return nodes, rr.GraphEdges(edges, graph_type="directed")


def _pairs(link: GraphEdge) -> tuple[tuple[str, str], ...]:
    if not link.label:
        return ((link.source, link.target),)
    return ((link.source, _relation_id(link)), (_relation_id(link), link.target))


def _relation_id(link: GraphEdge) -> str:
    """Return an id that no entity has, since names contain no spaces."""
    return f"{link.source} {link.label} {link.target}"


def _colour(knot: GraphNode) -> tuple[int, int, int]:
    return colour_of(knot.class_) if knot.class_ else GREY
