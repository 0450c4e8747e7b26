"""The base scene: a bare floor or the user's MJCF scene, with the bodies in it."""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any, Literal, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.runtime.pictures import require_small_png
from semmap.nodes.sim_node.bodies import BodyRecord, Floats, pose_of
from semmap.nodes.sim_node.body_classes import ROBOT, BodyClasses, Found
from semmap.nodes.sim_node.physics.build import COLLISION_GROUP, IMPEDANCE
from semmap.nodes.sim_node.physics.entity_bodies import find_entities
from semmap.nodes.sim_node.physics.joint_texts import (
    CLOSED_TEXT,
    ENDS,
    OFF_TEXT,
    JointTexts,
    coupled_joints,
    read_texts,
)
from semmap.nodes.sim_node.vision.view import OPTICAL, View, look_at
from semmap.schemas.entities import is_name, valid_name
from semmap.schemas.errors import BadFile
from semmap.schemas.joints import Joint
from semmap.schemas.nesting import NotWellFormed, require_shallow_xml
from semmap.schemas.wording import bodies, few

# by default MuJoCo writes a log file into the working directory
mujoco.set_mju_user_warning(logging.getLogger("mujoco").warning)

_TIMESTEP_S = 0.002
_EXTENT_M = 10.0
_CLASS_TEXT = "semmap:"
_KINDS: dict[int, Literal["hinge", "slide", "ball"]] = {
    int(mujoco.mjtJoint.mjJNT_HINGE): "hinge",
    int(mujoco.mjtJoint.mjJNT_SLIDE): "slide",
    int(mujoco.mjtJoint.mjJNT_BALL): "ball",
}
_SLEEP_WITH = {
    int(mujoco.mjtEq.mjEQ_CONNECT),
    int(mujoco.mjtEq.mjEQ_WELD),
    int(mujoco.mjtEq.mjEQ_JOINT),
}
"""The equality constraints with which MuJoCo supports sleep; with others it would fail."""
_DEFAULT_IMPEDANCE = (0.9, 0.95, 0.001, 0.5, 2.0)

_COVERED = 0.8
"""The least share of each extent of colliding geoms that visual ones must cover to be drawn instead."""

OVERVIEW = "overview"
"""The camera of a bare floor."""

OVERVIEW_FOVY_RAD = math.radians(58.0)


def bare_floor(views: Iterable[tuple[str, View]] | None = None) -> mujoco.MjSpec:
    """Return an infinite floor with these named cameras; by default with one overview camera."""
    spec = mujoco.MjSpec()
    spec.modelname = "empty"
    spec.option.timestep = _TIMESTEP_S
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.1], rgba=[0.62, 0.60, 0.56, 1.0]
    )
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.35] * 3, [0.35] * 3
    spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=[-0.3, 0.5, -1], diffuse=[0.5] * 3
    )
    if views is None:
        eye, target = np.array([5.0, -5.0, 5.0]), np.zeros(3)
        views = [(OVERVIEW, look_at(eye, target, 4, 3, OVERVIEW_FOVY_RAD))]
    for name, view in views:
        aim(spec.worldbody.add_camera(name=name), view)
    return spec


def aim(camera: mujoco.MjsCamera, view: View) -> None:
    """Set a camera to the pose of a view."""
    camera.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    camera.pos, camera.fovy = view.map_from_camera[:3, 3], np.degrees(view.fovy_rad)
    mujoco.mju_mat2Quat(camera.quat, (view.map_from_camera[:3, :3] @ OPTICAL).ravel())


def read_mjcf(path: Path, *, compiles: bool = True) -> mujoco.MjSpec:
    """Read a scene from a file. Raises BadFile if it is missing or, if requested, does not compile."""
    try:
        with suppress(NotWellFormed, OSError):  # which MuJoCo reports
            require_shallow_xml(path.read_bytes())
        spec = mujoco.MjSpec.from_file(str(path))
        _require_small_textures(spec, path.parent)
        if compiles:  # not a copy, which drops references to missing names
            mujoco.MjSpec.from_file(str(path)).compile()
    except (ValueError, OSError, mujoco.FatalError) as error:
        reason = _one_line(error)
        if "allocate memory" in reason:  # MuJoCo overestimates the memory of very many bodies
            reason += '; set the limit in the file: <size memory="200M"/>'
        raise BadFile(f"cannot compile world file {path}: {reason}") from None
    return spec


def _require_small_textures(spec: mujoco.MjSpec, folder: Path) -> None:
    """Raise ValueError for a texture or height field with too many pixels: MuJoCo would decode it."""
    named = [file for texture in spec.textures for file in (texture.file, *texture.cubefiles)]
    for file in filter(None, (*named, *(field.file for field in spec.hfields))):
        for there in (folder / file, folder / spec.texturedir / file, folder / spec.meshdir / file):
            if there.is_file():
                try:
                    require_small_png(there)
                except ValueError as error:
                    raise ValueError(f"{there.name}: {error}") from None


class Compiled(NamedTuple):
    """A compiled world. For thousands of bodies, compilation takes seconds."""

    model: mujoco.MjModel
    data: mujoco.MjData
    """The initial state, with the frames of its bodies."""


def prepare(spec: mujoco.MjSpec) -> Compiled:
    """Set the options of the simulator: no automatic reset, and sleep for resting bodies.

    With equality constraints on tendons or flexible bodies, MuJoCo does not support sleep. The result does
    not include the hidden floor, which is added to the specification.
    """
    if all(int(equality.type) in _SLEEP_WITH for equality in spec.equalities):
        spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    else:
        spec.option.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    if spec.option.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL and spec.option.impratio == 1.0:
        # unless the file sets them: with these, leaning bodies do not creep
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        for geom in spec.geoms:
            if np.array_equal(geom.solimp, _DEFAULT_IMPEDANCE):
                geom.solimp = IMPEDANCE
    quality = spec.visual.quality
    quality.shadowsize = quality.offsamples = 0  # shadows and MSAA cost 40 times the frame on a CPU
    # a third of the default's time; round shapes shrink by at most 2 %
    quality.numslices, quality.numstacks, quality.numquads = 24, 8, 1
    _add_names(spec)
    compiled = _compiled(spec)
    _hide_collision_shapes(spec, *compiled)
    if np.isnan(spec.stat.extent):  # extent of the drawn floor, if the scene is empty
        spec.stat.extent = max(_EXTENT_M, float(compiled.model.stat.extent))
    _add_net(spec, *compiled)
    return compiled


def _hide_collision_shapes(spec: mujoco.MjSpec, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Hide the colliding geoms of group 0 that visual ones of group 1 cover, as in robosuite's worlds.

    Its viewer shows only group 1. MuJoCo's shows both, so that red boxes hide the objects.
    """
    for body in spec.bodies[1:]:
        number = model.body(body.name).id if body.name else 0
        first, count = int(model.body_geomadr[number]), int(model.body_geomnum[number])
        if number == 0 or count != len(body.geoms):  # such as with discardvisual
            continue
        geoms = np.arange(first, first + count)
        hits = (model.geom_contype[geoms] | model.geom_conaffinity[geoms]) != 0
        colliding = geoms[hits & (model.geom_group[geoms] == 0)]
        visual = geoms[~hits & (model.geom_group[geoms] == 1)]
        if not (len(colliding) and len(visual)):
            continue
        low, high = _extents(model, data, colliding, number)
        its_low, its_high = _extents(model, data, visual, number)
        shared = np.minimum(high, its_high) - np.maximum(low, its_low)
        if (shared >= _COVERED * (high - low)).all():
            model.geom_group[colliding] = COLLISION_GROUP
            for geom, group in zip(body.geoms, model.geom_group[geoms].tolist(), strict=True):
                geom.group = group


def _add_names(spec: mujoco.MjSpec) -> None:
    """Name moving bodies, joints and cameras that have no name."""
    _name(spec.worldbody.bodies, "body", spec.bodies, lambda body: bool(body.name) or not _has_joints(body))
    _name(spec.joints, "joint", spec.joints, lambda joint: bool(joint.name))
    # a camera's name is part of its keys
    _name(spec.cameras, "camera", spec.cameras, lambda camera: is_name(camera.name))


def _has_joints(body: mujoco.MjsBody) -> bool:
    """Return whether a body or any of its parts moves."""
    return bool(body.joints) or any(_has_joints(part) for part in body.bodies)


def _name(elements: Sequence[Any], stem: str, kin: Iterable[Any], is_named: Callable[[Any], bool]) -> None:
    """Give unnamed elements a name that none of their `kin` has."""
    taken = {other.name for other in kin}
    for number, element in enumerate(elements, start=1):
        if not is_named(element):
            element.name = next(name for n in count(number) if (name := f"{stem}_{n}") not in taken)
            taken.add(element.name)


def _add_net(spec: mujoco.MjSpec, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Add a hidden infinite floor below a world without one, so that falling bodies come to rest."""
    static = np.flatnonzero(model.body_weldid[model.geom_bodyid] == 0)
    if not (model.geom_type[static] == int(mujoco.mjtGeom.mjGEOM_PLANE)).any():
        low, _ = _extents(model, data, static, 0)
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=[0, 0, 0.1],
            pos=[0, 0, low[2]],
            group=COLLISION_GROUP,
            contype=1,
            conaffinity=1,
        )


def _compiled(spec: mujoco.MjSpec) -> Compiled:
    model = spec.copy().compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return Compiled(model, data)


def bodies_of(
    spec: mujoco.MjSpec, compiled: Compiled, classes: BodyClasses | None = None
) -> dict[str, BodyRecord]:
    """Return the world's own bodies by the names of their entities, with the classes that `classes` finds.

    `find_entities` tells them from their parts. A joint belongs to the body that it moves, or else to its
    nearest parent body. The joints of a robot open nothing, unless a text declares it. The size of a body is
    that of its own geoms and those of its parts, without nested entities: a book does not make its table
    higher. A place, or a body without such geoms, includes them.
    """
    model, data = compiled
    ends = JointTexts.of(spec)
    switches = {joint for joint in range(model.njnt) if ends.is_switch(model, joint)}
    follow = coupled_joints(model, switches)  # a burner coupled to a knob opens nothing
    undeclared = {j for j in range(model.njnt) if ends.closed_end(model.joint(j).name) is None}
    robots = set[str]()
    records: dict[int, BodyRecord] = {}
    taken = {body.name for body in spec.bodies if is_name(body.name)}
    classes = classes or BodyClasses()
    owner, found = find_entities(model, classes, _declared(spec))
    geom_owner = np.asarray(owner)[model.geom_bodyid]
    for number, whose in enumerate(owner):
        if number in found:
            body = model.body(number).name
            name = body if is_name(body) else valid_name(body, taken)
            taken.add(name)
            whole = records.get(owner[model.body_parentid[number]])
            geoms = np.flatnonzero(geom_owner == number)
            if not len(geoms) or classes.is_place(found[number]):
                geoms = np.flatnonzero(_within(model, number)[model.geom_bodyid])
            part_of = whole.name if whole else ""
            if found[number].class_ == ROBOT or part_of in robots:
                robots.add(name)
            records[number] = _record(model, data, spec.body(body), geoms, name, found[number], part_of)
        if whose and model.body_jntnum[number]:
            idle = follow | undeclared if records[whose].name in robots else follow
            _give_joints(records[whose], model, number, ends, switches, idle)
    return {record.name: record for record in records.values()}


def ignored(spec: mujoco.MjSpec) -> list[str]:
    """Return declarations in texts without effect, each with the reason, in order."""
    if not any(text.name.startswith((_CLASS_TEXT, CLOSED_TEXT, OFF_TEXT)) for text in spec.texts):
        return []
    model, _ = _compiled(spec)  # compiling is faster than queries of a large specification
    named = {model.body(number).name for number in range(1, model.nbody)}
    joints = {model.joint(number).name for number in range(model.njnt)}
    found = []
    for name in _declared(spec):
        if name not in named:
            found.append(f"{name} (no such body)")
    for prefix, how in ((CLOSED_TEXT, "closed"), (OFF_TEXT, "off")):
        for name, end in read_texts(spec, prefix):
            if name not in joints:
                found.append(f"{name} (no such joint)")
            elif end not in ENDS:
                found.append(f"{name} ({how} at '{end}'; use lower or upper)")
    return found


def left_out(model: mujoco.MjModel, bodies: Collection[str]) -> tuple[str, ...]:
    """Return the bodies of a world that are not in `bodies`, by name or by their parent."""
    names = [model.body(number).name for number in range(model.nbody)]
    found = []
    above = [""] * model.nbody
    for number in range(1, model.nbody):  # parents have lower numbers than their parts
        whole = above[model.body_parentid[number]]
        above[number] = names[number] or whole
        if not names[number]:
            found.append(f"a nameless part of {whole or 'the ground'}")
        elif names[number] not in bodies:
            found.append(names[number])
    return tuple(found)


def names_classes(spec: mujoco.MjSpec) -> bool:
    """Return whether the names of bodies determine their classes."""
    known = {*_declared(spec), ""}
    return any(body.name not in known for body in spec.bodies[1:])


def describe_names(records: Collection[BodyRecord]) -> tuple[str, ...]:
    """Return notes on the bodies with other names in the map, and on those without a certain class."""
    renamed = [f"{record.body} is {record.name}" for record in records if record.body != record.name]
    unsure = [record.body for record in records if not record.is_sure]
    notes = []
    if renamed:
        have = (
            "a body of the world has another name"
            if len(renamed) == 1
            else (f"{len(renamed)} bodies of the world have other names")
        )
        notes.append(f"{have} in the map: {few(renamed, 5)}")
    if unsure:
        line = json.dumps({unsure[0]: "CLASS"}, ensure_ascii=False)
        notes.append(
            f"unknown class of {bodies(len(unsure))} of the world: {few(unsure, 5)};"
            f" name the classes in a JSON file, such as {line}, and start with --class-map FILE"
        )
    return tuple(notes)


def _declared(spec: mujoco.MjSpec) -> dict[str, str]:
    """Return the classes declared in the world's texts, by name of the body."""
    return dict(read_texts(spec, _CLASS_TEXT))


def _give_joints(
    record: BodyRecord,
    model: mujoco.MjModel,
    body: int,
    ends: JointTexts,
    switches: set[int],
    idle: set[int],
) -> None:
    """Add the joints that move a body to a record; those of `idle` open nothing by themselves."""
    first = int(model.body_jntadr[body])
    joints = range(first, first + int(model.body_jntnum[body]))
    numbers = [joint for joint in joints if int(model.jnt_type[joint]) in _KINDS]
    record.joints += tuple(
        _joint(
            model,
            number,
            ends.closed_end(model.joint(number).name),
            number in switches,
            number in idle,
        )
        for number in numbers
    )
    record.joint_names += tuple(model.joint(number).name for number in numbers)


def _joint(
    model: mujoco.MjModel, number: int, closed_end: str | None, is_switch: bool, is_idle: bool
) -> Joint:
    """Return a joint in its initial position; with limits, it opens or switches something.

    Without a text, it is closed, or off, at the nearest limit.
    """
    name = model.joint(number).name
    kind = _KINDS[int(model.jnt_type[number])]
    if kind == "ball":
        return Joint(name=name, kind=kind)
    initial = float(model.qpos0[model.jnt_qposadr[number]])
    if not model.jnt_limited[number]:
        return Joint(name=name, kind=kind, position=initial, initial=initial)
    lower, upper = (float(limit) for limit in model.jnt_range[number])
    nearest = "lower" if initial - lower <= upper - initial else "upper"
    closed = lower if (closed_end or nearest) == "lower" else upper
    return Joint(
        name=name,
        kind=kind,
        position=initial,
        lower=lower,
        upper=upper,
        closed=None if is_idle else closed,
        initial=initial,
        switch=is_switch,
    )


def _record(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    body: mujoco.MjsBody,
    geoms: NDArray[np.intp],
    name: str,
    found: Found,
    part_of: str,
) -> BodyRecord:
    """Return the record of a body with the size of the box around `geoms`."""
    number = model.body(body.name).id
    low, high = _extents(model, data, geoms, number)
    middle = (low + high) / 2.0
    origin = (float(middle[0]), float(middle[1]), float(low[2]))
    bottom = data.xpos[number] + data.xmat[number].reshape(3, 3) @ np.asarray(origin)
    joints = body.joints
    return BodyRecord(
        name=name,
        class_=found.class_,
        model="",
        size_m=(float(high[0] - low[0]), float(high[1] - low[1]), float(high[2] - low[2])),
        origin_m=origin,
        ordered=pose_of(np.concatenate([bottom, data.xquat[number]])),
        fixed=not (joints and joints[0].type == mujoco.mjtJoint.mjJNT_FREE),
        entity=False,
        masks=[(geom.contype, geom.conaffinity) for geom in body.geoms],
        part_of=part_of,
        body=body.name,
        label=found.label,
        is_sure=found.is_sure,
        anchored=bool(
            part_of
            or model.body_parentid[number]
            or (joints and joints[0].type != mujoco.mjtJoint.mjJNT_FREE)
        ),
    )


def _within(model: mujoco.MjModel, body: int) -> NDArray[np.bool_]:
    """Return (nbody,) which bodies are this one or nested in it; these have higher numbers."""
    within = np.zeros(model.nbody, dtype=bool)
    within[body] = True
    for part in range(body + 1, model.nbody):
        within[part] = within[model.body_parentid[part]]
        if not within[part] and model.body_parentid[part] < body:
            break  # the bodies nested in one follow it contiguously
    return within


def _extents(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: NDArray[np.intp], body: int
) -> tuple[Floats, Floats]:
    """Return lowest and highest corner (3,) of the box around `geoms`, in the frame of a body.

    MuJoCo has boxes in the frames of the geoms, and the axes of a mesh are those of its inertia. A box around
    a turned box would be too large.
    """
    if not len(geoms):
        return np.full(3, -0.005), np.full(3, 0.005)
    world_from_body = data.xmat[body].reshape(3, 3)
    rotation = world_from_body.T @ data.geom_xmat[geoms].reshape(-1, 3, 3)
    centre = (data.geom_xpos[geoms] - data.xpos[body]) @ world_from_body
    aabb = model.geom_aabb[geoms]
    half = np.einsum("nij,nj->ni", np.abs(rotation), aabb[:, 3:])
    middle = centre + np.einsum("nij,nj->ni", rotation, aabb[:, :3])
    low, high = middle - half, middle + half
    for row, geom in enumerate(geoms.tolist()):
        size, axis = model.geom_size[geom], np.abs(rotation[row, :, 2])
        match int(model.geom_type[geom]):
            case mujoco.mjtGeom.mjGEOM_MESH:
                vertices = _vertices_of(model, geom) @ rotation[row].T
                low[row], high[row] = (
                    centre[row] + edge for edge in (vertices.min(axis=0), vertices.max(axis=0))
                )
                continue
            case mujoco.mjtGeom.mjGEOM_SPHERE:
                reach = np.full(3, size[0])
            case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
                reach = np.sqrt(rotation[row] ** 2 @ size**2)
            case mujoco.mjtGeom.mjGEOM_CYLINDER:
                reach = size[0] * np.sqrt(np.maximum(0.0, 1.0 - axis**2)) + size[1] * axis
            case mujoco.mjtGeom.mjGEOM_CAPSULE:
                reach = size[0] + size[1] * axis
            case _:
                continue
        low[row], high[row] = centre[row] - reach, centre[row] + reach
    lowest = low.min(axis=0)
    return lowest, np.maximum(high.max(axis=0), lowest + 1e-3)


def _vertices_of(model: mujoco.MjModel, geom: int) -> Floats:
    """Return the vertices (N, 3) of a mesh in the frame of its geom."""
    mesh = int(model.geom_dataid[geom])
    first = int(model.mesh_vertadr[mesh])
    return np.asarray(model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])], dtype=float)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
