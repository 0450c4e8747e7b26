"""The layout of the viewer: scene and camera images on the left, commits and graph on the right."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import rerun.blueprint as rrb

from semmap.nodes.geometry.outliers import find_near
from semmap.nodes.recorder.drawing.perception_archetypes import BOXES, camera_path
from semmap.schemas.entities import Pose, Vector

_BACKGROUND = (24, 26, 30)
_LOG_COLUMNS = rrb.TextLogColumns(
    timeline_columns=[rrb.encodings.TimelineColumn("time", visible=False)], text_log_columns=["body"]
)
_GRID = (255, 255, 255, 30)
_LEAST_EXTENT_M = 1.5
_MOST_PICTURES = 3


@dataclass(frozen=True)
class Bounds:
    """The visible region: a square of side `extent_m` around `centre_m`, map frame."""

    centre_m: Vector = (0.0, 0.0, 0.0)
    extent_m: float = 10.0


def bounds_of(poses: Iterable[Pose]) -> Bounds:
    """Return bounds around `poses` but outliers, or of ten metres around the origin if there are none."""
    points = np.array([pose.position_m for pose in poses]).reshape(-1, 3)
    if not len(points):
        return Bounds()
    near = points[find_near(points)]
    (x0, y0, z0), (x1, y1, z1) = near.min(axis=0).tolist(), near.max(axis=0).tolist()
    middle = ((x0 + x1) / 2.0, (y0 + y1) / 2.0, (z0 + z1) / 2.0)
    return Bounds(middle, max(x1 - x0, y1 - y0, _LEAST_EXTENT_M))


def layout(bounds: Bounds, cameras: Sequence[str] = ()) -> rrb.Blueprint:
    """Build the layout. The eye is in the south-west, half way up, and looks at `bounds`.

    Below the scene are the images of `cameras`, with the boxes of observations.
    """
    x, y, z = bounds.centre_m
    e = bounds.extent_m
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(x - 0.25 * e, y - 0.8 * e, z + 0.85 * e),
        look_target=(x, y, z),
        eye_up=(0.0, 0.0, 1.0),
    )
    scene = rrb.Spatial3DView(
        origin="/map",
        name="Scene",
        background=_BACKGROUND,
        line_grid=rrb.LineGrid3D(spacing=1.0, color=_GRID),
        eye_controls=eye,
    )
    pictures = [_camera_view(camera) for camera in cameras[:_MOST_PICTURES]]
    seen = rrb.Vertical(scene, rrb.Horizontal(*pictures), row_shares=[3, 2]) if pictures else scene
    return rrb.Blueprint(
        rrb.Horizontal(
            seen,
            rrb.Vertical(
                rrb.TextDocumentView(origin="/commits", contents="/commits", name="Commit"),
                rrb.TextLogView(origin="/commits/log", name="Log", columns=_LOG_COLUMNS),
                rrb.GraphView(
                    origin="/graph",
                    name="Knowledge graph",
                    force_link=rrb.archetypes.ForceLink(distance=70.0),
                    force_position=rrb.archetypes.ForcePosition(enabled=True, strength=0.03),
                    force_many_body=rrb.archetypes.ForceManyBody(strength=-700.0),
                    force_collision_radius=rrb.archetypes.ForceCollisionRadius(
                        enabled=True, strength=1.0, iterations=3
                    ),
                ),
                row_shares=[4, 2, 4],
            ),
            column_shares=[2, 1],
        ),
        rrb.TimePanel(timeline="time", play_state="following", state="collapsed"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        auto_views=False,
    )


def _camera_view(camera: str) -> rrb.Spatial2DView:
    path = camera_path(camera)
    return rrb.Spatial2DView(origin=path, contents=[f"/{path}", f"/{BOXES}"], name=camera)
