"""The commands that add exemplars to perception: `learn`, `learned`, `forget`."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import (
    INPUT_PATH,
    connect_option,
    identity_option,
    namespace_option,
    print_error,
    print_json,
)
from semmap.nodes.extern.cli.new_class import ABOVE, class_name, declare_class, find_class
from semmap.nodes.extern.cli.output import show
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.output.tables import table
from semmap.nodes.extern.cli.shell_completion import class_names, entity_names
from semmap.nodes.runtime import extras
from semmap.schemas import errors
from semmap.schemas.commands import Load
from semmap.schemas.exemplars import LessonTold
from semmap.schemas.wording import counted

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.nodes.perception_node.exemplar_store import ExemplarStore
    from semmap.nodes.perception_node.exemplar_views import ExemplarView

_path = click.Path(path_type=Path)


def _where(function: Callable[..., None]) -> Callable[..., None]:
    """Add the options that select the exemplars: those of a running system, or of a data folder."""

    @click.option(
        "--data",
        type=_path,
        help="Use the exemplars in this data folder, for perceive --data. Default: a running system.",
    )
    @click.option(
        "--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True
    )
    @connect_option
    @identity_option
    @namespace_option
    @functools.wraps(function)
    def with_options(**arguments: Any) -> None:
        function(**arguments)

    return with_options


@command(example="semmap learn Cup --frames frames/mug")
@click.argument("class_", metavar="CLASS", shell_complete=class_names)
@click.option("--frames", metavar="DIR", type=INPUT_PATH, help="Folders of frames, as for perceive --frames.")
@click.option(
    "--entity", metavar="NAME", shell_complete=entity_names, help="Entity that perception currently observes."
)
@click.option(
    "--box",
    nargs=4,
    type=int,
    metavar="X0 Y0 X1 Y1",
    help="With --frames: object in this box [pixel]. Default: the largest compact object.",
)
@click.option("--new-class", is_flag=True, help="Add CLASS to the TBox, below Object, if it is missing.")
@_where
def learn(
    class_: str,
    frames: Path | None,
    entity: str | None,
    box: tuple[int, int, int, int] | None,
    new_class: bool,
    data: Path | None,
    format: str,
    **system: Any,
) -> None:
    """Add an object as an exemplar that perception recognizes.

    One frame is enough; more frames from other sides and distances improve recognition. The object must stand
    by itself on a table or the floor. CLASS is any object class of the TBox, including classes without
    training data. With --new-class, "power drill" becomes a class below Object, in one commit, if the TBox
    has none. No model is retrained: similar objects are assigned to CLASS in addition to known classes.
    """
    if (frames is None) == (entity is None):
        raise errors.BadRequest("use either --frames DIR or --entity NAME")
    if box is not None and frames is None:
        raise errors.BadRequest("--box requires --frames")
    if data is not None and frames is None:
        raise errors.BadRequest("--entity requires a running system; with --data, use --frames DIR")
    views: list[ExemplarView] = []
    notes: tuple[str, ...] = ()
    shown = ""
    if data is not None:
        book, (class_, ancestors) = _book(data), _known(class_, new=new_class)
    if frames is not None:
        views, notes = _read_views(frames, box)
        shown = f"{counted(len(views), 'frame')} in {frames}"
    if data is not None:
        lesson = book.add(class_, ancestors, views, shown)
    else:
        with _client(**system) as client:
            if new_class:
                class_ = _add_class(client, class_)
            lesson = _learn(client, class_, entity, views, shown)
    for note in notes:
        print_error(note)
    if format == "json":
        print_json(lesson)
        return
    size = " x ".join(f"{side:.3f}" for side in lesson.size_m)
    print_escaped(
        f"learned {lesson.class_} from {lesson.shown} ({size} m); to undo: semmap forget {lesson.number}"
    )


@command(example="semmap learned")
@_where
def learned(data: Path | None, format: str, **system: Any) -> None:
    """List the exemplars of perception."""
    if data is not None:
        lessons = _book(data).exemplars
    else:
        with _client(**system) as client:
            lessons = client.learned()
    if format == "json":
        print_json(lessons)
        return
    if not lessons:
        print_escaped("no exemplars")
        return
    rows = table("number", "class", "size [m]", "views", "source", fold=("source",))
    for lesson in lessons:
        size = " x ".join(f"{side:.3f}" for side in lesson.size_m)
        rows.add(str(lesson.number), lesson.class_, size, str(lesson.views), lesson.shown)
    show.console().print(rows)


@command(example="semmap forget 3")
@click.argument("number", type=click.IntRange(min=1))
@_where
def forget(number: int, data: Path | None, format: str, **system: Any) -> None:
    """Remove an exemplar; semmap learned lists the numbers."""
    if data is not None:
        lesson = _book(data).forget(number)
    else:
        with _client(**system) as client:
            lesson = client.forget(number=number)
    if format == "json":
        print_json(lesson)
    else:
        print_escaped(f"forgot {lesson.class_} from {lesson.shown}")


@contextmanager
def _client(where: str | None, identity: str | None, namespace: str | None) -> Iterator[Client]:
    from semmap.nodes.extern.client import connect

    with connect(where, identity=identity, namespace=namespace, mode="client") as client:
        yield client


def _learn(
    client: Client, class_: str, entity: str | None, views: list[ExemplarView], shown: str
) -> LessonTold:
    if entity is not None:
        return client.learn(class_, entity=entity)
    from semmap.nodes.perception_node.exemplar_commands import view_message

    return client.learn(class_, views=tuple(map(view_message, views)), shown=shown[:1000])


def _book(data: Path) -> ExemplarStore:
    """Return the exemplars of a data folder. Raises Refused if its system is running."""
    extras.require("semmap learn --data", "perception")
    from semmap.nodes.perception_node.exemplar_store import FILENAME, ExemplarStore
    from semmap.nodes.perception_node.recognition.recognition_model import shipped
    from semmap.nodes.supervisor import registry

    if any(Path(system.data) == data.resolve() for system in registry.systems()):
        raise errors.Refused(f"a system is running on {data}; remove --data to use it")
    return ExemplarStore(data / FILENAME, shipped())


def _known(class_: str, *, new: bool) -> tuple[str, tuple[str, ...]]:
    """Return a class and those above it, as known at training; a `new` one is below Object."""
    from semmap.nodes.perception_node.exemplar_store import known_class
    from semmap.nodes.perception_node.recognition.recognition_model import shipped

    ancestors = shipped().ancestors
    try:
        found = known_class(class_, ancestors)
    except errors.BadRequest:
        if not new:
            raise
        return class_name(class_), (ABOVE,)
    return found, tuple(ancestors[found])


def _add_class(client: Client, words: str) -> str:
    """Return the class that is called by these words, which is added to the TBox if it is missing."""
    classes = client.classes()
    if (known := find_class(words, classes)) is not None:
        return known
    made = declare_class(words, classes)
    reply = client.send(
        Load(
            content=made.turtle.encode(),
            filename=f"{made.name}.ttl",
            tbox=True,
            extend=True,
            reason=f"learn the class {made.name}",
        )
    )
    print_error(f"note: added the class {made.name} to the TBox, below {ABOVE} (commit {reply.commit})")
    return made.name


def _read_views(
    frames: Path, box: tuple[int, int, int, int] | None
) -> tuple[list[ExemplarView], tuple[str, ...]]:
    extras.require("semmap learn --frames", "perception")
    from semmap.nodes.perception_node.exemplar_views import views_in_frames
    from semmap.nodes.perception_node.image_features.image_evidence import with_images
    from semmap.nodes.perception_node.recognition.recognition_model import shipped

    return views_in_frames(frames, with_images(shipped()), box)
