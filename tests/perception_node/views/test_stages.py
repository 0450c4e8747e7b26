"""The views of a drawn room: segments, supports, things and what two cameras see of the same thing."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.input.masks import DetectorLabel, Masks
from semmap.nodes.perception_node.pipeline import groups_in, parts_in
from semmap.nodes.perception_node.views import segment_memory
from semmap.nodes.perception_node.views.foot_supports import supports_at_feet
from semmap.nodes.perception_node.views.fusion import matching_segments, same_thing_logits
from semmap.nodes.perception_node.views.masked import with_masks
from semmap.nodes.perception_node.views.object_supports import supports_of_things
from semmap.nodes.perception_node.views.segment_memory import SegmentMemory
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.perception_node.views.split_segments import resolve_splits
from tests.perception_node.drawn import HEIGHT, WIDTH, check, cloud, counts, summary

FOLDER = Path(__file__).parent / "stages"


@cache
def views(*, known=True):
    return tuple(segment_cloud(cloud(camera, known=known)) for camera in ("left", "right"))


def described_segment(segment):
    return [
        segment.label,
        int(segment.cut),
        segment.count,
        int(segment.carrier),
        len(segment.ends),
        *summary(segment.points),
        *summary(segment.colors),
        *segment.eye.tolist(),
    ]


def described_thing(thing):
    box = [*thing.box.low.tolist(), *thing.box.high.tolist(), thing.box.yaw_rad, *thing.box.bottom_m.tolist()]
    return [
        len(thing.segments),
        thing.count,
        int(thing.carrier),
        int(thing.whole),
        int(thing.masked),
        thing.lifted_m,
        *box,
        *summary(thing.cells),
        *summary(thing.colors),
        *thing.eyes.ravel().tolist(),
    ]


def segmented_views():
    found = {}
    for known in (True, False):
        for view in views(known=known):
            name = f"{view.cloud.camera} {'known' if known else 'unknown'}"
            found[name] = [*counts(view.labels), *sorted(view.carriers), *summary(view.same), len(view.notes)]
            found[f"{name} pose"] = view.map_from_camera.ravel().tolist()
            found[f"{name} supports"] = [
                v for s in view.supports for v in (s.height_m, *s.low_m, *s.high_m, s.area_m2)
            ]
            for segment in view.segments:
                found[f"{name} segment {segment.label}"] = described_segment(segment)
    return found


def merged_things():
    both = views()
    found = {"groups": [v for group in groups_in(both) for member in (*group, (-1, -1)) for v in member]}
    members, same = matching_segments(both)
    found["members"] = [v for member in members for v in member]
    found["matches"] = [v for pair in np.argwhere(same) for v in pair.tolist()]
    found["logits"] = summary(same_thing_logits(both, groups_in(both)))
    found["splits"] = [v for view in resolve_splits(both) for v in counts(view.labels)]
    parts = parts_in(both)
    for number, thing in enumerate(parts.things):
        found[f"thing {number}"] = described_thing(thing)
    found["labels"] = [v for labels in parts.labels for v in counts(labels)]
    found["feet"] = [
        v for s in supports_at_feet(both, parts.things) for v in (s.height_m, *s.low_m, *s.high_m)
    ]
    found["tops"] = [
        v for s in supports_of_things(parts.things) for v in (s.height_m, *s.low_m, *s.high_m, s.area_m2)
    ]
    with_feet = parts.with_foot_supports(both)
    found["on feet"] = [v for thing in with_feet.things for v in (thing.lifted_m, float(thing.box.low[2]))]
    return found


def detected_masks():
    view = views()[0]
    row, column = np.indices((HEIGHT, WIDTH))
    found = {}
    for name, shapes in {
        "carton": [(row > 60) & (row < 140) & (column > 190) & (column < 230)],
        "halves": [(column < 150) & (row < 120), (column >= 150) & (row < 120)],
        "nothing": [(row < 3) & (column < 3)],
        "all": [np.ones((HEIGHT, WIDTH), bool)],
    }.items():
        labels = np.zeros((HEIGHT, WIDTH), np.int32)
        for number, shape in enumerate(shapes, 1):
            labels[shape] = number
        names = tuple(DetectorLabel("thing", 0.5) for _ in shapes)
        masked = with_masks(view, Masks(labels, names))
        alone = with_masks(view, Masks(labels, names, alone=True))
        found[f"{name} alone"] = [*counts(alone.labels), *sorted(alone.carriers), *alone.unused_masks]
        found[name] = [
            *counts(masked.labels),
            *sorted(masked.carriers),
            *masked.unused_masks,
            *summary(masked.same),
        ]
        for segment in masked.segments:
            found[f"{name} segment {segment.label}"] = [*described_segment(segment)[:5], int(segment.masked)]
    return found


def remembered_segments():
    first, second = views()
    moved = tuple(replace(view, cloud=replace(view.cloud, camera="hand")) for view in (first, second))
    memory = SegmentMemory().after([moved[0]], [[s] for s in moved[0].segments], [])
    found = {"before it moves": [len(memory.segments), len(memory.moving)]}
    memory = memory.after([moved[1]], [[s] for s in moved[1].segments], [])
    found["after"] = [
        len(memory.segments),
        len(memory.moving),
        *(v for s in memory.segments for v in (s.count, len(s.points))),
    ]
    recalled = memory.recalled([moved[0]], [moved[0].labels])
    found["recalled"] = [
        v for own in recalled for v in (own.thing, len(own.rest.points), own.rest.count, len(own.rest.ends))
    ]
    for number, segment in enumerate(moved[1].segments):
        done = segment_memory.completed([segment], [s for s in moved[0].segments if s.cut])
        found[f"completed {number}"] = [v for s in done for v in (int(s.cut), len(s.ends))]
    joined = segment_memory.joined(first.segments)
    found["joined"] = [*described_segment(joined)]
    return found


def test_each_camera_sees_the_table_and_the_things_on_it_as_segments():
    check(segmented_views(), FOLDER / "views.json")


def test_segments_of_two_cameras_are_merged_into_things_that_stand_on_their_supports():
    check(merged_things(), FOLDER / "things.json")


def test_the_masks_of_a_detector_replace_the_segments_that_they_cover():
    check(detected_masks(), FOLDER / "masks.json")


def test_a_moving_camera_remembers_what_it_saw():
    check(remembered_segments(), FOLDER / "memory.json")
