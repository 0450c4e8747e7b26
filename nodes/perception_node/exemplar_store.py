"""The exemplars of a data folder, stored in one file."""

from __future__ import annotations

import io
import json
import os
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.exemplar_views import ExemplarView
from semmap.nodes.perception_node.image_features.efficientnet import FEATURES
from semmap.nodes.perception_node.recognition import similarity
from semmap.nodes.perception_node.recognition.exemplars import Exemplar, with_exemplars
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.schemas.entities import Size
from semmap.schemas.errors import BadFile, BadRequest, Refused, did_you_mean
from semmap.schemas.exemplars import LessonTold
from semmap.schemas.wording import few

FILENAME = "lessons.npz"
_MOST = 500
"""The maximum number of exemplars. Each is compared with each thing of a frame."""


class _Entry(msgspec.Struct, frozen=True, kw_only=True):
    """The metadata of an exemplar in the file, without its views."""

    number: int
    class_: str
    ancestors: tuple[str, ...]
    views: int
    size_m: Size
    shown: str
    stamp_ns: int


class ExemplarStore:
    """The exemplars of one system, in order. Without a file, they are lost at exit. Bound to one thread."""

    def __init__(self, path: Path | None, learnt: RecognitionModel) -> None:
        """Load the exemplars.

        `learnt` is the trained model. Raises BadFile if the file exists and is invalid.
        """
        self._path = path
        self._trained = learnt
        self._exemplars: tuple[Exemplar, ...] = () if path is None else _read(path)
        self._learnt = self._build_model()

    @property
    def learnt(self) -> RecognitionModel:
        """Return the trained model extended by the exemplars."""
        return self._learnt

    @property
    def exemplars(self) -> tuple[LessonTold, ...]:
        """Return all exemplars, in order."""
        return tuple(map(_to_message, self._exemplars))

    def add(
        self, class_: str, ancestors: Sequence[str], views: Sequence[ExemplarView], shown: str
    ) -> LessonTold:
        """Store an exemplar of a class.

        Raises BadRequest for an invalid class or view, and Refused if the store is full.
        """
        if class_ in (UNKNOWN, CLUTTER):
            raise BadRequest(f"class '{class_}' is too general; name a more specific class")
        if len(self._exemplars) >= _MOST:
            raise Refused(
                f"the limit of {_MOST} exemplars is reached; remove some with: semmap forget NUMBER"
            )
        features, images = [view.features for view in views], [view.image for view in views]
        if not views or not (_are_rows(features, WIDTH) and _are_rows(images, FEATURES)):
            raise BadRequest(f"a view must have {WIDTH} features; create it with the same version of semmap")
        long, short, height = np.median([view.size_m for view in views], axis=0).tolist()
        exemplar = Exemplar(
            number=max((one.number for one in self._exemplars), default=0) + 1,
            class_=class_,
            ancestors=tuple(ancestors),
            views=np.array(features, np.float32).astype(float),
            size_m=(long, short, height),
            shown=shown,
            stamp_ns=time.time_ns(),
            images=np.array(images, np.float32).astype(float),
        )
        self._keep((*self._exemplars, exemplar))
        return _to_message(exemplar)

    def forget(self, number: int) -> LessonTold:
        """Remove an exemplar. Raises Refused if no exemplar has this number."""
        found = [exemplar for exemplar in self._exemplars if exemplar.number == number]
        if not found:
            stored = [str(exemplar.number) for exemplar in self._exemplars]
            there = f"stored are: {few(stored)}" if stored else "none is stored"
            raise Refused(f"no exemplar with number {number}; {there}")
        self._keep(tuple(exemplar for exemplar in self._exemplars if exemplar.number != number))
        return _to_message(found[0])

    def _keep(self, exemplars: tuple[Exemplar, ...]) -> None:
        if self._path is not None:
            _write(self._path, exemplars)
        self._exemplars = exemplars
        self._learnt = self._build_model()

    def _build_model(self) -> RecognitionModel:
        return (
            with_exemplars(self._trained, self._exemplars, similarity.shipped())
            if self._exemplars
            else self._trained
        )


def known_class(word: str, ancestors: Mapping[str, Sequence[str]]) -> str:
    """Return the class that `word` names, ignoring case, among the classes known at training.

    Raises BadRequest with the nearest names for an unknown class.
    """
    plain = {_plain(name): name for name in ancestors}
    if word in ancestors:
        return word
    if (found := plain.get(_plain(word))) is not None:
        return found
    raise BadRequest(
        f"unknown class '{word}'{did_you_mean(word, ancestors)}; to make a new class below Object, add"
        " --new-class; for one of your own TBox, start the system (semmap up --tbox FILE) and omit --data"
    )


def _are_rows(features: Sequence[NDArray[np.floating]], width: int) -> bool:
    return all(row.shape == (width,) and np.isfinite(row).all() for row in features)


def _plain(word: str) -> str:
    return "".join(c for c in word.casefold() if c.isalnum())


def _to_message(exemplar: Exemplar) -> LessonTold:
    return LessonTold(
        number=exemplar.number,
        class_=exemplar.class_,
        views=len(exemplar.views),
        size_m=exemplar.size_m,
        shown=exemplar.shown,
        stamp_ns=exemplar.stamp_ns,
    )


def _read(path: Path) -> tuple[Exemplar, ...]:
    """Read the file that `_write` writes; return no exemplars if there is none. Raises BadFile."""
    if not path.exists():
        return ()
    try:
        with np.load(path, allow_pickle=False) as arrays:
            entries = msgspec.json.decode(str(arrays["description"]), type=list[_Entry])
            views = arrays["views"].astype(float)
            images = np.zeros((len(views), FEATURES))  # of files without images
            if "images" in arrays:
                images[:] = arrays["images"]
        counts = [entry.views for entry in entries]
        if views.shape != (sum(counts), WIDTH):
            raise ValueError("its views are of another version")
    except (OSError, EOFError, ValueError, KeyError) as error:  # msgspec's errors are ValueErrors
        raise BadFile(
            f"{path} has no exemplars of this version ({error}); move it away and repeat `semmap learn`"
        ) from None
    parts = [slice(end - count, end) for end, count in zip(np.cumsum(counts), counts, strict=True)]
    return tuple(
        Exemplar(**msgspec.structs.asdict(entry) | {"views": views[part], "images": images[part]})
        for entry, part in zip(entries, parts, strict=True)
    )


def _write(path: Path, exemplars: Sequence[Exemplar]) -> None:
    """Write all exemplars; on an error, the old file remains. Raises BadFile."""
    entries = [
        {name: getattr(exemplar, name) for name in _Entry.__struct_fields__ if name != "views"}
        | {"views": len(exemplar.views)}
        for exemplar in exemplars
    ]
    views, images = ([getattr(one, name) for one in exemplars] for name in ("views", "images"))
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        description=np.array(json.dumps(entries)),
        views=np.concatenate([*views, np.empty((0, WIDTH))]).astype(np.float32),
        images=np.concatenate([*images, np.empty((0, FEATURES))]).astype(np.float32),
    )
    beside = path.with_name(f"{path.name}.partly")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with beside.open("wb") as file:
            file.write(buffer.getvalue())
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except OSError as error:
        with suppress(OSError):
            beside.unlink()
        raise BadFile(f"{path} cannot be written: {error.strerror}") from None
