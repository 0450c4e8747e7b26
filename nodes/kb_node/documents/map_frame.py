"""Expresses poses of a document in the map frame: those of perceptions, and those relative to other things.

Maps of KnowRob 1 state where a perception saw an object, as a matrix. The latest perception of an object
gives its pose, which is added in the vocabulary of the alignment; the perceptions stay. A pose relative to
another thing is replaced by its value in the map frame, because an entity has one pose there.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final

from semmap.nodes.kb_node.entities import aligned_values
from semmap.nodes.kb_node.entities.aligned_values import AlignedPose
from semmap.nodes.kb_node.entities.alignments import Alignment, PerceptionMapping
from semmap.ontology import vocabulary as v
from semmap.schemas import entities, errors, wording
from semmap.schemas.entities import Pose
from semmap.schemas.explanations import Term, Triple

_FEW: Final = 5
_NUMBER: Final = re.compile(r"\d+(?:\.\d+)?")
_MAP_FRAMES: Final = frozenset(("map", "map_frame", "mapframe", "world"))
"""Names of the map frame, in lower case."""
_ORIGIN: Final = Pose(position_m=(0.0, 0.0, 0.0))

FindFrame = Callable[[Term], Pose | None]
"""Returns the pose of an entity of the map, with its middle as position."""


def express_in_map_frame(
    triples: list[Triple], alignments: Sequence[Alignment], find_frame: FindFrame = lambda _: None
) -> tuple[list[Triple], list[str]]:
    """Return the triples with poses in the map frame, and notes on what was converted.

    Raises BadFile for poses that are relative to each other.
    """
    document = _Document(triples, alignments, find_frame)
    perceived, relative = document.find_perceived(), document.find_relative()
    added: list[Triple] = []
    removed: set[Triple] = set()
    unresolved: list[Term] = []
    for subject, stated in sorted({**relative, **perceived}.items()):
        pose = document.resolve(subject)
        if pose is None:
            unresolved.append(subject)
            continue
        old, new = document.state(subject, stated, pose)
        removed.update(old)
        added += new
    notes = (
        _note(perceived.keys() - unresolved, "pose", "read from perceptions"),
        _note(relative.keys() - unresolved, "relative pose", "stored in the map frame"),
        _note(unresolved, "pose", "not used, relative to something without a pose"),
        _note(document.find_unreadable(), "pose", "not used, not three numbers and a unit quaternion"),
    )
    if not added:
        return triples, [note for note in notes if note]
    return [*(t for t in triples if t not in removed), *added], [note for note in notes if note]


def _note(subjects: Iterable[Term], what: str, done: str) -> str:
    names = sorted(map(v.entity_name, subjects))
    return f"{wording.counted(len(names), what)} {done}: {wording.few(names, _FEW)}" if names else ""


class _Document:
    """The poses of a document, by individual."""

    def __init__(
        self, triples: Iterable[Triple], alignments: Sequence[Alignment], find_frame: FindFrame
    ) -> None:
        self._alignments, self._find_frame = alignments, find_frame
        self._asserted: dict[Term, dict[Term, list[Term]]] = {}
        for s, p, o in triples:
            self._asserted.setdefault(s, {}).setdefault(p, []).append(o)
        self._perceived: dict[Term, AlignedPose] = {}
        self._resolved: dict[Term, Pose | None] = {}
        """The poses in the map frame that are known already, so that a chain is followed once."""

    def find_perceived(self) -> Mapping[Term, AlignedPose]:
        """Return the latest perceived pose of each object for which the document states no other."""
        latest: dict[Term, tuple[float, Term, AlignedPose]] = {}
        for known in self._alignments:
            for words in known.perceived:
                for event, asserted in self._asserted.items():
                    pose = self._read_perception(known, words, asserted)
                    time_s = _read_time(asserted.get(words.time, ()))
                    if pose is None:
                        continue
                    for thing in asserted.get(words.object, ()):
                        if thing[0] != '"' and (time_s, event) > latest.get(thing, (-2.0, ""))[:2]:
                            latest[thing] = (time_s, event, pose)
        self._perceived = {s: pose for s, (*_, pose) in latest.items() if self._own_pose(s) is None}
        return self._perceived

    def _read_perception(
        self, known: Alignment, words: PerceptionMapping, asserted: Mapping[Term, Sequence[Term]]
    ) -> AlignedPose | None:
        """Return the pose at which a perception occurred: a matrix, or stated as other poses are."""
        for node in sorted(asserted.get(words.pose, ())):
            values = self._about(node)
            pose = aligned_values.read_matrix(values, words.matrix)
            if pose is None:
                forms = (aligned_values.read_pose(values, form) for form in known.pose)
                pose = next((found for found in forms if found is not None), None)
            if pose is not None:
                reference = min(values.get(words.relative, ()), default=None)
                return AlignedPose(known.pose[0], (), pose.position_m, pose.orientation_wxyz, reference)
        return None

    def find_relative(self) -> dict[Term, AlignedPose]:
        """Return the poses that the document states relative to something else."""
        properties = {words.relative for known in self._alignments for words in known.pose}
        if not any(properties & asserted.keys() for asserted in self._asserted.values()):
            return {}
        found = ((s, self._own_pose(s)) for s in self._asserted)
        return {s: pose for s, pose in found if pose is not None and pose.reference is not None}

    def find_unreadable(self) -> set[Term]:
        """Return the individuals with a pose whose position or orientation is not valid."""
        forms = [words for known in self._alignments for words in known.pose]
        unreadable = {
            node
            for node, values in self._asserted.items()
            if any(words.position in values for words in forms)
            and all(aligned_values.read_pose(values, words) is None for words in forms)
        }
        found = aligned_values.find_pose_owners(forms, self._asserted, self._about) if unreadable else ()
        return {owner for owner, node in found if node in unreadable}

    def _own_pose(self, subject: Term) -> AlignedPose | None:
        return next(aligned_values.find_stated_poses(self._alignments, self._about, subject), None)

    def _about(self, subject: Term) -> Mapping[Term, Sequence[Term]]:
        return self._asserted.get(subject, {})

    def resolve(self, subject: Term) -> Pose | None:
        """Return the pose of an individual in the map frame, or None if a reference has no pose.

        Raises BadFile for a cycle.
        """
        chain: dict[Term, Pose] = {}
        node: Term | None = subject
        while node is not None and node not in self._resolved:
            if node in chain:
                names = " to ".join(map(v.entity_name, [*list(chain)[list(chain).index(node) :], node]))
                raise errors.BadFile(
                    f"poses are relative to each other: {names}; state one of them in the map frame"
                )
            stated = self._own_pose(node) or self._perceived.get(node)
            if stated is None:
                is_map = v.entity_name(node).lower() in _MAP_FRAMES
                self._resolved[node] = _ORIGIN if is_map else self._find_frame(node)
            else:
                chain[node] = Pose(position_m=stated.position, orientation_wxyz=stated.orientation)
                node = stated.reference
        base = _ORIGIN if node is None else self._resolved[node]
        for one, step in reversed(chain.items()):
            base = None if base is None else entities.compose(base, step)
            self._resolved[one] = base
        return base

    def state(self, subject: Term, stated: AlignedPose, pose: Pose) -> tuple[list[Triple], list[Triple]]:
        """Return the triples to remove and to add for a pose in the map frame."""
        pose = entities.rounded(pose)
        if stated.nodes:
            old, new = aligned_values.pose_triples(stated, pose, None, self._about)
            relative = stated.words.relative
            node = stated.nodes[-1]
            references = () if relative is None else self._about(node).get(relative, ())
            return [*old, *((node, relative, o) for o in references if relative is not None)], new
        digest = hashlib.blake2b(f"{subject} {pose}".encode(), digest_size=8).hexdigest()
        nodes = [subject, *(f"_:p{digest}x{step}" for step in range(len(stated.words.path)))]
        path = list(zip(nodes, stated.words.path, nodes[1:], strict=False))
        _, new = aligned_values.pose_triples(stated._replace(nodes=tuple(nodes)), pose, None, self._about)
        return [], [*path, *new]


def _read_time(terms: Iterable[Term]) -> float:
    """Return the last number in the names or texts of points in time [s], or -1."""
    found = [_NUMBER.findall(v.lexical(t) if t.startswith('"') else v.local_name(t)) for t in terms]
    return max((float(numbers[-1]) for numbers in found if numbers), default=-1.0)
