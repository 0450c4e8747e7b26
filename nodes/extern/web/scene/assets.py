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

    async def fetch(self) -> bool:
        """Request the surfaces that are not known, and those of the world if the simulator is another one.

        Return whether all have arrived; otherwise they can be requested again.
        """
        while (scene := self._live.scene) is not self._fetched:
            if not await self._fetch(scene):
                return False
            self._fetched = scene
        return True

    async def _fetch(self, scene: Scene | None) -> bool:
        if scene is None:
            return True
        wanted = list(self._surfaces.wanted(scene.bodies).items())
        is_changed, is_complete = bool(wanted), True
        for start in range(0, len(wanted), _PER_REQUEST):
            is_complete &= await self._fetch_some(dict(wanted[start : start + _PER_REQUEST]))
        if scene.run != self._run:
            before, self.walls = self.walls, None
            try:
                self.walls = await self._live.query(keys.SIM, WorldQuery())
                self._run = scene.run
            except errors.NoAnswer:
                is_complete = False
            except errors.SemmapError:  # an older simulator, or not permitted for this role
                self._run = scene.run
            is_changed |= self.walls is not before
        if is_changed:
            self._changed()
        return is_complete

    async def _fetch_some(self, kinds: dict[str, Kind]) -> bool:
        try:
            reply = await self._live.query(keys.SIM, SurfaceQuery(names=tuple(kinds)))
        except errors.SemmapError as error:
            self._surfaces.reset_requests(kinds.values())
            return not isinstance(error, errors.NoAnswer)
        return self._surfaces.take_reply(kinds, reply.surfaces)
