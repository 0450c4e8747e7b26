"""Stability of relations at rest: noisy cameras, the whole of perception, and a map.

Twenty things stand on a table that two cameras see from opposite corners. Perception tells a map what it
sees, and the relations of the map are kept as after each commit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from msgspec import structs

from benchmarks.perception.tracking import CAMERAS, TABLE_M, ObedientMap, things_on_a_table
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.pipeline import observe_clouds, shipped
from semmap.nodes.perception_node.tracking.association import associate
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.training.scenes.simulated_scenes import Item, Stage
from semmap.nodes.training.taxonomy import class_of_models
from semmap.schemas.entities import Entity, Pose, Provenance

LOOKS_A_SECOND = 2
"""Observations per second; an idle machine processes five."""
_SETTLING = 15
"""The number of observations until the map is complete."""


class Watched(NamedTuple):
    """The changes of the relations of `things` at rest on a table."""

    things: int
    on_the_table: int
    """The number of entities at the end."""
    changes: int
    """The number of relations that appeared or disappeared after the first observations."""
    updates: int
    """The number of map updates by perception then."""


def at_rest(seconds: float, things: int = 20, seed: int = 11) -> Watched:
    """Observe things at rest for a duration."""
    rng, stage, learnt = np.random.default_rng(seed), Stage(), shipped()
    classes = ClassHierarchy(
        {n: frozenset(above) for n, above in learnt.ancestors.items()}, {}, learnt.usual_m
    )
    models = {class_name: model for model, class_name in class_of_models(MODELS).items()}
    items = things_on_a_table(things, rng)
    bodies = stage.show([Item("table", "table", TABLE_M, (0.6, 0.5, 0.4), (0.0, 0.0, 0.0), 0.0), *items])
    known, tracks, facts = ObedientMap(), Tracks(), Facts()
    known.entities["table"] = _table()
    facts.update(known.entities.values())
    changes = updates = 0
    for number in range(_SETTLING + round(seconds * LOOKS_A_SECOND)):
        clouds = stage.shoot(bodies, CAMERAS, rng).clouds
        seen = observe_clouds(clouds, learnt).observations.observations
        told = associate(known.entities, tracks, seen, occupancy_in(clouds), classes, TrackingConfig())
        tracks, before = told.tracks, dict(known.entities)
        for command in told.commands:
            known.obey(command)
        changed = [
            structs.replace(entity, model=models.get(entity.class_, ""))
            for name, entity in known.entities.items()
            if entity is not before.get(name)
        ]
        made = facts.update(changed, before.keys() - known.entities.keys())
        if number >= _SETTLING:
            changes += len(made.gone) + len(made.come)
            updates += len(told.commands)
    on = {name for name, relation, other in facts if (relation, other) == ("isOn", "table")}
    return Watched(things, sum(known.at(*i.position_m[:2]) in on for i in items), changes, updates)


def _table() -> Entity:
    said = Provenance(commit=1, stamp_ns=0, source="operator")
    return Entity(
        name="table", class_="Table", iri="urn:table", types=("Table",), size_m=TABLE_M, model="table",
        pose=Pose(position_m=(0.0, 0.0, 0.0)), provenance=said, pose_provenance=said,
        shape_provenance=said, reference_provenance=said,
    )  # fmt: skip
