"""Attach and detach: one entity is held by another until it is let go, with what stands on it if wanted."""

from __future__ import annotations

from semmap.nodes.coordinator import holding, transactions
from semmap.nodes.coordinator.dialogues import Talk, ask
from semmap.nodes.coordinator.door.committing import changed, commit, once
from semmap.nodes.coordinator.door.known_map import KnownMap
from semmap.nodes.coordinator.plausibility import require_carrying
from semmap.schemas import errors, wording
from semmap.schemas.attachments import holder_of
from semmap.schemas.bridge import LoadOf
from semmap.schemas.commands import Attach, Detach
from semmap.schemas.entities import Entity, Pose, rounded
from semmap.schemas.replies import Changed


@once
def attach(view: KnownMap, command: Attach) -> Talk[Changed]:
    """Have an entity held by another. Raises Refused where it cannot be."""
    require_carrying(command)
    entity, holder = view.entity(command.name), view.entity(holding.named(command.to, view.entities))
    holding.require_graspable(entity, holder, view.entities, view.bodies())
    is_there = holder_of(entity) == holder.name and command.at is None and command.yaw is None
    already = f"{holder.name} holds {entity.name} already"
    if is_there and not command.carry:
        return changed(None, f"unchanged: {already}", names=(entity.name,))
    borne = () if entity.pose is None else (yield from ask(LoadOf(name=entity.name, leave=command.leave)))
    load = holding.load(borne, entity, holder, view.entities, view.bodies())
    if is_there:
        if load:
            raise errors.Refused(
                f"{already}, without {wording.few(load)}; to take it anew: semmap detach {entity.name}"
            )
        return changed(None, f"unchanged: {already}", names=(entity.name,))
    pose = view.where(entity.name)
    grip = holding.grip(pose, view.where(holder.name), command.at, command.yaw)
    taken = [transactions.Taken(entity.name, holder.name, grip, _rounded(pose))]
    for name in load if command.carry else ():
        its = view.where(name)
        taken.append(
            transactions.Taken(name, entity.name, holding.grip(its, pose, None, None), _rounded(its))
        )
    made = yield from commit(view, transactions.attach(command, holder.name, taken))
    if made is None:
        return changed(None, f"unchanged: {already}", names=(entity.name,))
    notes = (_left(entity, load),) if load and not command.carry else ()
    along = f"; {wording.carried(entity.name, load, command.leave)}" if command.carry else ""
    text = f"{holder.name} holds {entity.name}{_off(grip)}{along}"
    return changed(made, text, names=tuple(one.name for one in taken), notes=notes)


@once
def detach(view: KnownMap, command: Detach) -> Talk[Changed]:
    """Let go of what something holds, and of what was taken with it. Raises Refused where nothing does."""
    entity = view.entity(command.name)
    if not (by := holder_of(entity)):
        raise errors.Refused(f"nothing holds {entity.name}")
    along = holding.taken_with(entity, view.held)
    poses = {name: _rounded(view.where(name)) for name in (entity.name, *along)}
    made = yield from commit(view, transactions.detach(command, poses))
    pose = poses[entity.name]
    at = "" if pose is None else f" at {_metres(pose)}"
    free = f"; {wording.few(along)} {'is' if len(along) == 1 else 'are'} free again, too" if along else ""
    return changed(made, f"{by} let go of {entity.name}{at}{free}", names=tuple(poses))


def _rounded(pose: Pose | None) -> Pose | None:
    return None if pose is None else rounded(pose)


def _off(grip: Pose | None) -> str:
    if grip is None:
        return ""
    return f", at {_metres(grip)} in its frame"


def _metres(pose: Pose) -> str:
    return "({:g}, {:g}, {:g})".format(*(round(c, 3) + 0.0 for c in pose.position_m))


def _left(entity: Entity, load: tuple[str, ...]) -> str:
    verb = "is" if len(load) == 1 else "are"
    return (
        f"{wording.few(load)} {verb} on or inside {entity.name} and held by nothing; to take that along:"
        f" semmap attach {entity.name} --carry"
    )
