"""The tools that change the map: propose, commit, undo. They raise SemmapError.

A proposal is a dry run whose result an agent reads before it commits. It is committed once, and only if none
of the entities has changed that it names, or that its inferred facts are about. The knowledge base checks
that in the transaction.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final, TypeVar

import msgspec
from msgspec import structs

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import arguments as a
from semmap.nodes.extern.mcp import limits, requests
from semmap.nodes.extern.mcp.actions import Actions
from semmap.nodes.extern.mcp.answers import Answer, attribute_text, format_author
from semmap.nodes.extern.mcp.approval import PATIENCE_S, Approval, report_waiting, require_not_cancelled
from semmap.nodes.extern.mcp.consistent_read import known, newest, read_at_one_commit
from semmap.nodes.extern.mcp.hints import translate_hints
from semmap.nodes.extern.mcp.limits import Limits
from semmap.nodes.extern.mcp.permissions import Permissions
from semmap.nodes.extern.mcp.proposals import Proposal, Proposals
from semmap.schemas import codec, commands, errors, wording
from semmap.schemas.commands import COMMANDS, Command
from semmap.schemas.entities import NAME_PATTERN
from semmap.schemas.replies import Changed

R = TypeVar("R")

_NAME: Final = re.compile(NAME_PATTERN)
_DRY_RUN: Final = "it would be: "
"""The text before the change in the reply of a dry run."""
_UNCHANGED: Final = re.compile(r"([\w.-]+: )?unchanged: ")
"""The beginning of the reply if nothing would change."""


class Changes:
    """The permissions and the proposals of one agent. It can be used from any thread."""

    def __init__(
        self,
        agent: str,
        *,
        allowed: Limits | None = None,
        per_min: float = limits.CHANGES_PER_MIN,
        approve: bool = False,
        patience_s: float = PATIENCE_S,
    ) -> None:
        """Set up; `agent` signs the commits."""
        self._agent = agent
        self._proposals = Proposals()
        self._permissions = Permissions(allowed or Limits())
        self._approval = Approval(agent, per_min=per_min, required=approve, patience_s=patience_s)
        self.actions = Actions(agent, self._permissions, self._approval)

    def check_limits(self, client: Client) -> None:
        """Raise UnknownClass or UnknownName if the map lacks a class or place of the limits."""
        self._permissions.resolve(client)

    def withdraw_requests(self, client: Client) -> None:
        """Withdraw the pending requests for approval, because the agent has ended."""
        self._approval.withdraw_all(client)

    def propose(self, client: Client, arguments: a.Propose) -> Answer:
        """Run a change as a dry run, and return a token for `commit`, or the reason against the change."""
        command = self._command(arguments)
        is_unnamed = isinstance(command, commands.Add) and command.name is None
        try:
            tried, first, last = _at_one(client, lambda: client.send(structs.replace(command, dry_run=True)))
        except (errors.Inconsistent, errors.PreconditionFailed) as error:
            against = attribute_text(
                translate_hints(errors.shortened(error.text, 2000)), "the knowledge base"
            )
            seq = newest(client)
            return Answer(first=seq, last=seq, head={"possible": False, "against": against})
        self._permissions.require_change(client, command, tried)
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
            **({"name": f"{tried.names[0]}, or the next free name at commit"} if is_unnamed else {}),
            "rests_on": made.rests_on,
            "then": "commit with this token"
            + (", which requires approval" if self._approval.required else ""),
        }
        facts = [{"follows": fact} for fact in tried.follows]
        facts += [{"no_longer_follows": fact} for fact in tried.no_longer_follows]
        return Answer(first=first, last=last, head=head, items=facts, of="facts")

    def commit(self, client: Client, arguments: a.Commit) -> Answer:
        """Commit a proposal once, and only if the entities that it depends on have not changed."""
        proposal = self._proposals.take(arguments.token)
        if proposal.done is not None:
            again = "this token was committed before; this is the reply to that, and nothing was done now"
            return structs.replace(proposal.done, head={**proposal.done.head, "note": again})
        sent, request = proposal.sent, None
        try:
            if not sent:  # otherwise the first request may have been executed, and its id tells
                tried = self._require_unchanged(client, proposal)
                summary = requests.summarize_change(proposal.command, tried)
                request = self._approval.require(client, f"mcp-{proposal.token}", summary)
                if request is not None and request.decision == "waiting":
                    self._proposals.put_back(proposal)
                    return report_waiting(client, request)
                require_not_cancelled()
            sent = True
            made = client.send(
                structs.replace(
                    proposal.command,
                    id=f"mcp-{proposal.token}",
                    unchanged=proposal.rests_on,
                    since=proposal.commit,
                )
            )
        except (errors.Busy, errors.NoAnswer):  # it may be retried: with its id it is executed once
            self._proposals.put_back(proposal, sent=sent)
            raise
        except errors.PreconditionFailed as error:
            self._proposals.drop(proposal)
            raise errors.PreconditionFailed(self._changed_since(client, proposal) or error.text) from None
        except BaseException:
            self._proposals.drop(proposal)
            raise
        seq = made.commit if made.commit is not None else newest(client)
        head: dict[str, Any] = {"done": made.commit is not None, "names": made.names}
        if request is not None:
            head["approved_by"] = request.by
        head["undo"] = f"undo commit={seq}" if made.commit is not None else "nothing has changed"
        head["text"] = attribute_text(made.text, format_author("agent", self._agent))
        reply = Answer(first=seq, last=seq, head=head)
        self._proposals.finish(proposal, reply)
        return reply

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
        self._permissions.require_change(client, undo, tried)
        summary = requests.summarize_undo(found[0], tried, arguments.reason)
        last = _last_change(client, tried.names, arguments.commit)  # an approval is for this state only
        request = self._approval.require(client, f"mcp-undo-{arguments.commit}-{last}", summary)
        if request is not None and request.decision == "waiting":
            return report_waiting(client, request)
        require_not_cancelled()
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
        if verb == "add" and wording.reads_like_text(fields.get("name", "")):
            raise errors.BadRequest(
                f"propose: the name '{fields['name'][: wording.LONGEST_NAME]}' reads like a text; choose one"
                f" of at most four words and {wording.LONGEST_NAME} characters, and use ref for a text"
            )
        if verb == "add" and not fields.keys() & {"at", "on", "in", "next_to"}:
            raise errors.BadRequest("propose: missing field at, on, in or next_to; at is [x, y, z] in metres")
        try:
            return codec.convert({**fields, "source": "agent", "agent": self._agent}, COMMANDS[verb])
        except errors.BadRequest as error:
            raise errors.BadRequest(f"propose: {error.text.removeprefix(codec.MALFORMED)}") from None

    def _require_unchanged(self, client: Client, proposal: Proposal) -> Changed:
        """Return a new dry run of a proposal.

        Raises PreconditionFailed, with the reason, if the proposal would now have other consequences. A new
        entity without a name may get another name than in the first dry run.
        """
        changed = self._changed_since(client, proposal)
        if changed:
            raise errors.PreconditionFailed(changed)
        again: Changed = client.send(structs.replace(proposal.command, dry_run=True))
        before = proposal.tried
        if isinstance(proposal.command, commands.Add) and proposal.command.name is None:
            before = _renamed(before, again.names)
        if set(again.follows) != set(before.follows) or again.names != before.names:
            raise errors.PreconditionFailed(
                f"the map has changed since commit {proposal.commit}: the change would have other"
                " consequences; propose it again"
            )
        return again

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


def _at_one(client: Client, read: Callable[[], R]) -> tuple[R, int, int]:
    return read_at_one_commit(partial(known, client), partial(newest, client), read)


def _would_be(tried: Changed) -> str:
    return tried.text.partition(_DRY_RUN)[2] or tried.text


def _renamed(tried: Changed, names: tuple[str, ...]) -> Changed:
    """Return a dry run of `add` as if the new entity had got the name in `names`."""
    (old,), (new,) = tried.names, names

    def renamed(fact: str) -> str:
        return " ".join(
            new + word.removeprefix(old) if word == old or word.startswith(f"{old}_") else word
            for word in fact.split(" ")
        )

    return structs.replace(tried, names=names, follows=tuple(map(renamed, tried.follows)))


def _rests_on(client: Client, command: Command[Changed], tried: Changed) -> tuple[str, ...]:
    """Return the entities that a change changes or names, and those of its inferred facts."""
    words = [word for fact in (*tried.follows, *tried.no_longer_follows) for word in fact.split(" ")]
    words += [value for value in getattr(command, "values", ()) if isinstance(value, str)]
    named = dict.fromkeys(word for word in (*tried.names, *words) if _NAME.match(word))
    there = {entity.name for entity in client.list()}
    return tuple(name for name in named if name in there)


def _last_change(client: Client, names: Iterable[str], since: int) -> int:
    """Return the newest commit from `since` on that changed or removed one of these entities."""
    commits = client.history(since=since, limit=1000)
    return max((c.seq for c in commits if {*names} & {*c.changed, *c.removed}), default=since)
