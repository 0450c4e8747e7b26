"""The tools that move bodies of the scene: open, close, drive. They raise SemmapError.

They take effect immediately, within the limits, at the rate of changes and, if required, after approval.
"""

from __future__ import annotations

import secrets
import threading
from collections import OrderedDict
from typing import Any, Final

from msgspec import structs

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import arguments as a
from semmap.nodes.extern.mcp import requests
from semmap.nodes.extern.mcp.answers import Answer, attribute_text
from semmap.nodes.extern.mcp.approval import Approval, report_waiting, require_not_cancelled
from semmap.nodes.extern.mcp.consistent_read import newest
from semmap.nodes.extern.mcp.permissions import Permissions
from semmap.schemas import commands, errors
from semmap.schemas.plans import Point
from semmap.schemas.replies import Moved

_MOST: Final = 200
"""The maximum number of actions that wait for approval; the oldest are dropped."""
_Action = commands.Open | commands.Close | commands.Drive


class Actions:
    """The actions of one agent. They can be used from any thread."""

    def __init__(self, agent: str, permissions: Permissions, approval: Approval) -> None:
        self._agent = agent
        self._permissions = permissions
        self._approval = approval
        self._lock = threading.Lock()
        self._ids: OrderedDict[_Action, str] = OrderedDict()
        """The ids of the actions that are not done yet: a call with the same arguments is the same action."""

    def open(self, client: Client, arguments: a.Open) -> Answer:
        """Open an object, and return when its joints have stopped."""
        opening = commands.Open(
            name=arguments.name, to=arguments.to, joint=arguments.joint, wait=True, **self._signed(arguments)
        )
        return self._act(client, opening)

    def close(self, client: Client, arguments: a.Close) -> Answer:
        """Close an object, and return when its joints have stopped."""
        closing = commands.Close(
            name=arguments.name, joint=arguments.joint, wait=True, **self._signed(arguments)
        )
        return self._act(client, closing)

    def drive(self, client: Client, arguments: a.Drive) -> Answer:
        """Drive a robot through points or stop it, and return immediately unless `wait` is set."""
        driving = commands.Drive(
            name=arguments.name,
            to=arguments.to,
            yaw=arguments.yaw,
            stop=arguments.stop,
            wait=arguments.wait,
            **self._signed(arguments),
        )
        return self._act(client, driving, arguments.to)

    def _signed(self, arguments: a.Open | a.Close | a.Drive) -> dict[str, Any]:
        return {"source": "agent", "agent": self._agent, "reason": arguments.reason}

    def _act(self, client: Client, command: _Action, path: tuple[Point, ...] = ()) -> Answer:
        entity = client.get(command.name)
        self._permissions.require_action(client, entity, path)
        command = structs.replace(command, name=entity.name)  # the word may be a label or class
        request = None
        if isinstance(command, commands.Drive) and command.stop:  # stopping is always permitted
            moved = client.send(command)
        else:
            name = self._id(command)
            try:
                request = self._approval.require(client, name, requests.summarize_action(command))
                if request is not None and request.decision == "waiting":
                    return report_waiting(client, request)
                if request is not None:  # meanwhile the robot may have been moved
                    self._permissions.require_action(client, client.get(entity.name), path)
                require_not_cancelled()
            except (errors.Busy, errors.NoAnswer):
                raise
            except BaseException:
                self._forget(command)
                raise
            moved = self._send_once(client, command, name)
        seq = moved.commit if moved.commit is not None else newest(client)
        is_done = moved.is_final or (isinstance(command, commands.Drive) and command.stop)
        head: dict[str, Any] = {
            "done": is_done,
            **({} if is_done else {"then": "the map has the new state when it has stopped"}),
            "name": moved.name,
            "text": attribute_text("; ".join((moved.text, *moved.notes)), "semmap"),
        }
        if request is not None:
            head["approved_by"] = request.by
        return Answer(first=seq, last=seq, head=head)

    def _id(self, command: _Action) -> str:
        with self._lock:
            found = self._ids.setdefault(command, f"mcp-{command.VERB}-{secrets.token_urlsafe(12)}")
            while len(self._ids) > _MOST:
                self._ids.popitem(last=False)
            return found

    def _send_once(self, client: Client, command: _Action, name: str) -> Moved:
        """Send an action after deleting its id, so that an approval is for one execution.

        Raises Busy if a parallel call has done so.
        """
        with self._lock:
            if self._ids.get(command) != name:
                raise errors.Busy("another call executes this action", again_s=1.0)
            del self._ids[command]
        try:
            return client.send(command)
        except errors.Busy:  # not executed
            with self._lock:
                self._ids.setdefault(command, name)
            raise
        except errors.NoAnswer as error:
            again = ", which requires approval again" if self._approval.required else ""
            raise errors.NoAnswer(
                f"{error.text}; the action may have been executed: see get before you repeat it{again}"
            ) from None

    def _forget(self, command: _Action) -> None:
        with self._lock:
            self._ids.pop(command, None)
