"""The indispensable steps of loading a large file, each measured alone: parsing, messages, compression, disk.

They are measured in the same run, in a separate process, with the fastest libraries.
"""

from __future__ import annotations

import os
import time
import zlib
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple, TypeVar

import pyoxigraph

from benchmarks.kb import big_files
from benchmarks.kb.made import timed
from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import codec, scene_files
from semmap.schemas.commits import NewEntity, Snapshot, Transaction
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.explanations import Triple

_AT_ONCE = 5000
"""Entities and triples per message."""

T = TypeVar("T")


class Limits(NamedTuple):
    """CPU times [s], except for the disk's."""

    turtle_s: float
    """Oxigraph parses the Turtle and creates one Python object per triple, which is discarded."""
    json_s: float | None
    """msgspec parses the scene into our messages; None without a scene."""
    messages_s: float
    """The new entities are encoded and decoded once for the request and once for the reply."""
    compress_s: float
    """zlib compresses the triples in the journal's encoding."""
    disk_s: float
    """Wall time for writing the compressed data to a new file and syncing it."""


def measure(folder: Path, size: int, turtle: Path, scene: Path | None) -> Limits:
    """Measure the limits for these files of `size` entities; `folder` is on the measured disk."""
    turtle_s = _cpu_s(lambda: deque(pyoxigraph.parse(path=turtle, format=pyoxigraph.RdfFormat.TURTLE), 0))
    json_s = None if scene is None else _cpu_s(lambda: scene_files.read(scene.read_bytes(), scene.name))
    messages_s = 0.0
    for some in _parts(big_files.things(size)):
        change = Transaction(id="1", source="file", add=tuple(map(_new, some)))
        page = Snapshot(seq=1, entities=tuple(map(_entity, some)))
        messages_s += _cpu_s(lambda m=change: codec.decode(codec.encode(m), Transaction))  # type: ignore[misc]
        messages_s += _cpu_s(lambda m=page: codec.decode(codec.encode(m), Snapshot))  # type: ignore[misc]
    compress_s, packed = 0.0, bytearray()
    deflate = zlib.compressobj(body_encoding.COMPRESSION_LEVEL)
    for triples in _parts(triple for thing in big_files.things(size) for triple in _star(thing)):
        body = codec.encode(triples)
        compress_s += _cpu_s(lambda body=body: packed.extend(deflate.compress(body)))  # type: ignore[misc]
    packed += deflate.flush()
    disk_s = timed(lambda: _write(folder / "limit", bytes(packed)))
    return Limits(turtle_s, json_s, messages_s, compress_s, disk_s)


def _cpu_s(function: Callable[[], object]) -> float:
    before_s = time.process_time()
    function()
    return time.process_time() - before_s


def _parts(items: Iterator[T]) -> Iterator[tuple[T, ...]]:
    part: list[T] = []
    for item in items:
        part.append(item)
        if len(part) == _AT_ONCE:
            yield tuple(part)
            part.clear()
    if part:
        yield tuple(part)


def _star(thing: big_files.Thing) -> list[Triple]:
    return entity_triples.describe(
        thing.name, v.dm(thing.class_name), pose=thing.pose, size_m=thing.size_m, preferred=thing.ref
    )


def _new(thing: big_files.Thing) -> NewEntity:
    iri = v.bare(v.dm(thing.class_name))
    return NewEntity(name=thing.name, class_iri=iri, pose=thing.pose, size=thing.size_m, ref=thing.ref)


def _entity(thing: big_files.Thing) -> Entity:
    made = Provenance(commit=1, stamp_ns=time.time_ns(), source="file", reason="load things.json")
    return Entity(
        name=thing.name,
        class_=thing.class_name,
        iri=v.bare(v.entity_iri(thing.name)),
        types=(thing.class_name, "Object", "Thing"),
        pose=thing.pose,
        size_m=thing.size_m,
        preferred_reference=thing.ref,
        provenance=made,
        pose_provenance=made,
        shape_provenance=made,
        reference_provenance=made,
    )


def _write(path: Path, content: bytes) -> None:
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fdatasync(file.fileno())
    path.unlink()
