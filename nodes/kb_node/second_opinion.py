"""A second opinion on consistency, by owlrl: slow, independent of our own reasoner, in its own process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable

from schemas import errors
from schemas.explanations import Triple

TIMEOUT_S = 600.0


def owlrl_faults(triples: Iterable[Triple]) -> list[str]:
    """What owlrl finds wrong; empty when it finds the triples consistent. Takes minutes for a large map.

    Raises Refused when it does not come to an end.
    """
    document = "".join(f"{s} {p} {o} .\n" for s, p, o in triples)
    document = document.replace('"-0.0"', '"0.0"')  # owlrl takes the two for a clash
    try:
        run = subprocess.run(
            [sys.executable, "-m", __name__],
            input=document,
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
        )
    except subprocess.TimeoutExpired:
        raise errors.Refused(
            f"owlrl came to no end within {TIMEOUT_S:g} s; the map is too large for it"
        ) from None
    if run.returncode != 0:
        raise errors.Refused(f"owlrl failed: {(run.stderr.strip() or str(run.returncode)).splitlines()[-1]}")
    return [line for line in run.stdout.splitlines() if line]


def main() -> None:
    """Read N-Triples from stdin, print one fault a line."""
    import owlrl
    import rdflib

    graph = rdflib.Graph()
    graph.parse(data=sys.stdin.read(), format="nt")
    owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph)
    described = rdflib.URIRef("http://www.daml.org/2002/03/agents/agent-ont#error")
    faults = {str(o).replace("\n", " ") for o in graph.objects(None, described)}
    print("\n".join(sorted(faults)))


if __name__ == "__main__":
    main()
