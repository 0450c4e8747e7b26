"""Attachments: bodies attached to others by MuJoCo weld constraints.

A weld is part of the compiled model, so attaching and detaching recompile it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import mujoco

from semmap.nodes.sim_node.bodies import BodyRecord, frame_of
from semmap.schemas.entities import Pose

_STIFF = (0.008, 1.0)
"""Time constant [s] and damping of a weld (`solref`)."""
_HARD = (0.99, 0.999, 0.001, 0.5, 2.0)
"""Stiffness of the constraint (`solimp`)."""


def add_welds(spec: mujoco.MjSpec, records: Mapping[str, BodyRecord]) -> None:
    """Weld attached bodies to their holders, and exclude collisions with all parts of the holder."""
    for record in attached_records(records):
        holder = records[record.held_by]
        body = spec.body(holder.body)
        spec.body(record.body).gravcomp = 1.0  # its weight must not bend the arm
        weld = spec.add_equality(
            type=mujoco.mjtEq.mjEQ_WELD,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            name1=holder.body,
            name2=record.body,
            solref=_STIFF,
            solimp=_HARD,
        )
        weld.data[:11] = [0.0, 0.0, 0.0, *_in_body_frames(record, holder), 1.0]
        for name in _whole_of(spec, body):
            spec.add_exclude(bodyname1=name, bodyname2=record.body)


def attached_records(records: Mapping[str, BodyRecord]) -> list[BodyRecord]:
    """Return the attached bodies, holders before their attachments."""
    found: dict[str, BodyRecord] = {}
    waiting = [record for record in records.values() if record.held_by in records]
    for record in sorted(waiting, key=lambda record: len(holders_of(record.name, records))):
        found[record.name] = record
    return list(found.values())


def holders_of(name: str, records: Mapping[str, BodyRecord]) -> list[str]:
    """Return all bodies that a body is attached to or part of, directly or not, without repetition."""
    found: list[str] = []
    waiting = [name]
    while waiting:
        record = records.get(waiting.pop())
        for above in () if record is None else (record.held_by, record.part_of):
            if above and above not in found:
                found.append(above)
                waiting.append(above)
    return found


def involves_attachment(names: Iterable[str], records: Mapping[str, BodyRecord]) -> bool:
    """Return whether one of these is attached, or has an attachment."""
    names = set(names)
    return any(r.held_by and not names.isdisjoint((r.name, r.held_by)) for r in records.values())


def _in_body_frames(record: BodyRecord, holder: BodyRecord) -> list[float]:
    """Return the pose of the attached MuJoCo body in the frame of the other: position [m] and quaternion."""
    grip = record.grip or Pose(position_m=(0.0, 0.0, 0.0))
    position, quaternion = frame_of(grip, record.origin_m)
    return [*(position + holder.origin_m).tolist(), *quaternion.tolist()]


def _whole_of(spec: mujoco.MjSpec, body: mujoco.MjsBody) -> list[str]:
    """Return the named bodies of the tree of a body."""
    while body.parent is not None and body.parent.name != "world":
        body = body.parent
    found, waiting = [], [body]
    while waiting:
        one = waiting.pop()
        waiting.extend(one.bodies)
        if one.name:
            found.append(one.name)
    return found
