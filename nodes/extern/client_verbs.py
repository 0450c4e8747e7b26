"""The verbs of a client, each once: its fields, types and documentation are those of its command.

Type checkers and editors see `client.add(class_, name=None, at=None, ...) -> Changed`, because a `Verb` has
the parameters of the command's constructor; so do `help(client.add)` and `inspect.signature`.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Coroutine, Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from types import MappingProxyType, MethodType
from typing import (
    TYPE_CHECKING,
    Any,
    Generic,
    Literal,
    ParamSpec,
    TypeVar,
    get_args,
    get_type_hints,
    overload,
)

from semmap.nodes.extern.files import read_file
from semmap.nodes.extern.ontology_upload import ontology
from semmap.nodes.extern.plan_files import is_plan, read_plan
from semmap.schemas import commands, errors, replies
from semmap.schemas.calls import reply_type
from semmap.schemas.commands import Command
from semmap.schemas.entities import Entity, Value
from semmap.schemas.moments import When
from semmap.schemas.packing import packed
from semmap.schemas.plans import HEIGHTS_M, RADIUS_M, HeightRange, Way
from semmap.schemas.scenes import Picture

if TYPE_CHECKING:
    from semmap.nodes.extern.async_client import AsyncClient
    from semmap.nodes.extern.client import Client

P = ParamSpec("P")
R = TypeVar("R")
U = TypeVar("U")


class Verb(Generic[P, U]):
    """A method that sends the command that `make` makes of its arguments, and returns its reply.

    With `read`, what that makes of the reply. A `Client` returns it, an `AsyncClient` has it awaited. Types
    and documentation are those of `make`.
    """

    @overload
    def __init__(self: Verb[P, R], make: Callable[P, Command[R]]) -> None: ...
    @overload
    def __init__(self: Verb[P, U], make: Callable[P, Command[R]], read: Callable[[R], U]) -> None: ...
    def __init__(self, make: Callable[..., Command[Any]], read: Callable[[Any], Any] | None = None) -> None:
        self._make, self._read = make, read

    def __set_name__(self, owner: type[Any], name: str) -> None:
        self._owner, self._name = owner.__name__, name

    @cached_property
    def _method(self) -> Callable[..., Any]:
        """Made for the verbs that are used: their signatures take longer than the rest of an import."""
        make, read = self._make, self._read

        def method(client: Any, *args: Any, **fields: Any) -> Any:
            return client.request(partial(make, *args, **fields), read)

        method.__name__, method.__qualname__ = self._name, f"{self._owner}.{self._name}"
        method.__doc__, method.__module__ = make.__doc__, make.__module__
        method.__signature__ = _signature(make, read)  # type: ignore[attr-defined]
        return method

    @overload
    def __get__(self, client: Client, owner: type[Client]) -> Callable[P, U]: ...
    @overload
    def __get__(
        self, client: AsyncClient, owner: type[AsyncClient]
    ) -> Callable[P, Coroutine[Any, Any, U]]: ...
    @overload
    def __get__(self, client: None, owner: type[Any]) -> Callable[..., Any]: ...
    def __get__(self, client: Any, owner: type[Any]) -> Any:
        return self._method if client is None else MethodType(self._method, client)


def _signature(make: Callable[..., Any], read: Callable[[Any], Any] | None) -> inspect.Signature:
    """That of `make` as a method, with the type of the reply. Types are named as in the code."""
    signature = inspect.signature(make)
    written = _written_types(make) if isinstance(make, type) else {}
    parameters = [p.replace(annotation=written.get(n, p.annotation)) for n, p in signature.parameters.items()]
    if read is not None:
        reply = get_type_hints(read)["return"]
    elif isinstance(make, type):
        reply = reply_type(make)
    else:
        (reply,) = get_args(get_type_hints(make)["return"])
    itself = inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY)
    return signature.replace(parameters=[itself, *parameters], return_annotation=reply)


def _written_types(kind: type[Any]) -> dict[str, Any]:
    return {
        name: said for base in reversed(kind.__mro__) for name, said in inspect.get_annotations(base).items()
    }


def _remove(
    *names: str,
    unchanged: Sequence[str] = (),
    since: int = 0,
    dry_run: bool = False,
    id: str = "",
    reason: str = "",
) -> Command[replies.Changed]:
    """Remove entities from the map and the scene: all of them or, if one is unknown, none.

    Raises PreconditionFailed where one of `unchanged` was changed by a commit after `since`.
    """
    return commands.Remove(
        names=names, unchanged=tuple(unchanged), since=since, dry_run=dry_run, id=id, reason=reason
    )


def _set(
    name: str,
    property: str,
    *values: Value,
    if_is: Value | None = None,
    if_unset: bool = False,
    confidence: float | None = None,
    unchanged: Sequence[str] = (),
    since: int = 0,
    dry_run: bool = False,
    id: str = "",
    reason: str = "",
) -> Command[replies.Changed]:
    """State a data or object property of an entity: `client.set("door1", "isOpen", True)`.

    The value of a functional property replaces the one before; other properties get more values. With `if_is`
    it raises PreconditionFailed unless that is a value now, with `if_unset` unless there is none, and where
    one of `unchanged` was changed by a commit after `since`.
    """
    return commands.Set(
        name=name,
        property=property,
        values=values,
        if_is=if_is,
        if_unset=if_unset,
        confidence=confidence,
        unchanged=tuple(unchanged),
        since=since,
        dry_run=dry_run,
        id=id,
        reason=reason,
    )


def _batch(
    *changes: commands.Update | commands.Set | commands.Unset,
    confidence: float | None = None,
    unchanged: Sequence[str] = (),
    since: int = 0,
    dry_run: bool = False,
    id: str = "",
    reason: str = "",
) -> Command[replies.Changed]:
    """Make several changes in one commit, or none: `client.batch(Set(...), Update(...))`.

    They are messages of `semmap.commands` and happen together: an entity is updated once at most, and a
    property of it set or unset once. Positions are in the map frame. Raises what the first change that is
    refused would raise, and PreconditionFailed where one of `unchanged` was changed by a commit after
    `since`.
    """
    return commands.Batch(
        changes=changes,
        confidence=confidence,
        unchanged=tuple(unchanged),
        since=since,
        dry_run=dry_run,
        id=id,
        reason=reason,
    )


def _load(
    path: str | Path,
    *,
    replace: bool = False,
    skip_unknown: bool = False,
    strict: bool = False,
    tbox: bool = False,
    extend: bool = False,
    parts: bool = False,
    imports: Mapping[str, str | Path] = MappingProxyType({}),
    spatial_root: Sequence[str] = (),
    dry_run: bool = False,
    id: str = "",
    reason: str = "",
) -> Command[replies.Changed]:
    """Add what a file describes: an ABox, a JSON scene, a HuRIC map or a plan. Raises BadFile.

    A plan is the YAML file of a map of ROS's map server: its free space is cut into rooms at its doors.

    `replace` takes the present entities out in the same commit; `skip_unknown` leaves out what is of a class
    that the TBox does not have; `strict` refuses a file that relates things to what nobody describes.
    With `parts` it is as many commits as it takes, for files of any size.

    With `tbox` the file (or folder) is a TBox that replaces the present one, with all that it
    imports: from the files that `imports` has for IRIs, that a catalogue names, or that lie beside it.
    `spatial_root` are classes, by IRI or name, whose instances are things in space.
    With `extend`, too, the statements of the file are added to the present TBox.
    """
    if extend and not tbox:
        raise errors.BadRequest("--extend applies to TBoxes only; add --tbox")
    if imports and not tbox:
        raise errors.BadRequest("--import applies to TBoxes only; add --tbox")
    if tbox:
        content, filename = ontology(Path(path), imports)
    elif is_plan(Path(path)):
        content, filename = read_plan(Path(path)).content, Path(path).name
    else:
        content, filename = read_file(Path(path)), Path(path).name
    return commands.Load(
        content=packed(content),
        filename=filename,
        replace=replace,
        skip_unknown=skip_unknown,
        strict=strict,
        tbox=tbox,
        extend=extend,
        spatial_root=tuple(spatial_root),
        parts=parts,
        dry_run=dry_run,
        id=id,
        reason=reason,
    )


def _move(
    name: str,
    at: Sequence[float],
    yaw: float | None = None,
    *,
    frame: str | None = None,
    carry: bool = False,
    leave: Sequence[str] = (),
    wait: bool = True,
    id: str = "",
    reason: str = "",
) -> Command[replies.Moved]:
    """Move the body of an entity by hand, and return when the map has followed.

    The reply's `commit` is that by which it did; without one, its `notes` say why: the body rests where the
    map has it already, still moves after half a minute, or time is paused. With `wait=False` it returns when
    the body is released.

    `at` is the bottom centre [m] and `yaw` [rad] how it is turned, in the map frame or in `frame`. With
    `carry`, what stands on it or is inside it is moved with it as one rigid body, except what `leave` names.
    Raises Refused where the map rejects the new place, an undo stops it, or the entity is removed before it
    rests; NoAnswer where the simulator ends.
    """
    return commands.Move(
        name=name,
        at=tuple(at),  # type: ignore[arg-type]
        yaw=yaw,
        frame=frame,
        carry=carry,
        leave=tuple(leave),
        wait=wait,
        id=id,
        reason=reason,
    )


def _open(
    name: str,
    to: float = 1.0,
    joint: str | None = None,
    *,
    wait: bool = True,
    id: str = "",
    reason: str = "",
) -> Command[replies.Moved]:
    """Open a thing as a hand would, to this share of its way, and return when the map has followed.

    With a `joint`, only that one of several. What is in the way stops it. `wait`, the reply and what it
    raises are as for `move`, and Refused is raised for what has no joints.
    """
    return commands.Open(name=name, to=to, joint=joint, wait=wait, id=id, reason=reason)


def _close(
    name: str, joint: str | None = None, *, wait: bool = True, id: str = "", reason: str = ""
) -> Command[replies.Moved]:
    """Close a thing as a hand would, and return when the map has followed; as for `open`."""
    return commands.Close(name=name, joint=joint, wait=wait, id=id, reason=reason)


def _drive(
    name: str,
    to: Sequence[Sequence[float]] = (),
    yaw: float | None = None,
    *,
    frame: str | None = None,
    speed: float = 0.4,
    stop: bool = False,
    wait: bool = True,
    id: str = "",
    reason: str = "",
) -> Command[replies.Moved]:
    """Drive a robot of the simulator to a point, or through several, and return when the map has followed.

    It drives in a straight line to each point [m], at most at `speed` [m/s], and at the end faces `yaw`
    [rad]; both are in the map frame, or in `frame` as that is when the command begins. With `stop` it stops
    where it is. `wait`, the reply and what it raises are as for `move`, and Refused is raised where the robot
    gets no further, or falls.
    """
    return commands.Drive(
        name=name,
        to=tuple(map(tuple, to)),  # type: ignore[arg-type]
        yaw=yaw,
        frame=frame,
        speed=speed,
        stop=stop,
        wait=wait,
        id=id,
        reason=reason,
    )


def _list(
    class_: str | None = None,
    *,
    as_of: When | None = None,
    on: str | None = None,
    in_: str | None = None,
    near: str | None = None,
    within: float | None = None,
    nearest: int | None = None,
    to: str | None = None,
    frame: str | None = None,
) -> commands.List:
    """The entities of a class, over inferred types; all of them without one.

    Of these those `on` a thing, `in_` a place or container, `near` a thing (`within` so many metres of it),
    or the `nearest` so many `to` a thing; each is given by name, reference or class, and `near` and `to` may
    be positions: "2.5,1,0.8" [m]. With a `frame` such positions are in it, and so are the poses in the
    answer.

    `as_of`: the map as it was after a commit, given by its number, or at a time: seconds since 1970, ISO 8601
    or a reply's `stamp_ns`. A time denotes its written precision (see `semmap.schemas.moments.When`).
    """
    return commands.List(
        class_=class_,
        as_of=as_of,
        on=on,
        in_=in_,
        near=near,
        within=within,
        nearest=nearest,
        to=to,
        frame=frame,
    )


def _list_as(
    format: Literal["lu4r", "legacy"], class_: str | None = None, *, as_of: When | None = None
) -> commands.List:
    """The entity list in the format of another system."""
    return commands.List(class_=class_, format=format, as_of=as_of)


def _route(
    from_: str | Sequence[float],
    to: str | Sequence[float],
    *,
    radius: float = RADIUS_M,
    heights: HeightRange = HEIGHTS_M,
    as_of: When | None = None,
) -> Command[Way]:
    """The shortest way for a robot of a `radius` [m], over places and through doors.

    From and to places, things or persons (by name, reference or class), or positions (x, y) [m] in the map
    frame. What has a part within `heights` [m] above the floor is in the way. A way through closed doors
    names them in `closed`: it is none until they are opened. Raises Refused, with the reason, if there
    is none.
    """
    start, end = (word if isinstance(word, str) else ",".join(map(repr, word)) for word in (from_, to))
    return commands.FindWay(from_=start, to=end, radius=radius, heights=heights, as_of=as_of)


def _entities(reply: tuple[Entity, ...] | dict[str, Any]) -> tuple[Entity, ...]:
    if not isinstance(reply, tuple):
        raise errors.InternalError("the entities came in another format")
    return reply


def _document(reply: tuple[Entity, ...] | dict[str, Any]) -> dict[str, Any]:
    if not isinstance(reply, dict):
        raise errors.InternalError("the entities came without the format that was asked for")
    return reply


def _png(picture: Picture) -> bytes:
    return picture.png


class Verbs:
    """What one may ask of a system and do to its map and scene: every command, and its reply.

    Positions are metres in the map frame, angles radians, quaternions `wxyz`. Each verb takes an `id`, too:
    the same one twice is executed once. Raises Refused, BadRequest or NoAnswer.
    """

    # To change
    add = Verb(commands.Add)
    update = Verb(commands.Update)
    set = Verb(_set)
    unset = Verb(commands.Unset)
    batch = Verb(_batch)
    track = Verb(commands.Track)
    remove = Verb(_remove)
    clear = Verb(commands.Clear)
    load = Verb(_load)
    undo = Verb(commands.Undo)

    # To ask
    list = Verb(_list, _entities)
    list_as = Verb(_list_as, _document)
    get = Verb(commands.Get)
    frames = Verb(commands.ListFrames)
    check = Verb(commands.Check)
    infer = Verb(commands.Infer)
    explain = Verb(commands.Explain)
    could = Verb(commands.Could)
    relations = Verb(commands.Relations)
    understand = Verb(commands.Understand)
    tell = Verb(commands.Tell)
    find = Verb(commands.Find)
    diff = Verb(commands.Diff)
    when = Verb(commands.WasWhen)
    export = Verb(commands.Export)
    floorplan = Verb(commands.PlanFloor)
    route = Verb(_route)
    classes = Verb(commands.Classes)
    properties = Verb(commands.Properties)
    status = Verb(commands.Status)
    history = Verb(commands.History)
    last_seen = Verb(commands.LastSeen)
    sparql = Verb(commands.Sparql)

    # To let agents change
    submit = Verb(commands.Submit)
    approve = Verb(commands.Approve)

    # To keep
    compact = Verb(commands.Compact)

    # To run
    move = Verb(_move)
    drive = Verb(_drive)
    attach = Verb(commands.Attach)
    detach = Verb(commands.Detach)
    open = Verb(_open)
    close = Verb(_close)
    pause = Verb(commands.Pause)
    step = Verb(commands.StepOnce)
    reset = Verb(commands.Reset)
    picture = Verb(commands.TakePicture, _png)

    # To show perception
    learn = Verb(commands.Learn)
    learned = Verb(commands.Learned)
    forget = Verb(commands.Forget)
