"""The drawables of a tab, for its entities and the bodies of the scene at the moment shown."""

from __future__ import annotations

from collections.abc import Mapping

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.scene.assets import Assets
from semmap.nodes.extern.web.scene.drawables import Drawable, drawable_of
from semmap.schemas.scenes import Body


class TabDrawables:
    """Creates drawables, and keeps those whose entity, body and pose have not changed."""

    def __init__(self, page: Page, assets: Assets) -> None:
        self._page, self._assets = page, assets
        self._known: dict[str, tuple[tuple[object, ...], Drawable | None]] = {}
        self._bodies_of: tuple[object, dict[str, Body]] = (None, {})

    def clear(self) -> None:
        """Create all again next time, for example with other models."""
        self._known.clear()

    def bodies(self) -> Mapping[str, Body]:
        """Return the bodies at the moment shown, by name; there are none in the past."""
        return self._present_bodies() if self._page.moment.is_now else {}

    def _present_bodies(self) -> dict[str, Body]:
        scene = self._page.live.scene
        if self._bodies_of[0] is not scene:
            self._bodies_of = (scene, {body.name: body for body in scene.bodies} if scene else {})
        return self._bodies_of[1]

    def create(self) -> dict[str, Drawable]:
        """Return what is drawn at the moment shown, by name."""
        state, now, live = self._page.state, self._page.moment.is_now, self._page.live
        bodies, known = self.bodies(), self._known
        present = {} if now else self._present_bodies()
        wanted: dict[str, Drawable] = {}
        after: dict[str, tuple[tuple[object, ...], Drawable | None]] = {}
        for name in [*state.entities, *(name for name in bodies if name not in state.entities)]:
            entity, body, pose = state.entities.get(name), bodies.get(name), state.poses.get(name)
            joint_positions = live.joint_positions.get(name) if now else None
            before = known.get(name)
            inputs = (entity, body, pose, joint_positions, present.get(name))
            if before is not None and all(a is b for a, b in zip(before[0], inputs, strict=True)):
                thing = before[1]
            else:
                thing = drawable_of(
                    entity,
                    body,
                    pose,
                    self._assets.surface_of,
                    simulated=live.scene is not None,
                    past=not now,
                    joint_positions=joint_positions,
                    present=present.get(name),
                )
            after[name] = (inputs, thing)
            if thing is not None:
                wanted[name] = thing
        self._known = after
        return wanted
