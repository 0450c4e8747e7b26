"""Poses, sizes and labels of entities that are expressed in other vocabularies."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from semmap.nodes.kb_node.entities.alignments import Alignment, PoseMapping, SizeMapping
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import IDENTITY, REACH_M, Pose, Quaternion, Size, Vector
from semmap.schemas.explanations import Term, Triple

About = Callable[[Term], Mapping[Term, Sequence[Term]]]
"""A lookup of the asserted objects of a subject by predicate."""

_LABELS = (v.SKOS_PREF_LABEL, v.RDFS_LABEL)
LABELS = (*_LABELS, v.SKOS_ALT_LABEL)
"""The properties by which any ontology may name individuals."""
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_ROTATION = 0.02
"""How far the products of the columns of a rotation matrix may be from 0 and 1."""
_BETWEEN = re.compile(r"[\s,;\[\]()]+")


class AlignedPose(NamedTuple):
    """A pose as another vocabulary expresses it."""

    words: PoseMapping
    nodes: tuple[Term, ...]
    """The individuals on the path from the entity (first) to the one with the pose (last)."""
    position: Vector
    """Position of the pose's origin [m]."""
    orientation: Quaternion
    reference: Term | None = None
    """The individual in whose frame the pose is; None for the map frame."""


class AlignedSize(NamedTuple):
    """A size as another vocabulary expresses it."""

    words: SizeMapping
    nodes: tuple[Term, ...]
    size_m: Size


def pose(alignments: Iterable[Alignment], about: About, iri: Term, size_m: Size | None) -> Pose | None:
    """Return the pose of an entity's bottom centre in the map frame, or None if there is none."""
    asserted = find_pose(alignments, about, iri)
    return None if asserted is None else bottom_pose(asserted, size_m)


def bottom_pose(asserted: AlignedPose, size_m: Size | None) -> Pose:
    """Return the pose of the bottom centre of an entity of this size."""
    return Pose(
        position_m=shift_along_z(
            asserted.position, asserted.orientation, -_origin_height(asserted.words, size_m)
        ),
        orientation_wxyz=asserted.orientation,
    )


def size(alignments: Iterable[Alignment], about: About, iri: Term) -> Size | None:
    """Return the size of an entity, or None."""
    asserted = find_size(alignments, about, iri)
    return None if asserted is None else asserted.size_m


def labels(alignments: Iterable[Alignment], about: About, iri: Term) -> list[str]:
    """Return the texts that name an entity, best first: names of the vocabularies, `prefLabel`, `label`.

    Of several languages English comes first, then texts without a language, then the others.
    """
    return [*_names(alignments, about, iri), *stated_labels(about(iri))]


def stated_labels(asserted: Mapping[Term, Sequence[Term]]) -> list[str]:
    """Return the texts that name an entity in any vocabulary: `prefLabel`, `label`."""
    return _texts(asserted, _LABELS)


def _names(alignments: Iterable[Alignment], about: About, iri: Term) -> Iterator[str]:
    """Yield the names of an entity in the vocabularies of alignments."""
    for known in alignments:
        yield from _texts(about(iri), known.names)
        for words in known.named:
            for nodes in _paths(about, iri, words.path):
                yield from _texts(about(nodes[-1]), (words.text,))


def aliases(asserted: Mapping[Term, Sequence[Term]]) -> list[str]:
    """Return the texts that also name an entity (`skos:altLabel`)."""
    return _texts(asserted, (v.SKOS_ALT_LABEL,))


def _texts(asserted: Mapping[Term, Sequence[Term]], properties: Iterable[Term]) -> list[str]:
    """Return the texts of some properties, each once."""
    found = (o for p in properties for o in sorted(asserted.get(p, ()), key=_language_order))
    return list(dict.fromkeys(v.lexical(o) for o in found if o.startswith('"')))


def _language_order(term: Term) -> tuple[bool, str, Term]:
    """Return the key by which texts are sorted: English, no language, other languages."""
    language = v.language_of(term) or ""
    return not (language == "en" or language.startswith("en-")), language, term


def find_pose(alignments: Iterable[Alignment], about: About, iri: Term) -> AlignedPose | None:
    """Return the first valid pose; poses relative to another frame are ignored."""
    return next(find_poses(alignments, about, iri), None)


def find_poses(alignments: Iterable[Alignment], about: About, iri: Term) -> Iterator[AlignedPose]:
    """Yield all valid poses in the map frame."""
    return (found for found in find_stated_poses(alignments, about, iri) if found.reference is None)


def find_stated_poses(alignments: Iterable[Alignment], about: About, iri: Term) -> Iterator[AlignedPose]:
    """Yield all valid poses, also those in the frames of other things."""
    for words in (words for known in alignments for words in known.pose):
        for nodes in _paths(about, iri, words.path):
            values = about(nodes[-1])
            if (pose := read_pose(values, words)) is not None:
                reference = min(values.get(words.relative, ()), default=None) if words.relative else None
                yield AlignedPose(words, nodes, pose.position_m, pose.orientation_wxyz, reference)


def find_pose_owners(
    forms: Iterable[PoseMapping], subjects: Iterable[Term], about: About
) -> Iterator[tuple[Term, Term]]:
    """Yield the individuals with a node for their pose, valid or not, and this node."""
    for words in forms:
        for subject in subjects:
            yield from ((subject, nodes[-1]) for nodes in _paths(about, subject, words.path))


def read_pose(values: Mapping[Term, Sequence[Term]], words: PoseMapping) -> Pose | None:
    """Return the pose that an individual has by its properties, or None if it is incomplete or invalid."""
    position = _vector(values.get(words.position, ()), 3)
    if position is None:
        return None
    turned = _vector(values.get(words.orientation, ()), 4) if words.orientation is not None else None
    orientation = _quaternion(turned, words) if turned is not None else IDENTITY
    if orientation is None:
        return None
    x, y, z = position
    return Pose(position_m=(x, y, z), orientation_wxyz=orientation)


def read_matrix(values: Mapping[Term, Sequence[Term]], stem: Term) -> Pose | None:
    """Return the pose that an individual has as a matrix of 4 x 4 numbers, or None if it is not a pose.

    The properties of its numbers are called like `stem` with the row and the column: `m00` to `m23`.
    """
    rows: list[list[float]] = []
    for row in range(3):
        found = [_vector(values.get(f"{stem[:-1]}{row}{column}>", ()), 1) for column in range(4)]
        rows.append([number[0] for number in found if number is not None])
    if any(len(row) != 4 for row in rows):
        return None
    orientation = quaternion_of(rows)
    if orientation is None:
        return None
    return Pose(position_m=(rows[0][3], rows[1][3], rows[2][3]), orientation_wxyz=orientation)


def quaternion_of(rows: Sequence[Sequence[float]]) -> Quaternion | None:
    """Return the unit quaternion `wxyz` of a rotation matrix, or None if it is not one."""
    (a, b, c), (d, e, f), (g, h, i) = (row[:3] for row in rows)
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    columns = ((a, d, g), (b, e, h), (c, f, i))
    products = [sum(x * y for x, y in zip(columns[j], columns[k], strict=True)) for j, k in _PAIRS]
    wanted = [float(j == k) for j, k in _PAIRS]
    if determinant < 0 or any(abs(p - w) > _ROTATION for p, w in zip(products, wanted, strict=True)):
        return None
    candidates = (  # the one with the largest divisor is the most accurate
        (1 + a + e + i, h - f, c - g, d - b),
        (h - f, 1 + a - e - i, b + d, c + g),
        (c - g, b + d, 1 - a + e - i, f + h),
        (d - b, c + g, f + h, 1 - a - e + i),
    )
    w, x, y, z = max(candidates, key=lambda q: math.hypot(*q))
    norm = math.copysign(math.hypot(w, x, y, z), w or 1.0)
    return (w / norm, x / norm, y / norm, z / norm)


def find_size(alignments: Iterable[Alignment], about: About, iri: Term) -> AlignedSize | None:
    """Return the first size that is complete and positive."""
    return next(find_sizes(alignments, about, iri), None)


def find_sizes(alignments: Iterable[Alignment], about: About, iri: Term) -> Iterator[AlignedSize]:
    """Yield all sizes that are complete and positive."""
    for words in (words for known in alignments for words in known.size):
        for nodes in _paths(about, iri, words.path):
            values = about(nodes[-1])
            found = [_vector(values.get(p, ()), 1) for p in (words.x, words.y, words.z)]
            extent = tuple(number[0] for number in found if number is not None and number[0] > 0)
            if len(extent) == 3:
                yield AlignedSize(words, nodes, extent)


def value_triples(asserted: AlignedPose | AlignedSize, about: About) -> list[Triple]:
    """Return the triples with the numbers of a pose or size."""
    node, words = asserted.nodes[-1], asserted.words
    numbers = (
        (words.position, words.orientation) if isinstance(words, PoseMapping) else (words.x, words.y, words.z)
    )
    values = about(node)
    return [(node, p, o) for p in numbers if p is not None for o in values.get(p, ())]


def pose_triples(
    asserted: AlignedPose, pose: Pose, size_m: Size | None, about: About
) -> tuple[list[Triple], list[Triple]]:
    """Return the removed and the added triples for a new pose at the same individual."""
    node, words = asserted.nodes[-1], asserted.words
    position = shift_along_z(pose.position_m, pose.orientation_wxyz, _origin_height(words, size_m))
    new: list[tuple[Term, tuple[float, ...]]] = [(words.position, position)]
    if words.orientation is not None:
        w, x, y, z = pose.orientation_wxyz
        new.append((words.orientation, (x, y, z, w) if words.order == "xyzw" else (w, x, y, z)))
    return _replace_numbers(node, new, about)


def size_triples(asserted: AlignedSize, size_m: Size, about: About) -> tuple[list[Triple], list[Triple]]:
    """Return the removed and the added triples for a new size at the same individual."""
    words = asserted.words
    new = zip((words.x, words.y, words.z), size_m, strict=True)
    return _replace_numbers(asserted.nodes[-1], [(p, (value,)) for p, value in new], about)


def shift_along_z(position: Vector, orientation_wxyz: Quaternion, height_m: float) -> Vector:
    """Return `position` moved along the entity's z axis [m], rounded to 1e-9 m."""
    w, x, y, z = orientation_wxyz
    up = (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y))
    moved = [round(p + height_m * axis, 9) for p, axis in zip(position, up, strict=True)]
    return (moved[0], moved[1], moved[2])


def _origin_height(words: PoseMapping, size_m: Size | None) -> float:
    """Return the height of the pose's origin above the bottom [m]."""
    return size_m[2] / 2.0 if words.origin == "middle" and size_m is not None else 0.0


def _paths(about: About, iri: Term, path: Sequence[Term]) -> Iterator[tuple[Term, ...]]:
    """Yield the individuals along a path, the smallest ones first."""
    if not path:
        yield (iri,)
        return
    for node in sorted(about(iri).get(path[0], ())):
        if not node.startswith('"'):
            yield from ((iri, *way) for way in _paths(about, node, path[1:]))


def _vector(objects: Sequence[Term], count: int) -> tuple[float, ...] | None:
    """Return the numbers of the smallest literal with `count` numbers in the valid range."""
    for term in sorted(objects):
        if term.startswith('"'):
            words = [word for word in _BETWEEN.split(v.lexical(term)) if word]
            try:
                numbers = tuple(map(float, words))
            except ValueError:
                continue
            if len(numbers) == count and all(abs(number) <= REACH_M for number in numbers):
                return numbers
    return None


def _quaternion(numbers: tuple[float, ...], words: PoseMapping) -> Quaternion | None:
    """Return the unit quaternion `wxyz`, or None if the norm is far from one."""
    w, x, y, z = (numbers[3], *numbers[:3]) if words.order == "xyzw" else numbers
    norm = math.hypot(w, x, y, z)
    if not 0.9 <= norm <= 1.1:
        return None
    return (w / norm, x / norm, y / norm, z / norm)


def _replace_numbers(
    node: Term, new: Iterable[tuple[Term, tuple[float, ...]]], about: About
) -> tuple[list[Triple], list[Triple]]:
    """Return the removed and the added literals; the datatypes stay."""
    removed: list[Triple] = []
    added: list[Triple] = []
    asserted = about(node)
    for predicate, numbers in new:
        before = sorted(asserted.get(predicate, ()))
        removed += [(node, predicate, o) for o in before]
        datatype = v.datatype_of(before[0]) if before and before[0].startswith('"') else None
        text = " ".join(repr(float(number)) for number in numbers)
        added.append((node, predicate, v.literal(text, datatype)))
    return removed, added
