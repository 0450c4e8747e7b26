"""The methods of the clients, one for each command, with its fields, types and documentation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from semmap.nodes.extern.command_method import CommandMethod
from semmap.nodes.extern.files import read_file, read_ontology
from semmap.nodes.extern.floorplans import is_plan, read_plan
from semmap.schemas import commands, errors, replies
from semmap.schemas.commands import Command
from semmap.schemas.entities import Entity, Value
from semmap.schemas.moments import When
from semmap.schemas.packing import packed
from semmap.schemas.plans import HEIGHTS_M, RADIUS_M, HeightRange, Way
from semmap.schemas.scenes import Picture


def _remove(
    *names: str,
    unchanged: Sequence[str] = (),
    since: int = 0,
    dry_run: bool = False,
    id: str = "",
    reason: str = "",
) -> Command[replies.Changed]:
    """Remove entities from the map and the scene. If one of them is unknown, none is removed.

    Raises PreconditionFailed if a commit after `since` changed one of the entities `unchanged`.
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
    """Set a data or object property of an entity: `client.set("door1", "isOpen", True)`.

    The range of the property gives the datatype. A text ends with its language where the range allows one:
    `client.set("shelf1", "title", "Regal@de")`.

    The value of a functional property replaces the previous one. Other properties keep their previous values.
    Raises PreconditionFailed in these cases:

    - `if_is` is not a value of the property.
    - `if_unset` is true and the property has a value.
    - A commit after `since` changed one of the entities `unchanged`.
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
    """Apply several changes in one commit, or none of them: `client.batch(Set(...), Update(...))`.

    The changes are commands of `semmap.commands`. A batch has at most one update of an entity, and sets or
    unsets a property at most once. Positions are in the map frame. Raises the error of the first rejected
    change, and PreconditionFailed if a commit after `since` changed one of the entities `unchanged`.
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
    add_only: bool = False,
    skip_unknown: bool = False,
    strict: bool = False,
    tbox: bool = False,
    extend: bool = False,
    parts: bool = False,
    imports: Mapping[str, str | Path] = MappingProxyType({}),
    spatial_root: Sequence[str] = (),
    graph: str = "",
    urdf: str | Path | None = None,
    tbox_from_abox: bool = False,
    dry_run: bool = False,
    id: str = "",
    reason: str = "",
) -> Command[replies.Changed]:
    """Load a file: an ABox, a JSON scene, a HuRIC map, a plan or a TBox. Raises BadFile.

    A plan is the YAML file of a map of the ROS map server: its free space is divided into rooms at the doors.

    What the file states about an entity that is in the map replaces its pose, size, labels and values of
    functional properties, in one commit; with `add_only`, such a file is rejected. `replace` removes all
    current entities in the same commit. `skip_unknown` skips entities whose class is not in the TBox.
    `strict` rejects a file that refers to undescribed entities. `parts` loads the file in several commits,
    for files of any size. `graph` is the named graph of a TriG, N-Quads or JSON-LD file to load in place of
    its default graph: an IRI, or its last part. `urdf` is a URDF file whose links give poses and sizes to the
    individuals that are called like them. `tbox_from_abox` adds the classes and properties that the file of a
    map declares to the TBox, in the same commit.

    With `tbox`, the file (or folder) is a TBox that replaces the current one, including its imports. These
    are found by `imports` (a file for each IRI), by a catalogue, or in the same folder. `spatial_root` are
    classes, by IRI or name, whose instances have a position. With `extend`, the statements of the file are
    added to the current TBox.
    """
    if extend and not tbox:
        raise errors.BadRequest("--extend applies to TBoxes only; add --tbox")
    if imports and not tbox:
        raise errors.BadRequest("--import applies to TBoxes only; add --tbox")
    if tbox:
        content, filename, graph = read_ontology(Path(path), imports, graph)
    elif is_plan(Path(path)):
        content, filename = read_plan(Path(path)).content, Path(path).name
    else:
        content, filename = read_file(Path(path)), Path(path).name
    return commands.Load(
        content=packed(content),
        filename=filename,
        replace=replace,
        add_only=add_only,
        skip_unknown=skip_unknown,
        strict=strict,
        tbox=tbox,
        extend=extend,
        spatial_root=tuple(spatial_root),
        graph=graph,
        urdf=b"" if urdf is None else packed(read_file(Path(urdf))),
        parts=parts,
        tbox_from_abox=tbox_from_abox,
        dry_run=dry_run,
        id=id,
        reason=reason,
    )


def _move(
    name: str,
    at: Sequence[float] | None = None,
    yaw: float | None = None,
    *,
    on: str | None = None,
    in_: str | None = None,
    next_to: str | None = None,
    frame: str | None = None,
    carry: bool = False,
    leave: Sequence[str] = (),
    wait: bool = True,
    id: str = "",
    reason: str = "",
) -> Command[replies.Moved]:
    """Move the body of an entity manually, and return when the map is updated.

    The `commit` of the reply is the update. If there is none, its `notes` have the reason: the body came to
    rest at its pose in the map, is still moving after 30 s, or time is paused. With `wait=False`, the method
    returns when the body is released.

    `at` is the bottom centre [m] and `yaw` [rad] the rotation, in the map frame or in `frame`. With `on`,
    `in_` or `next_to`, it is placed where there is room on, in or next to another entity. With `carry`,
    the objects on it and inside it are moved with it as one rigid body, except those in `leave`. Raises
    Refused if the map rejects the new pose, an undo stops the move, or the entity is removed before it is at
    rest. Raises NoAnswer if the simulator ends.
    """
    return commands.Move(
        name=name,
        at=None if at is None else tuple(at),  # type: ignore[arg-type]
        yaw=yaw,
        on=on,
        in_=in_,
        next_to=next_to,
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
    """Open a door, lid or drawer to this fraction, and return when the map is updated.

    With `joint`, only that joint of the object is moved. Obstacles stop it. `wait`, the reply and the errors
    are as for `move`. Raises also Refused for an object without joints.
    """
    return commands.Open(name=name, to=to, joint=joint, wait=wait, id=id, reason=reason)


def _close(
    name: str, joint: str | None = None, *, wait: bool = True, id: str = "", reason: str = ""
) -> Command[replies.Moved]:
    """Close a door, lid or drawer, and return when the map is updated; see `open`."""
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
    """Drive a simulated robot to a point, or through several, and return when the map is updated.

    The robot drives in a straight line to each point [m], with at most `speed` [m/s], and finally turns to
    `yaw` [rad]. Both are in the map frame, or in `frame` as it is at the start. `stop` stops the robot.
    `wait`, the reply and the errors are as for `move`. Raises also Refused if the robot is blocked or falls.
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
    all: bool = False,
) -> commands.List:
    """Return the entities, or those of a class, including inferred types.

    They can be restricted to the entities `on` an object, `in_` a place or container, `near` an object
    (`within` a distance [m]), or to the `nearest` N entities `to` an object. Each of these is a name, a label
    or a class; `near` and `to` may also be positions: "2.5,1,0.8" [m]. With `frame`, these positions and the
    poses in the reply are in that frame. With `all`, individuals that are not in space follow, whose
    `in_space` is false.

    `as_of` selects the state of the map after a commit number or at a time: seconds since 1970, ISO 8601, or
    the `stamp_ns` of a reply. A time means its written precision (see `semmap.schemas.moments.When`).
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
        all=all,
    )


def _list_as(
    format: Literal["lu4r", "legacy"], class_: str | None = None, *, as_of: When | None = None
) -> commands.List:
    """Return the list of entities in the format of another system."""
    return commands.List(class_=class_, format=format, as_of=as_of)


def _route(
    from_: str | Sequence[float],
    to: str | Sequence[float],
    *,
    radius: float = RADIUS_M,
    heights: HeightRange = HEIGHTS_M,
    as_of: When | None = None,
) -> Command[Way]:
    """Return the shortest route of a robot with a `radius` [m] through places and doors.

    `from_` and `to` are entities (by name, label or class) or positions (x, y) [m] in the map frame. Objects
    with a part within `heights` [m] above the floor are obstacles. `closed` has the closed doors on the
    route, which must be opened first. Raises Refused, with the reason, if there is no route.
    """
    start, end = (word if isinstance(word, str) else ",".join(map(repr, word)) for word in (from_, to))
    return commands.FindWay(from_=start, to=end, radius=radius, heights=heights, as_of=as_of)


def _entities(reply: tuple[Entity, ...] | dict[str, Any]) -> tuple[Entity, ...]:
    if not isinstance(reply, tuple):
        raise errors.InternalError("the reply is not a list of entities")
    return reply


def _document(reply: tuple[Entity, ...] | dict[str, Any]) -> dict[str, Any]:
    if not isinstance(reply, dict):
        raise errors.InternalError("the reply is not in the requested format")
    return reply


def _png(picture: Picture) -> bytes:
    return picture.png


class CommandMethods:
    """The methods of a client: one for each command, which returns its reply.

    Positions are in metres in the map frame, angles in radians, quaternions `wxyz`. Each method also accepts
    an `id`; commands with the same id are executed once. Raises Refused, BadRequest or NoAnswer.
    """

    # Change the map
    add = CommandMethod(commands.Add)
    update = CommandMethod(commands.Update)
    set = CommandMethod(_set)
    unset = CommandMethod(commands.Unset)
    batch = CommandMethod(_batch)
    rename = CommandMethod(commands.Rename)
    track = CommandMethod(commands.Track)
    remove = CommandMethod(_remove)
    clear = CommandMethod(commands.Clear)
    load = CommandMethod(_load)
    undo = CommandMethod(commands.Undo)

    # Query
    list = CommandMethod(_list, _entities)
    list_as = CommandMethod(_list_as, _document)
    get = CommandMethod(commands.Get)
    frames = CommandMethod(commands.ListFrames)
    check = CommandMethod(commands.Check)
    infer = CommandMethod(commands.Infer)
    explain = CommandMethod(commands.Explain)
    could = CommandMethod(commands.Could)
    relations = CommandMethod(commands.Relations)
    understand = CommandMethod(commands.Understand)
    tell = CommandMethod(commands.Tell)
    find = CommandMethod(commands.Find)
    diff = CommandMethod(commands.Diff)
    when = CommandMethod(commands.WasWhen)
    trail = CommandMethod(commands.FindTrail)
    export = CommandMethod(commands.Export)
    floorplan = CommandMethod(commands.PlanFloor)
    route = CommandMethod(_route)
    classes = CommandMethod(commands.Classes)
    properties = CommandMethod(commands.Properties)
    rules = CommandMethod(commands.Rules)
    status = CommandMethod(commands.Status)
    history = CommandMethod(commands.History)
    last_seen = CommandMethod(commands.LastSeen)
    sparql = CommandMethod(commands.Sparql)

    # Approve changes of agents
    submit = CommandMethod(commands.Submit)
    approve = CommandMethod(commands.Approve)

    # Storage
    compact = CommandMethod(commands.Compact)

    # Scene and simulation
    move = CommandMethod(_move)
    drive = CommandMethod(_drive)
    attach = CommandMethod(commands.Attach)
    detach = CommandMethod(commands.Detach)
    open = CommandMethod(_open)
    close = CommandMethod(_close)
    pause = CommandMethod(commands.Pause)
    step = CommandMethod(commands.StepOnce)
    reset = CommandMethod(commands.Reset)
    picture = CommandMethod(commands.TakePicture, _png)

    # Perception
    learn = CommandMethod(commands.Learn)
    learned = CommandMethod(commands.Learned)
    forget = CommandMethod(commands.Forget)
