"""A second opinion on consistency, by owlrl: slow, independent of our own reasoner, in its own process."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterable

from semmap.schemas import errors
from semmap.schemas.explanations import Triple

TIMEOUT_S = 600.0
_LOOK_S = 0.5
_CHILD = "semmap.nodes.kb_node.owlrl.closure_process"


def find_owlrl_faults(triples: Iterable[Triple], *, is_over: Callable[[], bool] = lambda: False) -> list[str]:
    """What owlrl finds wrong; empty when it finds the triples consistent. Takes minutes for a large map.

    It is given up as soon as `is_over()`, which is asked twice a second. Raises Refused when it does not come
    to an end.
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
                found, complaint = child.communicate(document, timeout=_LOOK_S)
                break
            except subprocess.TimeoutExpired:
                document = None  # it is being fed already
                if is_over():
                    child.kill()
                    raise errors.Refused("owlrl was given up: the knowledge base is stopping") from None
                if time.monotonic() > deadline_s:
                    child.kill()
                    raise errors.Refused(
                        f"owlrl did not finish within {TIMEOUT_S:g} s; the map is too large for it"
                    ) from None
    if child.returncode != 0:
        raise errors.Refused(f"owlrl failed: {(complaint.strip() or str(child.returncode)).splitlines()[-1]}")
    return [line for line in found.splitlines() if line]
