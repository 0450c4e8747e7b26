"""A second opinion on consistency, by owlrl: slow, independent of our own reasoner, in its own process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable

from schemas import errors
from schemas.explanations import Triple

TIMEOUT_S = 600.0
_CHILD = "nodes.kb_node.owlrl.closure_process"


def owlrl_faults(triples: Iterable[Triple]) -> list[str]:
    """What owlrl finds wrong; empty when it finds the triples consistent. Takes minutes for a large map.

    Raises Refused when it does not come to an end.
    """
    document = "".join(f"{s} {p} {o} .\n" for s, p, o in triples)
    try:
        run = subprocess.run(
            [sys.executable, "-P", "-m", _CHILD],
            input=document,
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
        )
    except subprocess.TimeoutExpired:
        raise errors.Refused(
            f"owlrl did not finish within {TIMEOUT_S:g} s; the map is too large for it"
        ) from None
    if run.returncode != 0:
        raise errors.Refused(f"owlrl failed: {(run.stderr.strip() or str(run.returncode)).splitlines()[-1]}")
    return [line for line in run.stdout.splitlines() if line]
