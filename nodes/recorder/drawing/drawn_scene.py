"""The drawn scene: only changes are recorded."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from semmap.nodes.drawing.figures import Figure, figure_of, is_still, pose_of
from semmap.nodes.drawing.neighbourhood import Neighbourhood
from semmap.nodes.drawing.surfaces import SurfaceCache
from semmap.nodes.recorder.drawing.geometry import drawn_surface_of
from semmap.nodes.recorder.recording import Recording
from semmap.schemas.entities import Entity, Pose
from semmap.schemas.scenes import Body

Drawn = tuple[Figure, Pose]


class DrawnScene:
    """The figures, their poses, and the knowledge graph as last recorded."""

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self.surfaces = SurfaceCache()
        self._drawn: dict[str, Drawn] = {}
        self._graph = Neighbourhood()

    def show(
        self,
        names: Iterable[str],
        entities: Mapping[str, Entity],
        bodies: Mapping[str, Body],
        *,
        simulated: bool,
    ) -> None:
        """Draw these names as they are in map and scene, and erase those in neither."""
        for name in names:
            entity, body = entities.get(name), bodies.get(name)
            pose = pose_of(entity, body)
            figure = figure_of(entity, body, simulated=simulated, surface=self.surfaces.of(body))
            self._set(name, None if pose is None or figure is None else (figure, pose))

    def show_all(
        self, entities: Mapping[str, Entity], bodies: Mapping[str, Body], *, simulated: bool
    ) -> None:
        """Draw everything."""
        names = self._drawn.keys() | entities.keys() | bodies.keys()
        self.show(sorted(names), entities, bodies, simulated=simulated)

    def move(self, name: str, pose: Pose) -> None:
        """Move a figure, if it is drawn and its pose differs."""
        if name in self._drawn:
            self._set(name, (self._drawn[name][0], pose))

    def show_graph(self, graph: Neighbourhood) -> None:
        """Draw the knowledge graph, if it changed."""
        if graph != self._graph:
            self._graph = graph
            self._recording.graph(graph)

    @property
    def poses(self) -> Iterable[Pose]:
        """Return the poses of all figures."""
        return [pose for _, pose in self._drawn.values()]

    def _set(self, name: str, now: Drawn | None) -> None:
        before = self._drawn.get(name)
        if before is not None and (now is None or now[0].group != before[0].group):
            self._recording.erase(name, before[0])
            del self._drawn[name]
        if now is None:
            return
        if before is None:
            self._recording.draw(name, *now)
        elif before[0] != now[0]:
            now = self._redraw(name, before, now)
        elif is_still(before[1], now[1]):
            return
        else:
            self._recording.move(name, *now)
        self._drawn[name] = now

    def _redraw(self, name: str, before: Drawn, now: Drawn) -> Drawn:
        """Draw a figure that has changed, and return it with its recorded pose.

        If only joints have moved, its surface is not recorded again.
        """
        if replace(before[0], joint_positions=now[0].joint_positions) == now[0]:
            self._recording.bend(name, now[0])
            if is_still(before[1], now[1]):
                return now[0], before[1]
            self._recording.move(name, *now)
            return now
        if drawn_surface_of(before[0]) not in (None, drawn_surface_of(now[0])):  # parts may be missing now
            self._recording.erase(name, before[0])
        self._recording.draw(name, *now)
        return now
