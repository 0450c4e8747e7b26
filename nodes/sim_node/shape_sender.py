"""Sends the shapes of a world's bodies to the knowledge base, and again to each process that follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future

import msgspec

from semmap.ontology.model_shapes import ModelShape, WorldShapes
from semmap.schemas import errors, keys
from semmap.schemas.bridge import ShapeBodies
from semmap.schemas.health import Health
from semmap.schemas.replies import Done


class ShapeSender:
    """Sends shapes when it is created, and when another process of the knowledge base is ready.

    That may have another map, if it runs on another host. Repeated shapes change nothing.
    """

    def __init__(
        self,
        shapes: Mapping[str, ModelShape],
        send: Callable[[ShapeBodies], Future[Done]],
        report: Callable[[str], None],
    ) -> None:
        """Send `shapes`, which are by body. `report` takes the error texts."""
        self._message = ShapeBodies(content=msgspec.json.encode(WorldShapes.of(shapes)))
        self._send_message, self._report = send, report
        self._process: tuple[str, int] | None = None
        """The host and start of the process that was last ready."""
        self._send()

    def on_health(self, health: Health) -> None:
        """Take a heartbeat of any node."""
        if health.node != keys.SERVED_BY[keys.BRIDGE] or health.state != "ready":
            return
        before, self._process = self._process, (health.host, health.started_ns)
        if before not in (None, self._process):
            self._send()

    def _send(self) -> None:
        self._send_message(self._message).add_done_callback(self._on_sent)

    def _on_sent(self, sent: Future[Done]) -> None:
        if isinstance(error := sent.exception(), errors.SemmapError):
            self._report(f"relations do not use the shapes of the world's bodies: {error.text}")
