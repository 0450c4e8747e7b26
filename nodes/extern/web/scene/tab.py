"""The scene of one tab: drawing, selection and picking."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
from msgspec import structs
from viser import CameraHandle, ClientHandle

from semmap.nodes.extern.web.differences import Mark
from semmap.nodes.extern.web.page import Page, Place
from semmap.nodes.extern.web.scene.annotations import (
    Labels,
    LabelText,
    Lines,
    Rgb,
    dashed_line,
    join_segments,
)
from semmap.nodes.extern.web.scene.assets import Assets
from semmap.nodes.extern.web.scene.bodies import Bodies
from semmap.nodes.extern.web.scene.camera import FOV_RAD, View, extent, first_view, fit_view, select_labels
from semmap.nodes.extern.web.scene.dragging import Dragging
from semmap.nodes.extern.web.scene.drawables import BOX, Drawable, Key, label_of, middle_of, top_of
from semmap.nodes.extern.web.scene.gizmo import Gizmo, Phase
from semmap.nodes.extern.web.scene.map_overlay import difference_boxes, path_lines
from semmap.nodes.extern.web.scene.picking import Solid, corners_of, edges_of, first_hit
from semmap.nodes.extern.web.scene.relation_overlay import RelationOverlay
from semmap.nodes.extern.web.scene.rooms import Rooms
from semmap.nodes.extern.web.scene.sensor_overlay import SensorOverlay
from semmap.nodes.extern.web.scene.switches import SWITCHED_ON, Switch
from semmap.nodes.extern.web.scene.tab_drawables import TabDrawables
from semmap.schemas import errors
from semmap.schemas.entities import Pose, Size, Vector
from semmap.schemas.relations import ViewPoint

_SELECTED: Final[Rgb] = (255, 120, 0)
_BOX: Final[Rgb] = (120, 130, 150)
_PATH: Final[Rgb] = (15, 118, 110)
_CHANGED: Final[dict[Mark, Rgb]] = {
    "added": (0, 150, 70),
    "removed": (215, 40, 40),
    "moved": (130, 60, 200),
    "changed": (0, 140, 150),
}
_SKY: Final[Rgb] = (255, 255, 255)
_GROUND: Final[Rgb] = (190, 180, 170)
_LABELS_S: Final = 0.25
_DRAW_DELAY_S: Final = 0.03
"""Delay of the scene after a change, so that the panels, which are faster, are drawn first."""
_MODIFIERS: Final = (None, "shift", "cmd/ctrl", "cmd/ctrl+shift")
_MARKED: Final = "changed "
"""Prefix of the keys of labels for differences."""
_NAMED: Final = 50
"""Number of selected entities whose names are always shown."""


class TabScene:
    """The scene of one tab.

    It is used on the event loop of the page, to which the thread of viser posts calls.
    """

    def __init__(self, page: Page, assets: Assets, is_open: Callable[[int], bool]) -> None:
        """`is_open(client_id)` returns whether a viser client is connected, on any thread."""
        self.page = page
        self.on: set[Switch] = set(SWITCHED_ON)
        self._assets = assets
        self._is_open = is_open
        self._loop = asyncio.get_running_loop()
        self._client: ClientHandle | None = None
        self._things: dict[str, Drawable] = {}
        self._drawables = TabDrawables(page, assets)
        self._marked: dict[str, LabelText] = {}
        """Labels of entities that differ from the moment compared with, by name."""
        self._picking: asyncio.Future[Place | None] | None = None
        self._labelling: asyncio.TimerHandle | None = None
        self._drawing: asyncio.TimerHandle | None = None
        self._is_stale = False
        """Whether something has changed while the scene was hidden."""
        self.is_in_view: Callable[[], bool] = lambda: True
        """Returns whether the scene is visible; set by the code that creates its frame."""
        self.on_first_drawing: Callable[[], object] = lambda: None
        """Called when the bodies have been sent to the frame; set by the code that creates it."""
        self._camera: tuple[Any, ...] | None = None
        """The last camera of this tab, for a frame that reconnects."""
        page.on_change(self._draw_soon)
        page.on_tab_change(self._on_tab_change)
        page.on_poses(self._on_poses)
        page.on_select(self._on_select)
        page.on_appearance_change(self._on_appearance_change)
        page.on_drives(self._on_drives)
        page.on_key("f", self.show_selected)
        page.pick, page.get_viewpoint, page.cancel_interaction, page.preview = (
            self.pick_place,
            self.viewpoint,
            self.cancel_interaction,
            self.preview,
        )

    # Connection of the frame

    def attach(self, client: ClientHandle) -> None:
        """Draw everything in a frame that has connected."""
        if self._client is not None:
            self._relations.close()
            self._dragging.close()
        self._client, scene = client, client.scene
        scene.configure_default_lights(cast_shadow=False)
        scene.configure_environment_map(None)
        scene.add_light_hemisphere("/sky", sky_color=_SKY, ground_color=_GROUND, intensity=1.6)
        self._bodies = Bodies(scene, self._glb_of)
        self._rooms = Rooms(scene)
        self._labels = Labels(scene, "/names", depth_test=False)
        self._strong_labels = Labels(scene, "/selected/names", scale=1.15)
        self._outlines = Lines(scene, "/selected/outlines", width=3.5)
        self._boxes = Lines(scene, "/boxes", width=1.0)
        self._differences = Lines(scene, "/differences/lines", width=2.5)
        self._paths = Lines(scene, "/drives", width=3.0)
        self._difference_labels = Labels(scene, "/differences/names")
        self._dragging: Dragging = Dragging(
            self.page,
            Gizmo(scene, self._on_loop(self._on_drag), lambda: self._is_open(client.client_id)),
            Bodies(scene, self._glb_of, "/dragged"),
            self._drawables.bodies,
            lambda: self._things,
            self._solids,
            self._draw,
        )
        self._sensors = SensorOverlay(scene, self.page.live)
        self._relations: RelationOverlay = RelationOverlay(
            scene, self.page, self.on, lambda: self._things, lambda: self._view(client), self._label_soon
        )
        self._listen(client)
        self._on_appearance_change()
        self._drawables.clear()
        self._reset_camera(client)
        self._rooms.walls(self._assets.walls if "walls" in self.on else None)
        for switch in ("observations", "cloud", "cameras"):
            self._sensors.switch(switch, on=switch in self.on)
        self._draw()
        self._on_select()
        self.on_first_drawing()

    def detach(self, client_id: int) -> None:
        """Detach a frame that has disconnected, and cancel picking and dragging."""
        if self._client is not None and self._client.client_id == client_id:
            self._client = None
            self._relations.close()
            _cancel(self._drawing, self._labelling)
            self._drawing = self._labelling = None
            self._dragging.close()
            self._sensors.close()
            self._end_picking(None)

    def close(self) -> None:
        """Detach the frame of a closed tab."""
        if self._client is not None:
            self.detach(self._client.client_id)

    def _on_loop(self, function: Callable[..., None]) -> Callable[..., None]:
        """Return a function that calls `function` on the event loop of the page."""

        def call(*arguments: Any) -> None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(self._guarded, function, arguments)

        return call

    def _guarded(self, function: Callable[..., None], arguments: tuple[Any, ...]) -> None:
        if self._client is not None:
            with self.page.client:
                function(*arguments)

    def _listen(self, client: ClientHandle) -> None:
        on_ray, on_camera = self._on_loop(self._on_ray), self._on_loop(self._on_camera)

        async def clicked(event: Any) -> None:
            on_ray(event.ray_origin, event.ray_direction, event.modifier is not None)

        for modifier in _MODIFIERS:
            client.scene.on_click(modifier=modifier)(clicked)  # type: ignore[arg-type]

        @client.camera.on_update
        async def _(_: Any) -> None:
            on_camera()

    def _reset_camera(self, client: ClientHandle) -> None:
        """Restore the camera after a reconnect; otherwise show everything."""
        camera = client.camera
        camera.fov = FOV_RAD
        if self._camera is not None:
            camera.position, camera.look_at = self._camera
        else:
            self.show_all()

    def show_all(self) -> None:
        """Show the whole map from above."""
        if self._client is None:
            return
        camera = self._client.camera
        eye, target = first_view(extent(self.page.state.entities.values()), _aspect_of(camera))
        camera.position, camera.look_at = eye, target

    def show_selected(self) -> None:
        """Show the selected entities in the direction of the current view; do nothing without any."""
        if self._client is None:
            return
        things, entities = self._things, self.page.state.entities
        parts = [
            corners_of(things[name].pose, things[name].size_m)
            if name in things
            else extent([entities[name]])  # a place
            for name in self.page.selected
            if name in things or name in entities
        ]
        points = np.concatenate([np.zeros((0, 3)), *parts])
        if not len(points):
            return
        camera = self._client.camera
        back = np.subtract(camera.position, camera.look_at)
        eye, target = fit_view(points, _aspect_of(camera), (float(back[0]), float(back[1]), float(back[2])))
        camera.position, camera.look_at = eye, target

    def _on_appearance_change(self) -> None:
        if self._client is not None:
            self._client.gui.configure_theme(dark_mode=self.page.dark)
            self._rooms.darken(self.page.dark)

    # Drawing

    def _glb_of(self, key: Key) -> bytes:
        return self._assets.glb(key)

    def _draw_soon(self) -> None:
        """Draw after the panels; several changes until then are drawn together."""
        if self._client is None or self._is_deferred():
            return
        if self._drawing is None:
            self._drawing = self._loop.call_later(_DRAW_DELAY_S, self._draw)

    def _is_deferred(self) -> bool:
        """Return whether the scene is hidden; it is then drawn when it becomes visible."""
        self._is_stale = self._is_stale or not self.is_in_view()
        return self._is_stale

    def _on_tab_change(self) -> None:
        if self._is_stale and self.is_in_view():
            self._is_stale = False
            self._draw()

    def _draw(self) -> None:
        _cancel(self._drawing)
        self._drawing = None
        if self._client is None:
            return
        self._things = self._drawables.create()
        if (dragged := self._dragging.name) in self._things:
            self._things[dragged] = structs.replace(self._things[dragged], appearance="ghost")
        with self._client.atomic():
            self._bodies.show(self._things)
            self._rooms.show(self.page.state.entities)
            self._mark()
        self._relations.request()

    def refresh(self) -> None:
        """Draw with newly received models and walls."""
        self._drawables.clear()
        if self._client is not None:
            self._rooms.walls(self._assets.walls if "walls" in self.on else None)
        self._draw_soon()

    def _on_poses(self, names: tuple[str, ...]) -> None:
        if self._client is None or self._drawing is not None or self._is_deferred():
            return
        if any(self._has_moved_joints(name) for name in names):
            self._draw()
            return
        poses = self.page.state.poses
        moved = {name: poses[name] for name in names if name in self._things and name in poses}
        for name, pose in moved.items():
            self._things[name] = structs.replace(self._things[name], pose=pose)
        self._bodies.move(moved)
        if not moved.keys().isdisjoint(self.page.selected) or "boxes" in self.on:
            self._mark()
        elif self.page.live.drives:
            self._draw_paths()
        self._label_soon()

    def _on_drives(self) -> None:
        if self._client is not None and not self._is_deferred():
            self._draw_paths()

    def _has_moved_joints(self, name: str) -> bool:
        """Return whether joints of a body have moved since it was drawn."""
        thing, joint_positions = self._things.get(name), self.page.live.joint_positions.get(name)
        return (
            joint_positions is not None
            and thing is not None
            and thing.model != BOX
            and thing.joint_positions != joint_positions
        )

    def _mark(self) -> None:
        """Draw outlines, the gizmo and labels."""
        selected = {name: self._things[name] for name in self.page.selected if name in self._things}
        self._outlines.show(
            [(join_segments(edges_of(t.pose, t.size_m) for t in selected.values()), _SELECTED)]
        )
        boxes = self._things.values() if "boxes" in self.on else ()
        self._boxes.show([(join_segments(edges_of(t.pose, t.size_m) for t in boxes), _BOX)])
        self._dragging.put_gizmo({} if self._picking is not None else selected)
        self._relations.draw()
        self._draw_differences()
        self._draw_paths()
        self._label()

    def _draw_paths(self) -> None:
        """Draw the rest of the drives of all robots, with a cross at their goals."""
        drives = self.page.live.drives if self.page.moment.is_now else {}
        poses = self.page.state.poses
        self._paths.show(
            [
                (path_lines(path, poses[name].position_m), _PATH)
                for name, path in drives.items()
                if name in poses
            ]
        )

    def _draw_differences(self) -> None:
        pieces, labels = [], {}
        for found in difference_boxes(self.page.differences):
            rgb, size_m = _CHANGED[found.mark], self._known_size_of(found.name) or found.size_m
            at = found.before or found.now
            if at is None:
                raise errors.InternalError(f"{found.name} has no pose in either state")
            pieces.append((edges_of(at, size_m), rgb))
            if found.before is not None and found.now is not None:
                pieces.append((edges_of(found.now, size_m), rgb))
                middles = middle_of(found.before, size_m), middle_of(found.now, size_m)
                pieces.append((dashed_line(*middles), rgb))
            labels[found.name] = (found.text, top_of(found.now or at, size_m))
        self._differences.show(pieces)
        self._marked = labels
        self._label_soon()

    def _known_size_of(self, name: str) -> Size | None:
        return self._things[name].size_m if name in self._things else None

    # Labels

    def _on_camera(self) -> None:
        if self._client is not None:
            camera = self._client.camera
            self._camera = (tuple(camera.position), tuple(camera.look_at))
        self._label_soon()

    def _label_soon(self) -> None:
        if self._labelling is None:
            self._labelling = self._loop.call_later(_LABELS_S, self._label)

    def _label(self) -> None:
        _cancel(self._labelling)
        self._labelling = None
        if self._client is None or self._is_stale:
            return
        entities = self.page.state.entities
        things = {name: label_of(name, thing) for name, thing in self._things.items() if name in entities}
        named = {**things, **self._marked}
        selected = {name: named[name] for name in self.page.selected[:_NAMED] if name in named}
        marked = {f"{_MARKED}{name}": text for name, text in self._marked.items() if name not in selected}
        first = {**selected, **marked, **self._relations.labels}
        rooms, others = {}, {}
        if "names" in self.on:
            rooms = self._rooms.names
            others = {name: things[name] for name in things if name not in self._marked}
        every = {**first, **rooms, **others}
        chosen = select_labels(self._view(self._client), every, (*first, *rooms))
        self._difference_labels.show({key: marked[key] for key in chosen if key in marked})
        self._labels.show({key: others[key] for key in chosen if key in others and key not in selected})
        self._strong_labels.show({**{key: rooms[key] for key in chosen if key in rooms}, **selected})

    @staticmethod
    def _view(client: ClientHandle) -> View:
        camera = client.camera
        x, y, z = (float(value) for value in camera.position)
        qw, qx, qy, qz = (float(value) for value in camera.wxyz)
        return View((x, y, z), (qw, qx, qy, qz), camera.fov, camera.image_width, camera.image_height)

    def viewpoint(self) -> ViewPoint | None:
        """Return the viewpoint of this tab; None while its frame is not connected."""
        return None if self._client is None else self._view(self._client).viewpoint

    # Selection

    def _on_ray(self, origin: Vector, direction: Vector, extend: bool) -> None:
        """Handle a click.

        The hit is computed here, because batches of viser 1.1 report false hits at (0, 0, 0).
        """
        if self._dragging.name:
            return
        hit = first_hit(origin, direction, self._solids())
        if self._picking is not None:
            self._end_picking(None if hit is None else (*hit.at, 0.0))
            return
        name = "" if hit is None else hit.name
        if not extend:
            self.page.select((name,) if name else (), by="scene")
        elif name in self.page.selected:
            self.page.select((other for other in self.page.selected if other != name), by="scene")
        elif name:
            self.page.select((*self.page.selected, name), by="scene")

    def _on_select(self) -> None:
        if self._client is not None and not self._is_deferred():
            self._relations.clear()
            self._dragging.gizmo.remove()
            self._mark()
            self._relations.request()

    async def pick_place(self) -> Place | None:
        """Return the position of the next click: x, y, z [m] and yaw [rad].

        Return None without a hit, or if picking is cancelled.
        """
        self._end_picking(None)
        if self._client is None:
            return None
        picking: asyncio.Future[Place | None] = self._loop.create_future()
        self._picking = picking
        self.page.notify("click a position in the scene; press Esc to cancel")
        return await picking

    def _end_picking(self, place: Place | None) -> None:
        picking, self._picking = self._picking, None
        if picking is not None and not picking.done():
            picking.set_result(place)

    def cancel_interaction(self) -> bool:
        """Cancel picking or dragging; return whether there was any."""
        was_picking = self._picking is not None
        self._end_picking(None)
        was_dragging = self._client is not None and self._dragging.cancel()
        return was_picking or was_dragging

    def _on_drag(self, phase: Phase, pose: Pose) -> None:
        self._dragging.on_drag(phase, pose)

    def preview(self, poses: Mapping[str, Pose]) -> None:
        """Draw these entities at other poses, too; those of an earlier call disappear."""
        if self._client is not None:
            self._dragging.preview(poses)

    def _solids(self, without: str = "") -> list[Solid]:
        surface_of = self._assets.surface_of
        return [
            Solid(
                name,
                thing.pose,
                _reach_of(thing),
                surface_of(thing.model, thing.size_m, thing.joint_positions),
            )
            for name, thing in self._things.items()
            if name != without
        ]

    # Switches

    def switch(self, name: Switch, *, on: bool) -> None:
        """Show or hide a kind of content in this tab."""
        (self.on.add if on else self.on.discard)(name)
        if self._client is None:
            return
        if name in ("observations", "cloud", "cameras"):
            self._sensors.switch(name, on=on)
        elif name == "walls":
            self._rooms.walls(self._assets.walls if on else None)
        else:
            self._mark()
            self._relations.request()


def _cancel(*handles: asyncio.TimerHandle | None) -> None:
    for handle in handles:
        if handle is not None:
            handle.cancel()


def _aspect_of(camera: CameraHandle) -> float:
    """Return the width of the image divided by its height."""
    return float(camera.image_width / max(1, camera.image_height))


def _reach_of(thing: Drawable) -> Size:
    """Return the size of a box around an object, including its open doors and drawers."""
    x, y, z = thing.size_m
    return (3.0 * x + y, 3.0 * y + x, 1.5 * z) if thing.joint_positions else thing.size_m
