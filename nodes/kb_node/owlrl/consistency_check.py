"""An independent consistency check with owlrl. It is slow and runs in a separate process."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterable

from semmap.schemas import errors
from semmap.schemas.explanations import Triple

TIMEOUT_S = 600.0
_POLL_S = 0.5
_CHILD = "semmap.nodes.kb_node.owlrl.closure_process"


def find_owlrl_faults(triples: Iterable[Triple], *, is_over: Callable[[], bool] = lambda: False) -> list[str]:
    """Return the inconsistencies that owlrl finds; empty if there are none. Takes minutes for a large map.

    Aborts when `is_over()`, which is polled twice a second. Raises Refused if owlrl is aborted, fails, or
    does not finish within `TIMEOUT_S`.
    """
    document: str | None = "".join(f"{s} {p} {o} .\n" for s, p, o in triples)
    deadline_s = time.monotonic() + TIMEOUT_S
    with subprocess.Popen(
        [sys.executable, "-P", "-m", _CHILD],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as child:
        while True:
            try:
                found, stderr = child.communicate(document, timeout=_POLL_S)
                break
            except subprocess.TimeoutExpired:
                document = None  # the input was already passed
                if is_over():
                    child.kill()
                    raise errors.Refused("owlrl check aborted: the knowledge base is stopping") from None
                if time.monotonic() > deadline_s:
                    child.kill()
                    raise errors.Refused(
                        f"owlrl check: timeout after {TIMEOUT_S:g} s (large map); use --engine semmap"
                    ) from None
    if child.returncode != 0:
        reason = (stderr.strip() or f"exit status {child.returncode}").splitlines()[-1]
        raise errors.Refused(f"owlrl check failed: {reason}")
    return [line for line in found.splitlines() if line]
