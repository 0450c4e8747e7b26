"""What all tabs draw with: the surfaces of models and of the world, each asked for once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from semmap.nodes.drawing.articulation import JointPositions, articulated
from semmap.nodes.drawing.surfaces import Kind, SurfaceCache
from semmap.nodes.extern.web.live import Live
from semmap.nodes.extern.web.scene.meshes import glb
from semmap.nodes.extern.web.scene.shown import BOX, Key
from semmap.schemas import errors, keys
from semmap.schemas.entities import Size
from semmap.schemas.scenes import Scene, Surface, SurfaceQuery, WorldQuery

_AT_ONCE: Final = 50


class Assets:
    """Surfaces as the simulator tells them; `changed` is called when there are more."""

    def __init__(self, live: Live, changed: Callable[[], None]) -> None:
        self._live = live
        self._changed = changed
        self._surfaces = SurfaceCache()
        self._glbs: dict[Key, bytes] = {}
        self._run = ""
        self._fetched: Scene | None = None
        self.walls: Surface | None = None

    def surface_of(self, model: str, size_m: Size, bends: JointPositions = ()) -> Surface | None:
        """What a model looks like at a size, with its joints moved, if that is known."""
        surface = None if model == BOX else self._surfaces.of_kind(model, size_m)
        return surface if surface is None else articulated(surface, bends)

    def glb(self, key: Key) -> bytes:
        """The glTF file of a model at a size and with a look; it must be known."""
        if (known := self._glbs.get(key)) is not None:
            return known
        look, model, size_m, bends = key
        surface = self.surface_of(model, size_m, bends)
        if surface is None:
            raise errors.InternalError(f"the model '{model}' is unknown")
        made = glb(surface, look)
        if not bends:  # ways to stand open are many
            self._glbs[key] = made
        return made

    async def fetch(self) -> None:
        """Ask what bodies look like, as far as that was never told, and the world if it is another one."""
        while (scene := self._live.scene) is not self._fetched:
            await self._fetch(scene)
            self._fetched = scene

    async def _fetch(self, scene: Scene | None) -> None:
        if scene is None:
            return
        wanted = list(self._surfaces.wanted(scene.bodies).items())
        news = bool(wanted)
        for start in range(0, len(wanted), _AT_ONCE):
            await self._fetch_some(dict(wanted[start : start + _AT_ONCE]))
        if scene.run != self._run:
            self._run, news = scene.run, True
            try:
                self.walls = await self._live.query(keys.SIM, WorldQuery())
            except errors.SemmapError:  # an older simulator, or one that this role may not ask
                self.walls = None
        if news:
            self._changed()

    async def _fetch_some(self, kinds: dict[str, Kind]) -> None:
        try:
            told = await self._live.query(keys.SIM, SurfaceQuery(names=tuple(kinds)))
        except errors.SemmapError:
            self._surfaces.reset_requests(kinds.values())
            return
        for name, surface in told.surfaces.items():
            self._surfaces.take(kinds[name], surface)
