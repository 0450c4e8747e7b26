"""Handlers of attach and detach: an entity, and on request its contents, moves with its holder."""

from __future__ import annotations

from semmap.nodes.coordinator.commands import attachment_rules, transactions
from semmap.nodes.coordinator.commands.commit import commit, make_reply
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.plausibility import require_carry
from semmap.nodes.coordinator.commands.registration import handles
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.schemas import errors, wording
from semmap.schemas.attachments import holder_of
from semmap.schemas.bridge import LoadOf
from semmap.schemas.commands import Attach, Detach
from semmap.schemas.entities import Entity, Pose, rounded
from semmap.schemas.replies import Changed


@handles(Attach)
def attach(view: MapView, command: Attach) -> KbCoroutine[Changed]:
    """Attach an entity to another. Raises Refused if that is not possible."""
    require_carry(command)
    entity, holder = (
        view.entity(command.name),
        view.entity(attachment_rules.resolve_name(command.to, view.entities)),
    )
    attachment_rules.require_attachable(entity, holder, view.entities, view.bodies())
    if command.at is None and not command.force:
        attachment_rules.require_in_reach(entity, holder, view.pose_of, view.bodies())
    is_there = holder_of(entity) == holder.name and command.at is None and command.yaw is None
    already = f"{entity.name} is already attached to {holder.name}"
    if is_there and not command.carry:
        return make_reply(None, f"unchanged: {already}", names=(entity.name,))
    supported = () if entity.pose is None else (yield from ask(LoadOf(name=entity.name, leave=command.leave)))
    load = attachment_rules.find_load(supported, entity, holder, view.entities, view.bodies())
    if is_there:
        if load:
            raise errors.Refused(
                f"{already}, without {wording.few(load)}; first: semmap detach {entity.name}"
            )
        return make_reply(None, f"unchanged: {already}", names=(entity.name,))
    pose = view.pose_of(entity.name)
    grip = attachment_rules.compute_grip(pose, view.pose_of(holder.name), command.at, command.yaw)
    taken = [transactions.Attachment(entity.name, holder.name, grip, _rounded(pose))]
    for name in load if command.carry else ():
        its = view.pose_of(name)
        taken.append(
            transactions.Attachment(
                name, entity.name, attachment_rules.compute_grip(its, pose, None, None), _rounded(its)
            )
        )
    made = yield from commit(view, transactions.attach(command, holder.name, taken))
    if made is None:
        return make_reply(None, f"unchanged: {already}", names=(entity.name,))
    notes = (_describe_left(entity, load),) if load and not command.carry else ()
    along = f"; {wording.carried(entity.name, load, command.leave)}" if command.carry else ""
    text = f"{entity.name} is attached to {holder.name}{_describe_offset(grip)}{along}"
    return make_reply(made, text, names=tuple(one.name for one in taken), notes=notes)


@handles(Detach)
def detach(view: MapView, command: Detach) -> KbCoroutine[Changed]:
    """Detach an entity, and what was attached together with it. Raises Refused if it is not attached."""
    entity = view.entity(command.name)
    if not (by := holder_of(entity)):
        raise errors.Refused(f"{entity.name} is not attached")
    along = attachment_rules.find_attached_with(entity, view.held)
    poses = {name: _rounded(view.pose_of(name)) for name in (entity.name, *along)}
    made = yield from commit(view, transactions.detach(command, poses))
    pose = poses[entity.name]
    at = "" if pose is None else f" at {_format_position(pose)}"
    free = f"; also detached: {wording.few(along)}" if along else ""
    return make_reply(made, f"{entity.name} is detached from {by}{at}{free}", names=tuple(poses))


def _rounded(pose: Pose | None) -> Pose | None:
    return None if pose is None else rounded(pose)


def _describe_offset(grip: Pose | None) -> str:
    if grip is None:
        return ""
    return f", at {_format_position(grip)} in its frame"


def _format_position(pose: Pose) -> str:
    return "({:g}, {:g}, {:g})".format(*(round(c, 3) + 0.0 for c in pose.position_m))


def _describe_left(entity: Entity, load: tuple[str, ...]) -> str:
    verb = "is" if len(load) == 1 else "are"
    return (
        f"{wording.few(load)} {verb} on or inside {entity.name} but not attached; to attach the contents too:"
        f" semmap attach {entity.name} --carry"
    )
