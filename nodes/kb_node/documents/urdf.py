"""Reads URDF: the frames of links in that of the root, with all joints at zero, and their boxes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple
from xml.etree import ElementTree as Xml

from semmap.schemas import entities, errors
from semmap.schemas.entities import IDENTITY, REACH_M, Pose, Size, Vector
from semmap.schemas.nesting import require_shallow_xml

_ORIGIN = Pose(position_m=(0.0, 0.0, 0.0))


class Link(NamedTuple):
    """A link in the frame of the root link."""

    frame: Pose
    box: tuple[Pose, Size] | None
    """The middle of the box around its shapes with the orientation of the frame, and its size [m]."""
    meshes: tuple[str, ...]
    """Files of shapes, which are not part of the box."""


def read(content: bytes, name: str) -> dict[str, Link]:
    """Return the links of a robot or an environment. Raises BadFile."""
    try:
        require_shallow_xml(content)
        robot = Xml.fromstring(content)
        if robot.tag != "robot":
            raise ValueError(f"its root element is {robot.tag}, not robot")
        return _read_links(robot)
    except (Xml.ParseError, LookupError, ValueError) as error:
        reason = f"an element lacks the attribute {error}" if isinstance(error, KeyError) else str(error)
        raise errors.BadFile(f"{name or 'the file'} is not valid URDF: {reason}") from None


def _read_links(robot: Xml.Element) -> dict[str, Link]:
    links = {link.attrib["name"]: link for link in robot.iterfind("link")}
    joints: dict[str, tuple[str, Pose]] = {}
    for joint in robot.iterfind("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            raise ValueError(f"the joint {joint.get('name', '')} has no parent or no child")
        for link in (parent.attrib["link"], child.attrib["link"]):
            if link not in links:
                raise ValueError(f"the joint {joint.get('name', '')} refers to {link}, which is not a link")
        if child.attrib["link"] in joints:
            raise ValueError(f"the link {child.attrib['link']} has two parents")
        joints[child.attrib["link"]] = (parent.attrib["link"], _read_origin(joint))
    frames: dict[str, Pose] = {}
    found = {name: _read_link(link, _find_frame(name, joints, frames)) for name, link in links.items()}
    for name, (frame, box, _) in found.items():
        lengths = (*frame.position_m, *(() if box is None else (*box[0].position_m, *box[1])))
        if not all(abs(length) <= REACH_M for length in lengths):
            raise ValueError(f"the link {name} reaches farther than {REACH_M:g} m from the root")
    return found


def _find_frame(name: str, joints: Mapping[str, tuple[str, Pose]], frames: dict[str, Pose]) -> Pose:
    """Return the frame of a link in that of the root. `frames` are those found before, to which it adds."""
    links: list[str] = []
    link = name
    while link not in frames and link in joints:
        links.append(link)
        link, _ = joints[link]
        if len(links) > len(joints):
            raise ValueError(f"the joints above {name} form a cycle")
    frame = frames.get(link, _ORIGIN)
    for below in reversed(links):
        frame = frames[below] = entities.compose(frame, joints[below][1])
    return frame


def _read_link(link: Xml.Element, frame: Pose) -> Link:
    shapes = link.findall("collision") or link.findall("visual")
    corners: list[Vector] = []
    meshes: list[str] = []
    for shape in shapes:
        origin, geometry = _read_origin(shape), shape.find("geometry")
        for form in geometry if geometry is not None else ():
            if form.tag == "mesh":
                meshes.append(form.attrib["filename"])
            else:
                corners += _find_corners(origin, _read_size(form))
    if not corners:
        return Link(frame, None, tuple(meshes))
    low, high = (tuple(map(choose, zip(*corners, strict=True))) for choose in (min, max))
    x, y, z = ((a + b) / 2.0 for a, b in zip(low, high, strict=True))
    dx, dy, dz = (b - a for a, b in zip(low, high, strict=True))
    middle = entities.compose(frame, Pose(position_m=(x, y, z)))
    return Link(frame, (middle, (dx, dy, dz)) if min(dx, dy, dz) > 0 else None, tuple(meshes))


def _read_size(form: Xml.Element) -> Size:
    """Return the size of the box around a primitive shape [m]."""
    if form.tag == "box":
        return _read_vector(form.attrib["size"])
    if form.tag not in ("cylinder", "sphere", "capsule"):
        raise ValueError(f"unknown shape '{form.tag}'")
    width = 2.0 * _read_numbers(form.attrib["radius"], 1)[0]
    if form.tag == "sphere":
        return (width, width, width)
    length = _read_numbers(form.attrib["length"], 1)[0]
    return (width, width, length + width if form.tag == "capsule" else length)


def _find_corners(origin: Pose, size: Size) -> Iterator[Vector]:
    dx, dy, dz = (extent / 2.0 for extent in size)
    for x in (-dx, dx):
        for y in (-dy, dy):
            for z in (-dz, dz):
                yield entities.compose(origin, Pose(position_m=(x, y, z))).position_m


def _read_origin(element: Xml.Element) -> Pose:
    """Return the pose in the `origin` of an element: `xyz` [m] and `rpy` [rad]."""
    origin = element.find("origin")
    if origin is None:
        return _ORIGIN
    pose = Pose(position_m=_read_vector(origin.get("xyz", "0 0 0")))
    roll, pitch, yaw = _read_vector(origin.get("rpy", "0 0 0"))
    for turn in (
        (math.cos(yaw / 2.0), 0.0, 0.0, math.sin(yaw / 2.0)),
        (math.cos(pitch / 2.0), 0.0, math.sin(pitch / 2.0), 0.0),
        (math.cos(roll / 2.0), math.sin(roll / 2.0), 0.0, 0.0),
    ):
        if turn != IDENTITY:
            pose = entities.compose(pose, Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=turn))
    return pose


def _read_vector(text: str) -> Vector:
    x, y, z = _read_numbers(text, 3)
    return (x, y, z)


def _read_numbers(text: str, count: int) -> list[float]:
    numbers = list(map(float, text.split()))
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise ValueError(f"'{text}' is not {count} finite numbers")
    return numbers
