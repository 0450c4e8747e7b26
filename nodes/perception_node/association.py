"""What was seen, and what the map says: which is which, and what the map is to be told. Pure.

A look is matched in two steps: things that stand where they stood, or nearly; then things that have vanished
from their places with things of the same kind that appeared elsewhere, so that identity survives a move. What
is left over is new. Whoever calls must let the map take what it was told before the next look.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from nodes.perception_node.config import TrackingConfig
from nodes.perception_node.kinship import ANYTHING, Kinship
from nodes.perception_node.matching import Target, assign, cost_elsewhere, cost_in_place, fills
from nodes.perception_node.telling import is_sure, news, proposals
from nodes.perception_node.tracks import Track, Tracks, slack_m
from nodes.perception_node.visibility import Looks, Sight
from schemas.commands import Command
from schemas.entities import Entity, Size, distance_m
from schemas.perception import Observation

_USUAL_SIZE_M: Size = (0.1, 0.1, 0.1)
_FORGOTTEN_AFTER = 2
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
    """For each candidate that was seen the observation; for others, if one can tell, what is at its place."""

    seen: dict[int, int]
    places: dict[int, Sight]


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
    matching = _match(candidates, observations, looks, kinship)
    known, tentative = _remember(candidates, observations, matching, config)
    told = [news(entities[name], track, kinship, config) for name, track in known.items()]
    proposed = [track for track in tentative if is_sure(track, config)]
    added = proposals(proposed, {*tracks.names, *entities}, kinship)
    names = {j: candidates[i].name for i, j in matching.seen.items()}
    return Association(
        Tracks(
            known | dict(zip(added, proposed, strict=True)),
            tuple(track for track in tentative if not is_sure(track, config)),
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
        return Target(track.pose, track.size_m, class_name)
    return Target(
        track.pose,
        track.size_m if track.votes.looks else entity.size_m,
        entity.class_ if class_name == ANYTHING else class_name,
    )


def _match(
    candidates: Sequence[_Candidate], observations: Sequence[Observation], looks: Looks, kinship: Kinship
) -> _Matching:
    targets = [candidate.target for candidate in candidates]
    seen = dict(assign(targets, observations, lambda t, o: cost_in_place(t, o, kinship)))
    places: dict[int, Sight] = {}
    for i, target in enumerate(targets):
        if i not in seen:
            other = any(fills(target, seen_there) for seen_there in observations)
            places[i] = "open" if other else looks(target.pose, target.size_m or _USUAL_SIZE_M)
    gone = [i for i in places if candidates[i].name and (places[i] == "open" or candidates[i].track.unseen)]
    taken = {j for i, j in seen.items() if candidates[i].name}
    free = [j for j in range(len(observations)) if j not in taken]
    moved = assign(
        [targets[i] for i in gone],
        [observations[j] for j in free],
        lambda t, o: cost_elsewhere(t, o, kinship),
    )
    found = {gone[a]: free[b] for a, b in moved}
    left = {i: j for i, j in seen.items() if j not in found.values()}
    return _Matching(left | found, {i: sight for i, sight in places.items() if i not in found})


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
        elif i in matching.places:
            track = track.miss(matching.places[i])
        else:
            continue  # no entity, and what was seen of it is one after all
        if name:
            known[name] = track
        elif track.unseen < _FORGOTTEN_AFTER:
            tentative.append(track)
    of_none = set(range(len(observations))).difference(matching.seen.values())
    tentative += [
        Track(o.pose, o.size_m).see(o, config) for o in map(observations.__getitem__, sorted(of_none))
    ]
    return known, tentative
