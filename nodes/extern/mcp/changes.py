"""The tools that change the map: propose, commit, undo. They raise SemmapError.

A proposal is a dry run whose result an agent reads before it commits. It is committed once, and only if none
of the entities has changed that it names, or that its inferred facts are about. The knowledge base checks
that in the transaction.
"""

from __future__ import annotations

import math
import re
import threading
import time
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final, TypeVar

import msgspec
from msgspec import structs

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import arguments as a
from semmap.nodes.extern.mcp import limits, queries, requests
from semmap.nodes.extern.mcp.answers import Answer, attribute_text, format_author
from semmap.nodes.extern.mcp.consistent_read import known, newest, read_at_one_commit
from semmap.nodes.extern.mcp.hints import translate_hints
from semmap.nodes.extern.mcp.limits import Limits, Rate, Touched
from semmap.nodes.extern.mcp.proposals import Proposal, Proposals
from semmap.nodes.extern.mcp.requests import Summary
from semmap.schemas import codec, commands, errors
from semmap.schemas.approvals import Request
from semmap.schemas.commands import COMMANDS, Command
from semmap.schemas.entities import NAME_PATTERN, ClassInfo, Entity
from semmap.schemas.replies import Changed

R = TypeVar("R")

_NAME: Final = re.compile(NAME_PATTERN)
_PATIENCE_S: Final = 20.0
"""How long a commit waits for the approval of a person before it returns [s]."""
_AGAIN_S: Final = 0.5
_DRY_RUN: Final = "it would be: "
"""The text before the change in the reply of a dry run."""
_UNCHANGED: Final = re.compile(r"([\w.-]+: )?unchanged: ")
"""The beginning of the reply if nothing would change."""
_MOST_WAITERS: Final = 2
"""The number of calls that wait for approval at the same time, each on a thread; others do not wait."""
_LATER_S: Final = 30.0
"""The suggested time until a retry if there are too many pending requests [s]."""
_MOST_REQUESTED: Final = 1000


class Changes:
    """The permissions and the proposals of one agent. It can be used from any thread."""

    def __init__(
        self,
        client: Client,
        agent: str,
        *,
        allowed: Limits | None = None,
        per_min: float = limits.CHANGES_PER_MIN,
        approve: bool = False,
        patience_s: float = _PATIENCE_S,
    ) -> None:
        """Set up; `agent` signs the commits. Raises UnknownClass, UnknownName for unknown limits."""
        self._agent = agent
        self._approve = approve
        self._patience_s = patience_s
        self._proposals = Proposals()
        self._rate = Rate(per_min / 60.0, max(1.0, per_min))
        self._per_min = per_min
        self._waiters = threading.BoundedSemaphore(_MOST_WAITERS)
        self._requested: dict[str, None] = {}
        self._limits = _known(client, allowed or Limits())

    def propose(self, client: Client, arguments: a.Propose) -> Answer:
        """Run a change as a dry run, and return a token for `commit`, or the reason against the change."""
        command = self._command(arguments)
        try:
            tried, first, last = _at_one(client, lambda: client.send(structs.replace(command, dry_run=True)))
        except (errors.Inconsistent, errors.PreconditionFailed) as error:
            against = attribute_text(
                translate_hints(errors.shortened(error.text, 2000)), "the knowledge base"
            )
            seq = newest(client)
            return Answer(first=seq, last=seq, head={"possible": False, "against": against})
        if isinstance(command, commands.Add) and command.name is None:
            command = structs.replace(command, name=tried.names[0])
        self._require_allowed(client, command, tried)
        if _UNCHANGED.match(_would_be(tried)):
            already = {"possible": True, "changes": False, "then": "nothing: the map already has this state"}
            return Answer(first=first, last=last, head=already)
        made = self._proposals.add(
            command=command, commit=first, tried=tried, rests_on=_rests_on(client, command, tried)
        )
        head = {
            "possible": True,
            "token": made.token,
            "would_be": attribute_text(_would_be(tried), format_author("agent", self._agent)),
            **(
                {"notes": attribute_text(translate_hints("; ".join(tried.notes)), "the map")}
                if tried.notes
                else {}
            ),
            "rests_on": made.rests_on,
            "then": "commit with this token" + (", which requires approval" if self._approve else ""),
        }
        facts = [{"follows": fact} for fact in tried.follows]
        facts += [{"no_longer_follows": fact} for fact in tried.no_longer_follows]
        return Answer(first=first, last=last, head=head, items=facts, of="facts")

    def commit(self, client: Client, arguments: a.Commit) -> Answer:
        """Commit a proposal once, and only if the entities that it depends on have not changed."""
        proposal = self._proposals.take(arguments.token)
        try:
            self._require_unchanged(client, proposal)
            summary = requests.summarize_change(proposal.command, proposal.tried)
            request = self._allowed(client, f"mcp-{proposal.token}", summary)
            if request is not None and request.decision == "waiting":
                self._proposals.put_back(proposal)
                return self._waiting(client, request)
            made = client.send(
                structs.replace(
                    proposal.command,
                    id=f"mcp-{proposal.token}",
                    unchanged=proposal.rests_on,
                    since=proposal.commit,
                )
            )
        except (errors.Busy, errors.NoAnswer):  # it may be retried: with its id it is executed once
            self._proposals.put_back(proposal)
            raise
        except errors.PreconditionFailed as error:
            self._proposals.drop(proposal)
            raise errors.PreconditionFailed(self._changed_since(client, proposal) or error.text) from None
        except BaseException:
            self._proposals.drop(proposal)
            raise
        seq = made.commit if made.commit is not None else newest(client)
        self._proposals.finish(proposal, seq)
        head: dict[str, Any] = {"done": made.commit is not None, "names": made.names}
        if request is not None:
            head["approved_by"] = request.by
        head["undo"] = f"undo commit={seq}" if made.commit is not None else "nothing has changed"
        return Answer(
            first=seq,
            last=seq,
            head={**head, "text": attribute_text(made.text, format_author("agent", self._agent))},
        )

    def undo(self, client: Client, arguments: a.Undo) -> Answer:
        """Undo a commit of this agent."""
        found = client.history(since=arguments.commit, until=arguments.commit, limit=1)
        if not found or found[0].seq != arguments.commit:
            raise errors.Refused(f"there is no commit {arguments.commit} in the history; see: history")
        if (found[0].source, found[0].agent) != ("agent", self._agent):
            by = format_author(found[0].source, found[0].agent)
            raise errors.Refused(f"commit {arguments.commit} is by {by}; you may undo only your own commits")
        undo = commands.Undo(
            commit=arguments.commit,
            source="agent",
            agent=self._agent,
            reason=arguments.reason or "undo by agent",
        )
        tried = client.send(structs.replace(undo, dry_run=True))
        self._require_allowed(client, undo, tried)
        summary = requests.summarize_undo(found[0], tried, arguments.reason)
        last = _last_change(client, tried.names, arguments.commit)  # an approval is for this state only
        request = self._allowed(client, f"mcp-undo-{arguments.commit}-{last}", summary)
        if request is not None and request.decision == "waiting":
            return self._waiting(client, request)
        made = client.send(undo)
        seq = made.commit if made.commit is not None else newest(client)
        return Answer(first=seq, last=seq, head={"undone": arguments.commit, "names": made.names})

    def _command(self, arguments: a.Propose) -> Any:
        """Return the proposed command, signed. Raises BadRequest for fields that it does not have."""
        fields = msgspec.to_builtins(arguments)
        verb = fields.pop("verb")
        known_fields = COMMANDS[verb].__struct_encode_fields__
        if unknown := [name for name in fields if name not in known_fields]:
            valid = sorted(set(known_fields) & set(a.Propose.__struct_encode_fields__) - {"verb"})
            raise errors.BadRequest(
                f"propose: {verb} has no field {unknown[0]}; valid fields: {', '.join(valid)}"
            )
        if verb == "add" and not fields.keys() & {"at", "on", "in", "next_to"}:
            raise errors.BadRequest("propose: missing field at, on, in or next_to; at is [x, y, z] in metres")
        try:
            return codec.convert({**fields, "source": "agent", "agent": self._agent}, COMMANDS[verb])
        except errors.BadRequest as error:
            raise errors.BadRequest(f"propose: {error.text.removeprefix(codec.MALFORMED)}") from None

    def _require_allowed(self, client: Client, command: Any, tried: Changed) -> None:
        """Raise Refused for a change beyond the limits."""
        if len(tried.names) > a.MOST:
            raise errors.Refused(f"a change is limited to {a.MOST} entities; propose smaller changes")
        if self._limits == Limits():
            return
        classes = client.classes()
        limits.require(
            self._limits, [_touched(client, name, command, tried, classes) for name in tried.names]
        )

    def _require_rate(self) -> None:
        if (wait_s := self._rate.wait_s()) > 0.0:
            raise errors.Busy(
                f"rate limit exceeded: {self._per_min:g} changes per minute; retry in {math.ceil(wait_s)} s",
                again_s=wait_s,
            )

    def _require_unchanged(self, client: Client, proposal: Proposal) -> None:
        """Raise PreconditionFailed, with the reason, if the proposal would now have other consequences."""
        changed = self._changed_since(client, proposal)
        if changed:
            raise errors.PreconditionFailed(changed)
        again: Changed = client.send(structs.replace(proposal.command, dry_run=True))
        before = proposal.tried
        if set(again.follows) != set(before.follows) or again.names != before.names:
            raise errors.PreconditionFailed(
                f"the map has changed since commit {proposal.commit}: the change would have other"
                " consequences; propose it again"
            )

    def _changed_since(self, client: Client, proposal: Proposal) -> str:
        """Return a text on changed entities that a proposal depends on, or an empty text."""
        if newest(client) <= proposal.commit:
            return ""
        for commit in client.history(since=proposal.commit + 1, limit=1000):
            if hit := [n for n in proposal.rests_on if n in commit.changed or n in commit.removed]:
                by = format_author(commit.source, commit.agent)
                return (
                    f"the map has changed since commit {proposal.commit}: {errors.enumerated(hit[:5])}"
                    f" was changed by commit {commit.seq} ({by}); propose it again"
                )
        return ""

    def _allowed(self, client: Client, name: str, summary: Summary) -> Request | None:
        """Request approval and wait for it a short time; return None if no approval is required.

        Each change counts once against the rate limit: when approval is requested, or else when it is made.
        Raises Busy beyond the rate, and Refused if the request was rejected.
        """
        if not self._approve:
            self._require_rate()
            return None
        if name not in self._requested:
            self._require_rate()
        submit = commands.Submit(
            id=name,
            source="agent",
            agent=self._agent,
            text=errors.shortened(summary.text, 1900),
            reason=summary.reason,
            follows=tuple(errors.shortened(fact, 900) for fact in summary.follows),
        )
        try:
            request = client.send(submit)
        except errors.Refused as error:  # too many pending requests; the proposal stays valid
            raise errors.Busy(error.text, again_s=_LATER_S) from None
        self._requested[name] = None
        while len(self._requested) > _MOST_REQUESTED:
            del self._requested[next(iter(self._requested))]
        if request.decision == "waiting" and self._waiters.acquire(blocking=False):
            try:
                request = self._decided(client, submit)
            finally:
                self._waiters.release()
        if request.decision == "rejected":
            raise errors.Refused(f"request {request.number} was rejected by {request.by}")
        return request

    def _decided(self, client: Client, submit: commands.Submit) -> Request:
        """Return the request when it is decided, or when the timeout has passed."""
        deadline = time.monotonic() + self._patience_s
        while (request := client.send(submit)).decision == "waiting" and time.monotonic() < deadline:
            time.sleep(_AGAIN_S)
        return request

    def _waiting(self, client: Client, request: Request) -> Answer:
        seq = newest(client)
        head = {
            "done": False,
            "waiting_for_a_person": f"semmap approve {request.number}",
            "then": "call again with the same arguments",
        }
        return Answer(first=seq, last=seq, head=head)


def _at_one(client: Client, read: Callable[[], R]) -> tuple[R, int, int]:
    return read_at_one_commit(partial(known, client), partial(newest, client), read)


def _would_be(tried: Changed) -> str:
    return tried.text.partition(_DRY_RUN)[2] or tried.text


def _rests_on(client: Client, command: Command[Changed], tried: Changed) -> tuple[str, ...]:
    """Return the entities that a change changes or names, and those of its inferred facts."""
    words = [word for fact in (*tried.follows, *tried.no_longer_follows) for word in fact.split(" ")]
    words += [value for value in getattr(command, "values", ()) if isinstance(value, str)]
    named = dict.fromkeys(word for word in (*tried.names, *words) if _NAME.match(word))
    there = {entity.name for entity in client.list()}
    return tuple(name for name in named if name in there)


def _touched(
    client: Client, name: str, command: Any, tried: Changed, classes: Iterable[ClassInfo]
) -> Touched:
    """Return an entity with its classes and places before and after a change, for the limits."""
    entity = _entity(client, name)
    before = frozenset() if entity is None else frozenset(entity.types)
    places = queries.placed(client, [entity]).get(name, {}).get("in", []) if entity is not None else []
    word = getattr(command, "class_", None)
    after = before if word is None else _with_ancestors(word, classes)
    is_gone = isinstance(command, commands.Remove)
    if isinstance(command, commands.Undo) and command.commit is not None:
        restored = _entity(client, name, as_of=command.commit - 1)
        after, is_gone = frozenset(() if restored is None else restored.types), restored is None
    return Touched(
        name=name,
        classes_before=before,
        classes_after=after,
        places_before=frozenset(places),
        places_after=limits.after(places, name, tried.follows, tried.no_longer_follows),
        is_new=entity is None,
        is_gone=is_gone,
    )


def _entity(client: Client, name: str, **fields: Any) -> Entity | None:
    """Return an entity, or None if the map has none of this name."""
    try:
        return client.get(name, **fields)
    except errors.UnknownName:
        return None


def _last_change(client: Client, names: Iterable[str], since: int) -> int:
    """Return the newest commit from `since` on that changed or removed one of these entities."""
    commits = client.history(since=since, limit=1000)
    return max((c.seq for c in commits if {*names} & {*c.changed, *c.removed}), default=since)


def _with_ancestors(word: str, classes: Iterable[ClassInfo]) -> frozenset[str]:
    key = word.rpartition(":")[2].casefold().replace("_", "")
    found = [info for info in classes if info.name.casefold().replace("_", "") == key]
    return frozenset(name for info in found for name in (info.name, *info.ancestors))


def _known(client: Client, allowed: Limits) -> Limits:
    """Return the limits with the names of the map. Raises UnknownClass, UnknownName."""
    if allowed == Limits():
        return allowed
    names = {info.name.casefold().replace("_", ""): info.name for info in client.classes()}
    places = {entity.name for entity in client.list() if entity.place}
    for word in sorted(allowed.places - places):
        raise errors.UnknownName(f"no place is named '{word}'{errors.did_you_mean(word, places)}")
    return Limits(classes=limits.resolve_classes(allowed.classes, names), places=allowed.places)
