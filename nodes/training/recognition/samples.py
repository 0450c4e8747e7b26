"""Segments of simulated scenes as perception creates them, with ground truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import Parts, parts_in
from semmap.nodes.perception_node.recognition.features import SORTS, features_of
from semmap.nodes.perception_node.recognition.sides import shifts, side_features
from semmap.nodes.perception_node.segmentation.segment import LOWEST_M
from semmap.nodes.perception_node.views.boxes import Box
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.nodes.perception_node.views.segmented_view import SegmentedView, segment_cloud, with_labels
from semmap.nodes.perception_node.views.segments import map_points
from semmap.nodes.perception_node.views.supports import Support
from semmap.nodes.sim_node.models.parts import about, bounds, rotation_matrix
from semmap.nodes.sim_node.models.parts import product as rotated
from semmap.nodes.training.recognition.array_tables import Table
from semmap.nodes.training.scenes.simulated_scenes import Item, Shot, tinted
from semmap.schemas.scenes import Body

_PURE, _WHOLE = 0.7, 0.5
_FEWEST = 40
_CARRIER_M = 0.45
_THIN_M, _OF_THIN_M = 0.035, 0.002
"""Objects up to this height are segmented as a whole, except for the lowest part of this height [m]."""
_UNIT = np.ones(3)
NOTHING = ""


@dataclass(frozen=True)
class Samples(Table):
    """N things. `kind`: (N,) the model, `NOTHING` for clutter. `scene`: (N,) the number of its scene.

    `as_modelled`: (N,) whether it has the very form of our model, whatever its size and colours.
    `geometry`, `shape`, `colour`, `outline`, `relief`: (N, D) features. `sides`: (N, 5, F) with an expected
    size of one metre; `shifts`: (N, 5) how far the sides are off, NaN for clutter. `size_m`: (N, 3) truth.
    """

    kind: NDArray[np.str_]
    scene: NDArray[np.int64]
    as_modelled: NDArray[np.bool_]
    geometry: NDArray[np.float64]
    shape: NDArray[np.float64]
    colour: NDArray[np.float64]
    outline: NDArray[np.float64]
    relief: NDArray[np.float64]
    sides: NDArray[np.float64]
    shifts: NDArray[np.float64]
    size_m: NDArray[np.float64]


def samples_of(shot: Shot, items: Sequence[Item], scene: int) -> Samples | None:
    """Return every thing of a scene, for all cameras together and for each alone, segmented by ground truth.

    Also what perception itself cuts out: segments that hold several things teach nothing and are left out,
    pieces of a thing are clutter.
    """
    things, kinds, truths = [], [], []
    by_name = {item.name: item for item in items}
    true = [_truly(cloud, owner, shot.bodies) for cloud, owner in zip(shot.clouds, shot.owners, strict=True)]
    found = [segment_cloud(cloud) for cloud in shot.clouds]
    for sights, views in product((found, true), view_sets(len(shot.clouds))):
        cut = parts_in([sights[v] for v in views])
        for thing, name in zip(cut.things, _owner_names(shot, shared_pixels(cut, shot, views)), strict=True):
            if name is None or (name == NOTHING and sights is true):
                continue
            item = by_name.get(name)
            things.append(thing)
            kinds.append(NOTHING if item is None else item.label)
            truths.append(item)
    if not things:
        return None
    features = dict(zip(SORTS, features_of(things), strict=True))
    return Samples(
        kind=np.array(kinds),
        scene=np.full(len(things), scene),
        as_modelled=np.array([item is not None and item.form is None for item in truths]),
        **features,
        sides=np.array([side_features(thing, _UNIT) for thing in things]),
        shifts=np.array([_shifts(thing, item) for thing, item in zip(things, truths, strict=True)]),
        size_m=np.array([(np.nan,) * 3 if item is None else item.size_m for item in truths]),
    )


def _truly(cloud: Cloud, owner: NDArray[np.int32], bodies: Sequence[Body]) -> SegmentedView:
    """Return the true segments of the cloud, without points that are too close to their support."""
    pose = np.eye(4) if cloud.map_from_camera is None else cloud.map_from_camera
    points, depth = map_points(cloud, pose), cloud.points_camera[..., 2]
    bottoms = np.array([0.0, *(body.pose.position_m[2] for body in bodies)], np.float32)
    thin = np.array([False, *(body.size_m[2] < _THIN_M for body in bodies)])
    with np.errstate(invalid="ignore"):
        noise_m = np.where(thin[owner], _OF_THIN_M, np.maximum(LOWEST_M, 0.006 * depth**2))
        out = points[..., 2] - bottoms[owner] > noise_m
    labels = np.where(out, owner, 0).astype(np.int32)
    labels[(np.bincount(labels.ravel(), minlength=len(bodies) + 1) < _FEWEST)[labels]] = 0
    carriers = frozenset(n for n, body in enumerate(bodies, 1) if max(body.size_m[:2]) > _CARRIER_M)
    supports = tuple(Support(height) for height in sorted({0.0, *bottoms.tolist()}))
    undisputed = np.zeros((0, 0), np.float32)
    bare = SegmentedView(cloud, pose, labels, carriers, labels, supports, undisputed)
    return with_labels(bare, labels, carriers)


def view_sets(count: int) -> Iterator[tuple[int, ...]]:
    """Yield each camera alone, and all together."""
    yield from ((view,) for view in range(count))
    if count > 1:
        yield tuple(range(count))


def shared_pixels(parts: Parts, shot: Shot, views: Sequence[int]) -> NDArray[np.int64]:
    """Return (N + 1, B + 1) pixel counts of N parts and B bodies; index 0 stands for none."""
    shape = len(parts.things) + 1, len(shot.bodies) + 1
    table = np.zeros(shape, np.int64)
    for label, view in zip(parts.labels, views, strict=True):
        both = label.ravel() * shape[1] + shot.owners[view].ravel()
        table += np.bincount(both, minlength=table.size).reshape(shape)
    return table


def _owner_names(shot: Shot, table: NDArray[np.int64]) -> list[str | None]:
    """Return the body of each segment, `NOTHING` for clutter, None for several bodies."""
    visible = table.sum(axis=0)
    names: list[str | None] = []
    for row in table[1:]:
        best = int(row.argmax())
        if best == 0:
            names.append(NOTHING)
        elif row[best] < _PURE * row.sum():
            names.append(None)
        else:
            names.append(shot.bodies[best - 1].name if row[best] > _WHOLE * visible[best] else NOTHING)
    return names


def _shifts(thing: Thing, item: Item | None) -> NDArray[np.float64]:
    if item is None:
        return np.full(5, np.nan)
    return np.asarray(shifts(thing, true_box(item, thing.box.yaw_rad)))


def true_box(item: Item, yaw_rad: float) -> Box:
    """Return the upright box with this yaw around the whole item."""
    turn = about("z", item.yaw_rad - yaw_rad)
    rotation = rotation_matrix(turn)
    parts = [
        replace(part, centre=tuple(rotation @ part.centre), turn=rotated(turn, part.turn))
        for part in tinted(item).parts
    ]
    low, high = bounds(parts)
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    x, y, z = item.position_m
    origin = np.array([c * x + s * y, -s * x + c * y, z])
    return Box(origin + low, origin + high, yaw_rad)
