"""What is drawn now. Told what is, it records only what differs from what was."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from nodes.recorder.figures import Figure, figure_of, pose_of, still
from nodes.recorder.map_state import MapState, Relation
from nodes.recorder.recording import Recording
from schemas.entities import Entity, Pose
from schemas.scenes import Body


class Stage:
    """The figures, their poses and the knowledge graph as last recorded."""

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self._figures: dict[str, Figure] = {}
        self._poses: dict[str, Pose] = {}
        self._nodes: dict[str, tuple[str, tuple[Relation, ...]]] = {}

    def show(
        self,
        names: Iterable[str],
        entities: Mapping[str, Entity],
        bodies: Mapping[str, Body],
        *,
        simulated: bool,
    ) -> None:
        """Draw these names as the map and the scene have them, and erase those that are in neither."""
        for name in names:
            entity, body = entities.get(name), bodies.get(name)
            pose = pose_of(entity, body)
            figure = figure_of(entity, body, simulated=simulated) if pose is not None else None
            self._set_figure(name, figure)
            if pose is not None:
                self.move(name, pose)

    def show_all(
        self, entities: Mapping[str, Entity], bodies: Mapping[str, Body], *, simulated: bool
    ) -> None:
        """Draw everything."""
        names = self._figures.keys() | entities.keys() | bodies.keys()
        self.show(sorted(names), entities, bodies, simulated=simulated)

    def move(self, name: str, pose: Pose) -> None:
        """Put what is drawn somewhere else, if it is not there already."""
        figure = self._figures.get(name)
        if figure is not None and not still(self._poses.get(name), pose):
            self._poses[name] = pose
            self._recording.pose(name, figure, pose)

    def show_graph(self, state: MapState) -> None:
        """Draw the knowledge graph."""
        relations = state.relations()
        nodes = {name: (entity.class_, relations[name]) for name, entity in state.entities.items()}
        for name in sorted(self._nodes.keys() - nodes.keys()):
            self._recording.forget_node(name)
        for name, node in nodes.items():
            if self._nodes.get(name) != node:
                self._recording.node(name, *node)
        self._nodes = nodes

    @property
    def poses(self) -> Iterable[Pose]:
        """Where everything that is drawn stands."""
        return self._poses.values()

    def _set_figure(self, name: str, figure: Figure | None) -> None:
        before = self._figures.get(name)
        if figure == before:
            return
        if before is not None and (figure is None or figure.group != before.group):
            self._recording.erase(name, before)
            del self._figures[name], self._poses[name]
        if figure is not None:
            self._figures[name] = figure
            self._recording.shape(name, figure)
