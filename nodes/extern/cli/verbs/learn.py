"""The verbs by which perception is shown things of one's own: `learn`, `learned`, `forget`."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.calling import (
    complain,
    connect_option,
    identity_option,
    namespace_option,
    print_json,
)
from semmap.nodes.extern.cli.completing import class_names, entity_names
from semmap.nodes.extern.cli.output import show
from semmap.nodes.extern.cli.output.printable import say
from semmap.nodes.extern.cli.output.tables import table
from semmap.nodes.runtime import extras
from semmap.schemas import errors
from semmap.schemas.exemplars import LessonTold
from semmap.schemas.wording import counted

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client
    from semmap.nodes.perception_node.lesson_book import LessonBook
    from semmap.nodes.perception_node.showing import View

_path = click.Path(path_type=Path)


def _where(function: Callable[..., None]) -> Callable[..., None]:
    """Options that say whose lessons are meant: a running system's, or those of a data folder."""

    @click.option(
        "--data",
        type=_path,
        help="Lessons of this data folder, for perceive --data. Default: a running system.",
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


@click.command()
@click.argument("class_", metavar="CLASS", shell_complete=class_names)
@click.option("--frames", metavar="DIR", type=_path, help="Folders of frames, as perceive --frames has them.")
@click.option("--entity", metavar="NAME", shell_complete=entity_names, help="What perception sees there now.")
@click.option(
    "--box",
    nargs=4,
    type=int,
    metavar="X0 Y0 X1 Y1",
    help="With --frames: the thing in this box [pixel]. Default: the largest compact one.",
)
@_where
def learn(
    class_: str,
    frames: Path | None,
    entity: str | None,
    box: tuple[int, int, int, int] | None,
    data: Path | None,
    format: str,
    **system: Any,
) -> None:
    """Show perception a thing, to be recognised from now on.

    One frame will do; more, from other sides and distances, are better. The thing stands by itself on a
    table or the floor. CLASS is any class of the TBox of things, also one that perception has never learnt.
    Nothing is trained anew: what looks like it is called so, beside all that was known before.
    """
    if (frames is None) == (entity is None):
        raise errors.BadRequest("say what is shown: --frames DIR or --entity NAME")
    if box is not None and frames is None:
        raise errors.BadRequest("--box goes with --frames")
    if data is not None and frames is None:
        raise errors.BadRequest("--entity is seen by a running system; with --data show --frames DIR")
    views: list[View] = []
    notes: tuple[str, ...] = ()
    shown = ""
    if data is not None:
        book, class_ = _book(data), _known(class_)
    if frames is not None:
        views, notes = _seen(frames, box)
        shown = f"{counted(len(views), 'frame')} in {frames}"
    if data is not None:
        from semmap.nodes.perception_node.recognition.shipped_votes import shipped

        told = book.add(class_, shipped().ancestors[class_], views, shown)
    else:
        with _client(**system) as client:
            told = _learnt(client, class_, entity, views, shown)
    for note in notes:
        complain(note)
    if format == "json":
        print_json(told)
        return
    size = " x ".join(f"{side:.3f}" for side in told.size_m)
    say(f"learned {told.class_} from {told.shown} ({size} m); to undo: semmap forget {told.number}")


@click.command()
@_where
def learned(data: Path | None, format: str, **system: Any) -> None:
    """List what perception was shown."""
    if data is not None:
        told = _book(data).lessons
    else:
        with _client(**system) as client:
            told = client.learned()
    if format == "json":
        print_json(told)
        return
    if not told:
        say("nothing was shown")
        return
    rows = table("number", "class", "size [m]", "views", "shown", fold=("shown",))
    for lesson in told:
        size = " x ".join(f"{side:.3f}" for side in lesson.size_m)
        rows.add(str(lesson.number), lesson.class_, size, str(lesson.views), lesson.shown)
    show.console().print(rows)


@click.command()
@click.argument("number", type=click.IntRange(min=1))
@_where
def forget(number: int, data: Path | None, format: str, **system: Any) -> None:
    """Undo what perception was shown; learned tells the NUMBER."""
    if data is not None:
        told = _book(data).forget(number)
    else:
        with _client(**system) as client:
            told = client.forget(number=number)
    if format == "json":
        print_json(told)
    else:
        say(f"forgot {told.class_} from {told.shown}")


@contextmanager
def _client(where: str | None, identity: str | None, namespace: str | None) -> Iterator[Client]:
    from semmap.nodes.extern.client import connect

    with connect(where, identity=identity, namespace=namespace, mode="client") as client:
        yield client


def _learnt(client: Client, class_: str, entity: str | None, views: list[View], shown: str) -> LessonTold:
    if entity is not None:
        return client.learn(class_, entity=entity)
    from semmap.nodes.perception_node.teaching import view_told

    return client.learn(class_, views=tuple(map(view_told, views)), shown=shown[:1000])


def _book(data: Path) -> LessonBook:
    """The lessons of a data folder whose system does not run."""
    extras.require("semmap learn --data", "perception")
    from semmap.nodes.perception_node.lesson_book import FILENAME, LessonBook
    from semmap.nodes.perception_node.recognition.shipped_votes import shipped
    from semmap.nodes.supervisor import registry

    if any(Path(system.data) == data.resolve() for system in registry.systems()):
        raise errors.Refused(f"a system runs on {data}, which learns by itself: leave out --data")
    return LessonBook(data / FILENAME, shipped())


def _known(class_: str) -> str:
    from semmap.nodes.perception_node.lesson_book import known_class
    from semmap.nodes.perception_node.recognition.shipped_votes import shipped

    return known_class(class_, shipped().ancestors)


def _seen(frames: Path, box: tuple[int, int, int, int] | None) -> tuple[list[View], tuple[str, ...]]:
    extras.require("semmap learn --frames", "perception")
    from semmap.nodes.perception_node.recognition.shipped_votes import shipped
    from semmap.nodes.perception_node.showing import shown_in_frames

    return shown_in_frames(frames, shipped(), box)
