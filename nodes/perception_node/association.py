"""What was seen, and what the map says: which is which, and what the map is to be told. Pure.

A look is matched in steps. First things that stand where they stood, or nearly. Then, as segments of one look
are not always those of the next, what is only a part of a thing that still fills its place, or several such
in one, is passed over. Then things that have vanished from their places are found again in things of the same
kind that appeared elsewhere, so that identity survives a move. What is left over is new.

Whoever calls must let the map take what it was told before the next look.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from nodes.perception_node.config import TrackingConfig
from nodes.perception_node.kinship import ANYTHING, Kinship
from nodes.perception_node.matching import Target, assign, cost_elsewhere, cost_in_place
from nodes.perception_node.overlap import Place, are_of_one
from nodes.perception_node.telling import has_moved, is_sure, news, proposals
from nodes.perception_node.tracks import Track, Tracks, slack_m
from nodes.perception_node.visibility import Looks, Sight
from schemas.commands import Command
from schemas.entities import Entity, Size, distance_m
from schemas.perception import Observation

_USUAL_SIZE_M: Size = (0.1, 0.1, 0.1)
_FORGOTTEN_AFTER = 3
"""Looks in a row after which what is no entity yet, and no longer seen, is forgotten."""


class Association(NamedTuple):
    """The new memory, what to tell the map, and for each observation its entity ("" for none yet)."""

    tracks: Tracks
    commands: tuple[Command, ...]
    entities: tuple[str, ...]


class _Candidate(NamedTuple):
    """Something that may be seen: an entity by its name or, without one, what is no entity yet."""

    name: str
    track: Track
    target: Target


class _Matching(NamedTuple):
    """For each candidate that was seen the observation, for each other what is seen of its place.

    `odd` are those in whose place something of another size is seen, `new` the observations of nothing known.
    """

    seen: dict[int, int]
    places: dict[int, Sight]
    odd: set[int]
    new: list[int]


def associate(
    entities: Mapping[str, Entity],
    tracks: Tracks,
    observations: Sequence[Observation],
    looks: Looks,
    kinship: Kinship,
    config: TrackingConfig,
) -> Association:
    """One look. `entities` are the map's, `looks` tells what is seen of a place without an observation."""
    candidates = _candidates(entities, tracks, kinship, config)
    matching = _match(candidates, observations, looks, kinship, config)
    known, tentative = _remember(candidates, observations, matching, config)
    known = {name: _watched(track, entities[name], looks, config) for name, track in known.items()}
    told = [news(entities[name], track, kinship, config) for name, track in known.items()]
    proposed = _apart_from_one_another(track for track in tentative if is_sure(track, config))
    added = proposals(proposed, {*tracks.names, *entities}, kinship)
    names = {j: candidates[i].name for i, j in matching.seen.items()}
    return Association(
        Tracks(
            known | dict(zip(added, proposed, strict=True)),
            tuple(track for track in tentative if track not in proposed),
            tracks.names.union(added),
        ),
        (*(command for command in told if command is not None), *added.values()),
        tuple(names.get(j, "") for j in range(len(observations))),
    )


def _candidates(
    entities: Mapping[str, Entity], tracks: Tracks, kinship: Kinship, config: TrackingConfig
) -> list[_Candidate]:
    known = [
        (entity, _track_of(entity, tracks.known.get(entity.name), config))
        for entity in entities.values()
        if not entity.place and entity.pose is not None
    ]
    return [_Candidate(entity.name, track, _target(track, kinship, entity)) for entity, track in known] + [
        _Candidate("", track, _target(track, kinship)) for track in tracks.tentative
    ]


def _track_of(entity: Entity, track: Track | None, config: TrackingConfig) -> Track:
    """What is remembered of an entity; if somebody else has told the map another pose since, that counts."""
    assert entity.pose is not None
    if track is None:
        return Track(entity.pose, entity.size_m or _USUAL_SIZE_M, told=entity.pose)
    elsewhere = distance_m(track.pose, entity.pose) > slack_m(track.size_m, config.still_m)
    if track.told != entity.pose and elsewhere:
        return replace(track, pose=entity.pose, looks=0, told=entity.pose)
    return replace(track, told=entity.pose)


def _target(track: Track, kinship: Kinship, entity: Entity | None = None) -> Target:
    class_name = track.votes.belief(kinship)
    if entity is None:
        return Target(track.pose, track.size_m, class_name, track.whole)
    if class_name == ANYTHING:
        class_name = entity.class_
    size_m = track.size_m if track.looks else entity.size_m
    own = entity.shape_provenance.source == "perception"
    return Target(track.pose, size_m, class_name, track.whole or not own)


def _match(
    candidates: Sequence[_Candidate],
    observations: Sequence[Observation],
    looks: Looks,
    kinship: Kinship,
    config: TrackingConfig,
) -> _Matching:
    entities = [i for i, candidate in enumerate(candidates) if candidate.name]
    seen = _assigned(candidates, entities, observations, range(len(observations)), kinship, cost_in_place)
    places = {i: looks(*_place(candidates[i])) for i in entities if i not in seen}
    spots = [Place(o.pose, o.size_m) for o in observations]
    gone = {i for i in places if candidates[i].track.is_gone(config)}
    filled = [i for i in entities if places.get(i) != "open"]
    parts = {
        i: [j for j, spot in enumerate(spots) if are_of_one(_place(candidates[i]), spot)] for i in filled
    }
    passed_over = {j for i, of_one in parts.items() if i not in gone for j in of_one}.difference(
        seen.values()
    )
    left = [j for j in range(len(observations)) if j not in passed_over and j not in seen.values()]
    vanished = [
        i for i, sight in places.items() if i in gone or sight == "open" or candidates[i].track.unseen
    ]
    seen |= _assigned(candidates, vanished, observations, left, kinship, cost_elsewhere)
    left = [j for j in left if j not in seen.values()]
    unnamed = [i for i, candidate in enumerate(candidates) if not candidate.name]
    seen |= _assigned(candidates, unnamed, observations, left, kinship, cost_in_place)
    return _Matching(
        seen,
        {i: sight for i, sight in places.items() if i not in seen},
        {i for i, of_one in parts.items() if of_one and places.get(i) == "filled" and i not in seen},
        [j for j in left if j not in seen.values()],
    )


def _assigned(
    candidates: Sequence[_Candidate],
    of: Sequence[int],
    observations: Sequence[Observation],
    to: Sequence[int],
    kinship: Kinship,
    cost: Callable[[Target, Observation, Kinship], float],
) -> dict[int, int]:
    """Some candidates and their observations among some, all by their numbers."""
    targets, free = [candidates[i].target for i in of], [observations[j] for j in to]
    return {of[a]: to[b] for a, b in assign(targets, free, lambda t, o: cost(t, o, kinship))}


def _place(candidate: _Candidate) -> Place:
    return Place(candidate.target.pose, candidate.target.size_m or _USUAL_SIZE_M)


def _remember(
    candidates: Sequence[_Candidate],
    observations: Sequence[Observation],
    matching: _Matching,
    config: TrackingConfig,
) -> tuple[dict[str, Track], list[Track]]:
    """The tracks of entities and those of what is none yet, after this look."""
    known: dict[str, Track] = {}
    tentative: list[Track] = []
    for i, (name, track, _) in enumerate(candidates):
        if i in matching.seen:
            track = track.see(observations[matching.seen[i]], config)
        else:
            track = track.miss(matching.places.get(i, "open"), odd=i in matching.odd)
        if name:
            known[name] = track
        elif track.unseen < _FORGOTTEN_AFTER:
            tentative.append(track)
    new = [observations[j] for j in matching.new]
    return known, [*tentative, *(Track(o.pose, o.size_m).see(o, config) for o in new)]


def _watched(track: Track, entity: Entity, looks: Looks, config: TrackingConfig) -> Track:
    """With a look at the place that the map has of it: is that left?"""
    if entity.pose is None or track.unseen or not has_moved(entity, track, config):
        return replace(track, left=False)
    return replace(track, left=track.left or looks(entity.pose, track.size_m) == "open")


def _apart_from_one_another(tracks: Iterable[Track]) -> list[Track]:
    apart: list[Track] = []
    for track in tracks:
        spot = Place(track.pose, track.size_m)
        if not any(are_of_one(spot, Place(other.pose, other.size_m)) for other in apart):
            apart.append(track)
    return apart
