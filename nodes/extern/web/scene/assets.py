"""The surfaces of models and of the world, requested once for all tabs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from semmap.nodes.drawing.articulation import JointPositions, articulated
from semmap.nodes.drawing.surfaces import Kind, SurfaceCache
from semmap.nodes.extern.web.live import Live
from semmap.nodes.extern.web.scene.drawables import BOX, Key
from semmap.nodes.extern.web.scene.meshes import glb
from semmap.schemas import errors, keys
from semmap.schemas.entities import Size
from semmap.schemas.scenes import Scene, Surface, SurfaceQuery, WorldQuery

_PER_REQUEST: Final = 50


class Assets:
    """The surfaces from the simulator; `changed` is called when new ones have arrived."""

    def __init__(self, live: Live, changed: Callable[[], None]) -> None:
        self._live = live
        self._changed = changed
        self._surfaces = SurfaceCache()
        self._glbs: dict[Key, bytes] = {}
        self._run = ""
        self._fetched: Scene | None = None
        self.walls: Surface | None = None

    def surface_of(self, model: str, size_m: Size, joint_positions: JointPositions = ()) -> Surface | None:
        """Return the surface of a model at a size and with its joints moved; None if it is not known."""
        surface = None if model == BOX else self._surfaces.of_kind(model, size_m)
        return surface if surface is None else articulated(surface, joint_positions)

    def glb(self, key: Key) -> bytes:
        """Return the glTF file of a model, whose surface must be known, at a size and with an appearance."""
        if (known := self._glbs.get(key)) is not None:
            return known
        appearance, model, size_m, joint_positions = key
        surface = self.surface_of(model, size_m, joint_positions)
        if surface is None:
            raise errors.InternalError(f"unknown model '{model}'")
        made = glb(surface, appearance)
        if not joint_positions:  # there are too many joint positions to cache
            self._glbs[key] = made
        return made

    async def fetch(self) -> None:
        """Request the surfaces that are not known, and those of the world if the simulator is another one."""
        while (scene := self._live.scene) is not self._fetched:
            await self._fetch(scene)
            self._fetched = scene

    async def _fetch(self, scene: Scene | None) -> None:
        if scene is None:
            return
        wanted = list(self._surfaces.wanted(scene.bodies).items())
        is_changed = bool(wanted)
        for start in range(0, len(wanted), _PER_REQUEST):
            await self._fetch_some(dict(wanted[start : start + _PER_REQUEST]))
        if scene.run != self._run:
            self._run, is_changed = scene.run, True
            try:
                self.walls = await self._live.query(keys.SIM, WorldQuery())
            except errors.SemmapError:  # an older simulator, or not permitted for this role
                self.walls = None
        if is_changed:
            self._changed()

    async def _fetch_some(self, kinds: dict[str, Kind]) -> None:
        try:
            reply = await self._live.query(keys.SIM, SurfaceQuery(names=tuple(kinds)))
        except errors.SemmapError:
            self._surfaces.reset_requests(kinds.values())
            return
        for name, surface in reply.surfaces.items():
            self._surfaces.take(kinds[name], surface)
