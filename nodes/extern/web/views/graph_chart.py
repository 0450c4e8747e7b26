"""A part of the knowledge graph as options of ECharts and as rows of a table."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Final, get_args

from semmap.nodes.drawing.neighbourhood import GraphNode, Kind, Neighbourhood
from semmap.nodes.drawing.palette import GREY, colour_of
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Entity
from semmap.schemas.map_history import KeptRelation
from semmap.schemas.sparql import Row

Relations = dict[str, tuple[tuple[str, str], ...]]

_SIZES: Final[dict[Kind, int]] = {"centre": 24, "entity": 14, "place": 18, "class": 12, "more": 12}
_SYMBOLS: Final[dict[Kind, str]] = {
    "centre": "circle", "entity": "circle", "place": "roundRect", "class": "diamond", "more": "rect"
}  # fmt: skip
_LONGEST: Final = 28
_TEXT: Final = "#8b949e"
_EDGE: Final = "rgba(139,148,158,.55)"
FEW_LINKS: Final = 30
"""Up to this number, links have labels; otherwise a label is shown on hover."""
FEW_ON_PHONES: Final = 12

QUERY: Final = (
    "SELECT ?s ?p ?o WHERE { VALUES ?p { "
    + " ".join(v.dm(name) for name in get_args(KeptRelation))
    + " } ?s ?p ?o }"
)
"""The relations that are computed at every commit."""


def relations_of(entities: Mapping[str, Entity], rows: Iterable[Row]) -> Relations:
    """Return the relations between entities: those asserted, and the rows of `QUERY`."""
    found: dict[str, set[tuple[str, str]]] = {}
    for name, entity in entities.items():
        for property_, stated in entity.properties.items():
            for value in stated if isinstance(stated, tuple) else (stated,):
                if isinstance(value, str) and value in entities:
                    found.setdefault(name, set()).add((property_, value))
    for row in rows:
        if len(row) == 3 and None not in row:
            subject, property_, other = (v.entity_name(term) for term in row if term is not None)
            if subject in entities and other in entities and subject != other:
                found.setdefault(subject, set()).add((property_, other))
    return {name: tuple(sorted(related)) for name, related in found.items()}


def chart_options(
    graph: Neighbourhood,
    at: Mapping[str, tuple[float, float]],
    selected: Collection[str],
    *,
    few_links: int = FEW_LINKS,
) -> dict[str, Any]:
    """Return the options of ECharts. Names are values, so ECharts draws them as text."""
    few = len(graph.links) <= few_links
    return {
        "animationDurationUpdate": 500,
        "animationEasingUpdate": "cubicInOut",
        "tooltip": {"show": False},
        "series": [
            {
                "type": "graph",
                "layout": "none",
                "roam": True,
                "edgeSymbol": ["none", "arrow"],
                "edgeSymbolSize": 7,
                "lineStyle": {"color": _EDGE, "width": 1.2, "opacity": 1, "curveness": 0.06},
                "edgeLabel": {"show": few, "fontSize": 10, "color": _TEXT},
                "emphasis": {"focus": "adjacency", "edgeLabel": {"show": True}},
                "data": [
                    _node(knot, at.get(knot.id, (0.0, 0.0)), knot.id in selected) for knot in graph.knots
                ],
                "links": [
                    {
                        "source": link.source,
                        "target": link.target,
                        "value": link.label,
                        "label": {"formatter": "{c}"},
                    }
                    for link in graph.links
                ],
            }
        ],
    }


def _node(knot: GraphNode, at: tuple[float, float], is_selected: bool) -> dict[str, Any]:
    red, green, blue = colour_of(knot.class_) if knot.class_ else GREY
    label = knot.label if len(knot.label) <= _LONGEST else f"{knot.label[: _LONGEST - 1]}…"
    border = {"borderColor": "#2f81f7", "borderWidth": 3} if is_selected else {}
    return {
        "id": knot.id,
        "name": label,
        "x": at[0],
        "y": at[1],
        "symbol": _SYMBOLS[knot.kind],
        "symbolSize": _SIZES[knot.kind],
        "itemStyle": {"color": f"rgb({red},{green},{blue})", **border},
        "label": {
            "show": True,
            "position": "bottom",
            "color": _TEXT,
            "fontSize": 13 if knot.kind == "centre" else 11,
            "fontWeight": "bold" if knot.kind == "centre" else "normal",
            "fontStyle": "italic" if knot.kind in ("class", "more") else "normal",
        },
    }


def rows_of(graph: Neighbourhood, entities: Collection[str]) -> list[dict[str, Any]]:
    """Return the links as rows with source, label and target."""
    labels = {knot.id: knot.label for knot in graph.knots}
    return [
        {
            "id": i,
            "source": labels.get(link.source, link.source),
            "label": link.label,
            "target": labels.get(link.target, link.target),
            "names": [name for name in (link.source, link.target) if name in entities],
        }
        for i, link in enumerate(graph.links)
    ]
