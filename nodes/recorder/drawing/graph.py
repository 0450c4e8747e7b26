"""The knowledge graph in Rerun's terms: the neighbourhood of what the last commit touched."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Final

import rerun as rr

from semmap.nodes.drawing.neighbourhood import GraphEdge, GraphNode, Neighbourhood, around, by_place
from semmap.nodes.drawing.palette import GREY, colour_of
from semmap.schemas.entities import Entity

MANY: Final = 12
"""A commit that touches more entities is shown by places, with the number of things in each."""

Relation = tuple[str, str]
_RADII: Final = {"centre": 9.0, "entity": 5.0, "place": 6.0, "class": 4.0, "more": 3.0}
_RELATION_RADIUS: Final = 1.0
_FEW_LINKS: Final = 14


def graph_of(
    entities: Mapping[str, Entity],
    relations: Mapping[str, tuple[Relation, ...]],
    touched: Collection[str] = (),
) -> Neighbourhood:
    """The neighbourhood of what was touched; by places where that is nothing, or very many."""
    here = [name for name in sorted(touched) if name in entities]
    return around(here, entities, relations) if 0 < len(here) <= MANY else by_place(entities, relations)


def nodes_and_edges(graph: Neighbourhood) -> tuple[rr.GraphNodes, rr.GraphEdges]:
    """The graph in Rerun's terms. An edge has no label there, so that what it says is a small node on it.

    Of a graph with many edges, those would hide what they join, so that they are left out.
    """
    said = [link for link in graph.links if link.label] if len(graph.links) <= _FEW_LINKS else []
    nodes = rr.GraphNodes(
        [*(knot.id for knot in graph.knots), *map(_relation_id, said)],
        labels=[*(knot.label for knot in graph.knots), *(link.label for link in said)],
        colors=[*map(_colour, graph.knots), *(GREY for _ in said)],
        radii=[*(_RADII[knot.kind] for knot in graph.knots), *(_RELATION_RADIUS for _ in said)],
    )
    edges = [pair for link in graph.links for pair in (_pairs(link) if said else (link[:2],))]
    return nodes, rr.GraphEdges(edges, graph_type="directed")


def _pairs(link: GraphEdge) -> tuple[tuple[str, str], ...]:
    if not link.label:
        return ((link.source, link.target),)
    return ((link.source, _relation_id(link)), (_relation_id(link), link.target))


def _relation_id(link: GraphEdge) -> str:
    """No name of an entity holds a space."""
    return f"{link.source} {link.label} {link.target}"


def _colour(knot: GraphNode) -> tuple[int, int, int]:
    return colour_of(knot.class_) if knot.class_ else GREY
