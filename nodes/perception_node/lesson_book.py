"""The lessons of a data folder: kept in one file, added and forgotten."""

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

from semmap.nodes.perception_node.recognition import likeness
from semmap.nodes.perception_node.recognition.lessons import Lesson, taught
from semmap.nodes.perception_node.recognition.likeness import WIDTH
from semmap.nodes.perception_node.recognition.shipped_votes import CLUTTER, UNKNOWN, Learnt
from semmap.nodes.perception_node.showing import View
from semmap.schemas.entities import Size
from semmap.schemas.errors import BadFile, BadRequest, Refused, did_you_mean
from semmap.schemas.exemplars import LessonTold

FILENAME = "lessons.npz"
_MOST = 500
"""Lessons: each is compared with each thing of a look."""


class _Entry(msgspec.Struct, frozen=True, kw_only=True):
    """What the file says of a lesson, beside its views."""

    number: int
    class_: str
    ancestors: tuple[str, ...]
    views: int
    size_m: Size
    shown: str
    stamp_ns: int


class LessonBook:
    """What was shown to one system, in order; without a file nothing is kept. Bound to one thread."""

    def __init__(self, path: Path | None, learnt: Learnt) -> None:
        """`learnt`: by training. Raises BadFile when the file is there, and is none of lessons."""
        self._path = path
        self._bare = learnt
        self._lessons: tuple[Lesson, ...] = () if path is None else _read(path)
        self._learnt = self._put_together()

    @property
    def learnt(self) -> Learnt:
        """What was learnt by training and by being shown."""
        return self._learnt

    @property
    def lessons(self) -> tuple[LessonTold, ...]:
        """All of them, in order."""
        return tuple(map(_told, self._lessons))

    def add(self, class_: str, ancestors: Sequence[str], views: Sequence[View], shown: str) -> LessonTold:
        """Remember a thing of a class. Raises BadRequest for what is none, Refused when there are many."""
        if class_ in (UNKNOWN, CLUTTER):
            raise BadRequest(f"everything is of class '{class_}'; say which special class it is of")
        if len(self._lessons) >= _MOST:
            raise Refused(f"{_MOST} lessons are remembered already; first forget some: semmap forget NUMBER")
        features = np.array([view.features for view in views], np.float32).astype(float)
        if features.ndim != 2 or features.shape[1] != WIDTH or not np.isfinite(features).all():
            raise BadRequest(
                f"a view has {WIDTH} numbers in this version of perception; show the thing with the same one"
            )
        long, short, height = np.median([view.size_m for view in views], axis=0).tolist()
        lesson = Lesson(
            number=max((one.number for one in self._lessons), default=0) + 1,
            class_=class_,
            ancestors=tuple(ancestors),
            views=features,
            size_m=(long, short, height),
            shown=shown,
            stamp_ns=time.time_ns(),
        )
        self._keep((*self._lessons, lesson))
        return _told(lesson)

    def forget(self, number: int) -> LessonTold:
        """Undo a lesson. Raises Refused when there is none of that number."""
        found = [lesson for lesson in self._lessons if lesson.number == number]
        if not found:
            numbers = ", ".join(str(lesson.number) for lesson in self._lessons)
            there = f"there are: {numbers}" if numbers else "nothing was shown"
            raise Refused(f"there is no lesson {number}; {there}")
        self._keep(tuple(lesson for lesson in self._lessons if lesson.number != number))
        return _told(found[0])

    def _keep(self, lessons: tuple[Lesson, ...]) -> None:
        if self._path is not None:
            _write(self._path, lessons)
        self._lessons = lessons
        self._learnt = self._put_together()

    def _put_together(self) -> Learnt:
        return taught(self._bare, self._lessons, likeness.shipped()) if self._lessons else self._bare


def known_class(word: str, ancestors: Mapping[str, Sequence[str]]) -> str:
    """The class that a word means, whatever its case, of those that the TBox had at training.

    Raises BadRequest with the nearest names for none.
    """
    plain = {_plain(name): name for name in ancestors}
    if word in ancestors:
        return word
    if (found := plain.get(_plain(word))) is not None:
        return found
    raise BadRequest(
        f"unknown class '{word}'{did_you_mean(word, ancestors)}; a class of your own comes with a TBox:"
        " start its system (semmap up --tbox FILE --perception) and leave out --data"
    )


def _plain(word: str) -> str:
    return "".join(c for c in word.casefold() if c.isalnum())


def _told(lesson: Lesson) -> LessonTold:
    return LessonTold(
        number=lesson.number,
        class_=lesson.class_,
        views=len(lesson.views),
        size_m=lesson.size_m,
        shown=lesson.shown,
        stamp_ns=lesson.stamp_ns,
    )


def _read(path: Path) -> tuple[Lesson, ...]:
    """What `_write` wrote; nothing where there is no file. Raises BadFile."""
    if not path.exists():
        return ()
    try:
        with np.load(path, allow_pickle=False) as arrays:
            entries = msgspec.json.decode(str(arrays["description"]), type=list[_Entry])
            views = arrays["views"].astype(float)
        counts = [entry.views for entry in entries]
        if views.shape != (sum(counts), WIDTH):
            raise ValueError("its views are those of another version")
    except (OSError, EOFError, ValueError, KeyError) as error:  # msgspec's errors are ValueErrors
        raise BadFile(
            f"{path} does not hold lessons of this version ({error}); move it away and show the things again"
        ) from None
    parts = [views[end - count : end] for end, count in zip(np.cumsum(counts), counts, strict=True)]
    return tuple(
        Lesson(**{**msgspec.structs.asdict(entry), "views": part})
        for entry, part in zip(entries, parts, strict=True)
    )


def _write(path: Path, lessons: Sequence[Lesson]) -> None:
    """All of them, or the file remains as it was. Raises BadFile."""
    entries = [
        {name: getattr(lesson, name) for name in _Entry.__struct_fields__ if name != "views"}
        | {"views": len(lesson.views)}
        for lesson in lessons
    ]
    views = [lesson.views for lesson in lessons]
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        description=np.array(json.dumps(entries)),
        views=np.concatenate([*views, np.empty((0, WIDTH))]).astype(np.float32),
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
