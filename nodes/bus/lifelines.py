"""What was asked of a node ends when the node is gone.

Zenoh (1.10.2) ends the questions that a peer has when it goes. One that was sent within the few milliseconds
until that is noticed nobody has, and it waits for its time-out.
"""

from __future__ import annotations

import zenoh

from schemas import keys


class Lifelines:
    """Of the nodes that serve, as one session sees them: what hangs on one is cancelled when that is cut.

    It costs a question nothing. Any thread may use it.
    """

    def __init__(self, session: zenoh.Session) -> None:
        self._tokens: dict[str, zenoh.CancellationToken] = {}
        session.liveliness().declare_subscriber(keys.live_key("*"), self._on_change)

    def of(self, node: str) -> zenoh.CancellationToken:
        """For the questions to this node from now on."""
        return self._tokens.get(node) or self._tokens.setdefault(node, zenoh.CancellationToken())

    def _on_change(self, sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.DELETE:
            token = self._tokens.pop(keys.live_node(str(sample.key_expr)), None)
            if token is not None:
                token.cancel()  # type: ignore[no-untyped-call]
