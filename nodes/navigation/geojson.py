"""Plans as GeoJSON: one feature for each place, door and thing, in metres of the map frame.

RFC 7946 requires longitude and latitude, which are unknown without the map's position on Earth. The member
`coordinates` of the collection states the coordinate system.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from semmap.schemas.plans import Corners, Plan


def geojson(plan: Plan) -> str:
    """Return the document, with features by kind and name."""
    features = [
        *(
            _feature(
                place.name,
                place.rings,
                {
                    "kind": "place",
                    "class": place.class_,
                    "label": place.label,
                    "floor": place.floor,
                    "height": place.height,
                    "forbidden": place.forbidden,
                },
            )
            for place in plan.places
        ),
        *(
            _feature(
                thing.name,
                (thing.footprint,),
                {
                    "kind": "door" if thing.door else "thing",
                    "class": thing.class_,
                    "label": thing.label,
                    "bottom": min((part.low for part in thing.parts), default=None),
                    "top": max((part.high for part in thing.parts), default=None),
                    **({"open": thing.open, "connects": list(thing.connects)} if thing.door else {}),
                },
            )
            for thing in plan.things
            if len(thing.footprint) > 2
        ),
        *(
            _feature(f"wall_{k}", (wall.corners,), {"kind": "wall", "bottom": wall.low, "top": wall.high})
            for k, wall in enumerate(plan.walls, start=1)
        ),
    ]
    collection = {
        "type": "FeatureCollection",
        "coordinates": "x and y in metres of semmap's map frame",
        "features": features,
    }
    return json.dumps(collection, ensure_ascii=False, indent=1) + "\n"


def _feature(name: str, rings: Sequence[Corners], properties: dict[str, Any]) -> dict[str, Any]:
    closed = [[[round(x, 4), round(y, 4)] for x, y in (*ring, ring[0])] for ring in rings]
    geometry = {"type": "Polygon", "coordinates": closed}
    return {"type": "Feature", "id": name, "properties": {"name": name, **properties}, "geometry": geometry}
