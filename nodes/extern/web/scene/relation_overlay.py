"""The computed relations of the selected entity, as lines with labels in the scene of a tab."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from typing import Final

from viser import SceneApi

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.scene.annotations import Labels, LabelText, Lines, Rgb, line
from semmap.nodes.extern.web.scene.camera import View, select_labels
from semmap.nodes.extern.web.scene.drawables import Drawable, label_of, middle_of
from semmap.nodes.extern.web.scene.map_overlay import relation_lines
from semmap.nodes.extern.web.scene.switches import Switch
from semmap.schemas import errors
from semmap.schemas.commands import Relations
from semmap.schemas.entities import Vector
from semmap.schemas.relations import Relation

_RELATION: Final[Rgb] = (0, 120, 200)
_MEASURES: Final = 8
"""Maximum number of relation labels, for the nearest entities."""
_HANDLES: Final = "handles"
"""A text about as wide as the gizmo, which labels must not cover."""


class RelationOverlay:
    """The relations in one frame of a scene."""

    def __init__(
        self,
        scene: SceneApi,
        page: Page,
        on: Set[Switch],
        things: Callable[[], Mapping[str, Drawable]],
        view: Callable[[], View],
        on_drawn: Callable[[], None],
    ) -> None:
        """`on` are the switches, `things()` the drawn objects, and `view()` is that of the frame.

        `on_drawn()` is called when `labels` may have changed.
        """
        self._page, self._on, self._things, self._view, self._on_drawn = page, on, things, view, on_drawn
        self._lines = Lines(scene, "/relations/lines", width=2.5)
        self._texts = Labels(scene, "/relations/names", scale=0.95)
        self._relations: tuple[Relation, ...] = ()
        self._request = 0
        self.labels: Mapping[str, LabelText] = {}
        """The shown labels of the lines, which other labels must not cover."""

    def close(self) -> None:
        """Ignore replies from now on: the frame has disconnected."""
        self._request += 1

    def clear(self) -> None:
        """Forget the relations, until the next reply."""
        self._relations = ()

    def request(self) -> None:
        """Request the relations of the selected entity; if none are to be shown, remove the lines."""
        self._request += 1
        one = self._page.selected[0] if len(self._page.selected) == 1 else ""
        entity = self._page.state.entities.get(one)
        if self._on & {"relations", "viewer-relative relations"} and entity is not None and not entity.place:
            self._page.start_task(self._fetch(one, self._request))
        elif self._relations:
            self._relations = ()
            self.draw()

    async def _fetch(self, name: str, request: int) -> None:
        viewpoint = self._page.viewpoint if "viewer-relative relations" in self._on else None
        command = Relations(name=name, viewpoint=viewpoint, as_of=self._page.moment.commit)
        try:
            found = await self._page.live.ask(command)
        except errors.SemmapError:
            found = ()  # for example, it was just removed
        if request == self._request:
            self._relations = found
            self.draw()

    def draw(self) -> None:
        """Draw the lines, and those labels that cover no other text."""
        things, lines = self._things(), []
        if len(self._page.selected) == 1:
            middles = {name: middle_of(thing.pose, thing.size_m) for name, thing in things.items()}
            lines = relation_lines(self._page.selected[0], self._relations, middles)
        self._lines.show([(line(each.a, each.b), _RELATION) for each in lines])
        written = {
            f"{number} of {len(lines)}": (each.text, _between(each.a, each.b))
            for number, each in enumerate(lines)
        }
        chosen: list[str] = []
        if written:
            selected = {name: things[name] for name in self._page.selected if name in things}
            names = {name: label_of(name, thing) for name, thing in selected.items()}
            handles = {
                f"{name}'s handles": (_HANDLES, middle_of(thing.pose, thing.size_m))
                for name, thing in selected.items()
            }
            taken = {**handles, **names}
            every = {**taken, **written}
            chosen = select_labels(self._view(), every, every, _MEASURES + len(taken))
        self.labels = {key: written[key] for key in chosen if key in written}
        self._texts.show(self.labels)
        self._on_drawn()


def _between(a: Vector, b: Vector) -> Vector:
    return tuple(p + 0.6 * (q - p) for p, q in zip(a, b, strict=True))  # type: ignore[return-value]
