"""The recording: an .rrd file, also streamed to live viewers."""

from __future__ import annotations

import itertools
import socket
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from semmap.nodes.drawing.figures import Figure
from semmap.nodes.drawing.neighbourhood import Neighbourhood
from semmap.nodes.recorder import commit_text
from semmap.nodes.recorder.drawing.blueprint import bounds_of, layout
from semmap.nodes.recorder.drawing.geometry import (
    leaf_paths_of,
    leaf_shapes_of,
    leaf_transforms_of,
    shape_of,
)
from semmap.nodes.recorder.drawing.graph import nodes_and_edges
from semmap.schemas import errors
from semmap.schemas.commits import Commit, PlaceChanges
from semmap.schemas.entities import Pose
from semmap.schemas.explanations import Triple

APPLICATION = "semmap"
COMMITS = "commits"
COMMIT_LOG = "commits/log"
COMMIT_FIELDS = "semmap.Commit"
"""The archetype with a commit's fields for programs; see `recorded_commits.read_commits`."""

_LATENCY_S = 0.5
"""Data that a kill can lose, and the lag of a live viewer."""
_LIVE_MEMORY = "256MiB"


class Recording:
    """The recorded drawing and log. Timelines: `commit` (sequence), `time` (wall), `sim_time`."""

    def __init__(self, path: Path, stream: rr.RecordingStream) -> None:
        self.path = path
        self.logged = 0
        """The number of records so far."""
        self._stream = stream
        self._in_view: list[Pose] = []
        self._cameras: list[str] = []
        self.arrange()
        stream.log("map", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def set_time(self, seq: int, stamp_ns: int, sim_time_s: float | None) -> None:
        """Set the time of the following records: after commit `seq`, at this wall time and simulated time."""
        self._stream.reset_time()
        self._stream.set_time("commit", sequence=seq)
        self._stream.set_time("time", timestamp=stamp_ns / 1e9)
        if sim_time_s is not None:
            self._stream.set_time("sim_time", duration=sim_time_s)

    def arrange(self, poses: Iterable[Pose] = (), cameras: Iterable[str] = ()) -> None:
        """Extend the layout of the viewer by these poses and camera images."""
        self._in_view.extend(poses)
        self._cameras = sorted({*self._cameras, *cameras})
        self._stream.send_blueprint(layout(bounds_of(self._in_view), self._cameras))

    def draw(self, name: str, figure: Figure, pose: Pose) -> None:
        """Draw a figure at a pose, with its joints."""
        path = ["map", figure.group, name]
        self._log(path, *shape_of(figure), _transform(pose))
        for leaf, shape in zip(leaf_paths_of(figure), leaf_shapes_of(figure), strict=False):
            if shape:
                self._log([*path, *leaf], *shape)
        self.bend(name, figure)

    def bend(self, name: str, figure: Figure) -> None:
        """Move the leaves of a figure by its joints."""
        path = ["map", figure.group, name]
        for leaf, transform in zip(leaf_paths_of(figure), leaf_transforms_of(figure), strict=False):
            self._log([*path, *leaf], transform)

    def move(self, name: str, figure: Figure, pose: Pose) -> None:
        """Move a figure to a pose."""
        self._log(["map", figure.group, name], _transform(pose))

    def erase(self, name: str, figure: Figure) -> None:
        """Remove a figure."""
        self._log(["map", figure.group, name], rr.Clear(recursive=True))

    def show(self, path: str, *archetypes: rr.AsComponents) -> None:
        """Draw results of perception."""
        self._log(path, *archetypes)

    def graph(self, graph: Neighbourhood) -> None:
        """Draw a part of the knowledge graph."""
        self._log("graph", *nodes_and_edges(graph))

    def commit(self, commit: Commit) -> None:
        """Record a commit: as a page, as a log line, and as fields for programs."""
        self._log(
            COMMITS,
            rr.TextDocument(commit_text.page(commit), media_type=rr.MediaType.MARKDOWN),
            rr.DynamicArchetype(COMMIT_FIELDS, components=_fields(commit)),
        )
        self._log(COMMIT_LOG, rr.TextLog(commit_text.headline(commit), level=rr.TextLogLevel.INFO))

    def _log(self, path: str | list[str], *archetypes: rr.AsComponents) -> None:
        self.logged += 1
        self._stream.log(path, *archetypes)

    def note(self, text: str, *, warning: bool = False) -> None:
        """Log a note on the recording itself."""
        level = rr.TextLogLevel.WARN if warning else rr.TextLogLevel.INFO
        self._log(COMMIT_LOG, rr.TextLog(text, level=level))


def _transform(pose: Pose) -> rr.Transform3D:
    w, x, y, z = pose.orientation_wxyz
    return rr.Transform3D(translation=pose.position_m, quaternion=rr.Quaternion(xyzw=(x, y, z, w)))


def _fields(commit: Commit) -> dict[str, NDArray[Any]]:
    places = commit.places or PlaceChanges()
    texts = {
        "id": [commit.id],
        "source": [commit.source],
        "agent": [commit.agent],
        "reason": [commit.reason],
        "inserted": [_line(triple) for triple in commit.inserted],
        "retracted": [_line(triple) for triple in commit.retracted],
        "came": [_line(triple) for triple in places.came],
        "went": [_line(triple) for triple in places.went],
        "changed": [entity.name for entity in commit.changed],
        "removed": [gone.name for gone in commit.removed],
    }
    numbers = {"seq": commit.seq, "stamp_ns": commit.stamp_ns}
    return {key: np.array([number]) for key, number in numbers.items()} | {
        key: np.array(values, dtype=np.str_) for key, values in texts.items()
    }


def _line(triple: Triple) -> str:
    """Format a triple as a line of N-Triples."""
    return " ".join((*triple, "."))


def free_to_serve(address: str) -> bool:
    """Return whether `address` (`host:port`) is free. Rerun itself only logs an error."""
    host, _, port = address.rpartition(":")
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, int(port)))
        except OSError:
            return False
    return True


def create(path: Path) -> Path:
    """Create an empty file at `path`, or under a numbered name if `path` exists. Raises BadFile."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for number in itertools.count(1):
            candidate = path if number == 1 else path.with_stem(f"{path.stem}-{number}")
            if not candidate.exists():
                break
        candidate.touch(exist_ok=False)
    except OSError as error:
        raise errors.BadFile(f"cannot write recording {path}: {error.strerror}") from None
    return candidate


@contextmanager
def open_recording(path: Path, serve: str | None) -> Iterator[Recording]:
    """Open a recording to `path`, also served to live viewers at `serve`. It is complete when closed.

    Raises BadFile if the file cannot be written.
    """
    path = create(path)
    batches = rr.ChunkBatcherConfig(flush_tick=_LATENCY_S)
    stream = rr.RecordingStream(APPLICATION, batcher_config=batches)
    stream.set_log_time_enabled(False)
    sinks: list[rr.FileSink | rr.GrpcServerSink] = [rr.FileSink(path)]
    if serve is not None:
        host, _, port = serve.rpartition(":")
        sinks.append(rr.GrpcServerSink(host, int(port), server_memory_limit=_LIVE_MEMORY))
    stream.set_sinks(*sinks)
    try:
        yield Recording(path, stream)
    finally:
        stream.disconnect()
