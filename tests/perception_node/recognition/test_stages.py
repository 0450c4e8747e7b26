"""The recognition of the things in a drawn room: features, joined pieces, classes and complete boxes."""

from functools import cache
from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.pipeline import observe_views, parts_in, recognise_segments
from semmap.nodes.perception_node.recognition import similarity
from semmap.nodes.perception_node.recognition.features import SORTS, features_of
from semmap.nodes.perception_node.recognition.free_standing import are_free_standing, is_compact
from semmap.nodes.perception_node.recognition.joining import (
    describe_pair,
    is_worth_joining,
    join_parts,
    near_pairs,
    pair_features,
    same_thing_probability,
)
from semmap.nodes.perception_node.recognition.recognise import Clutter, reclassify_trimmed, recognise, trim
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.recognition.sides import completed, shifts, side_features
from semmap.nodes.perception_node.recognition.vote import choose_class, expected_sizes, leaf_probabilities
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from tests.perception_node.drawn import check, cloud, summary

FOLDER = Path(__file__).parent / "stages"


@cache
def views():
    return tuple(segment_cloud(cloud(camera)) for camera in ("left", "right"))


@cache
def parts():
    return parts_in(views())


def described_box(box):
    return [*box.low.tolist(), *box.high.tolist(), box.yaw_rad]


def features_of_things():
    things, found = parts().things, {}
    for sort, values in zip(SORTS, features_of(things), strict=True):
        for number, row in enumerate(values):
            found[f"{sort} {number}"] = [*summary(row), *row[:40].tolist()]
    return found


def joined_pieces():
    of, learnt = parts(), shipped()
    things = of.things
    pairs = near_pairs(things)
    found = {
        "near": [v for pair in pairs for v in pair],
        "far": [v for pair in near_pairs(things, 0.3) for v in pair],
    }
    chances = leaf_probabilities(learnt, features_of(things))
    found["chances"] = [*summary(chances), *chances.max(axis=1).tolist(), *chances.argmax(axis=1).tolist()]
    pairs = near_pairs(things, 0.3)
    apart = chances[np.array(pairs)]
    found["worth"] = is_worth_joining(apart, learnt).astype(int).tolist()
    wholes = [of.join(things[a], things[b]) for a, b in pairs]
    known = np.array(
        [
            describe_pair(things[a], things[b], whole, of.same_thing_logits[:, [a]][:, :, [b]])
            for (a, b), whole in zip(pairs, wholes, strict=True)
        ]
    )
    found["known"] = known.ravel().tolist()
    together = leaf_probabilities(learnt, features_of(wholes))
    found["pairs"] = [v for row in pair_features(apart, together, known, learnt) for v in summary(row)]
    found["same"] = same_thing_probability(apart, together, known, learnt).tolist()
    made, likely, members = join_parts(things, of.same_thing_logits, learnt, of.join)
    found["joined"] = [len(made), *summary(likely), *(v for own in members for v in (*own, -1))]
    return found


def recognised_things():
    of, learnt = parts(), shipped()
    things = of.things
    chances = leaf_probabilities(learnt, features_of(things))
    expected = expected_sizes(chances, learnt.sizes_m)
    found = {"expected": expected.ravel().tolist()}
    for number, thing in enumerate(things):
        sides = side_features(thing, expected[number])
        box = completed(thing, sides, learnt.sides)
        found[f"sides {number}"] = sides.ravel().tolist()
        found[f"complete {number}"] = [*described_box(box), *shifts(thing, box).tolist()]
        less = trim(thing)
        found[f"trimmed {number}"] = [len(less.cells), *described_box(less.box), *summary(less.colors)]
        rated = dict(zip(learnt.classes, chances[number].tolist(), strict=True))
        found[f"class {number}"] = [*choose_class(rated, learnt.ancestors)]
    found["again"] = summary(reclassify_trimmed(things, chances, learnt))
    everything = np.ones(len(things), bool)
    found["free"] = are_free_standing(things, everything).astype(int).tolist()
    found["free of nothing"] = are_free_standing(things, ~everything).astype(int).tolist()
    found["compact"] = [int(is_compact(thing)) for thing in things]
    for number, one in enumerate(recognise(things, chances, learnt)):
        found[f"observed {number}"] = described_observation(one)
    for number, one in recognise_segments(views()[0], learnt).items():
        found[f"segment {number}"] = [] if one is None else described_observation(one)
    whole = observe_views(views(), learnt)
    found["frame"] = [
        len(whole.observations.observations),
        len(whole.dropped),
        *np.bincount(whole.labels[0].ravel()).tolist(),
    ]
    return found


def described_observation(one):
    if isinstance(one, Clutter):
        return ["clutter", one.probability]
    candidates = [v for pair in one.candidates.items() for v in pair]
    return [
        one.class_,
        one.probability,
        *candidates,
        *one.pose.position_m,
        *one.pose.orientation_wxyz,
        *one.size_m,
        one.points,
        int(one.whole),
        int(one.shown),
        one.label,
        int(one.labelled),
    ]


def similar_views():
    seen = similarity.views_of(features_of(parts().things))
    found = {"views": summary(seen)}
    pairs = [(a, b) for a in range(len(seen)) for b in range(len(seen)) if a < b]
    kept, other = seen[[a for a, _ in pairs]], seen[[b for _, b in pairs]]
    for number, row in enumerate(similarity.pair_features(kept, other)):
        found[f"pair {pairs[number]}"] = summary(row)
    found["likely"] = similarity.shipped()(kept, other).ravel().tolist()
    return found


def test_each_sort_of_features_describes_the_things():
    check(features_of_things(), FOLDER / "features.json")


def test_neighbours_that_are_pieces_of_one_thing_are_joined():
    check(joined_pieces(), FOLDER / "joined.json")


def test_things_have_a_class_a_pose_and_the_box_of_the_complete_thing():
    check(recognised_things(), FOLDER / "recognised.json")


def test_views_of_the_same_thing_are_similar():
    check(similar_views(), FOLDER / "similar.json")
