"""Run a folder of ontologies: `python -m benchmarks.ontologies DIR [--import IRI=FILE]... [--json FILE]`.

A row for each ontology below DIR, with what it imports as far as that is found: how many triples, whether
changes are incremental (compiled), how long it takes until it is ready for them, the median of an add with
its check, the memory of the process, and what is amiss. Beside it how long owlrl and `reasonable` (where it
is installed) take for the closure of the same triples. Each figure comes from a process of its own, which
is ended after `--patience` seconds: owlrl takes minutes for a large ontology, and hours for some. Seconds are
of the processor's time, which is the same on a busy machine.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import psutil

from semmap.nodes.kb_node.documents import catalogue, ontology_files
from semmap.nodes.kb_node.documents.tbox import tbox_check
from semmap.schemas import errors

OTHERS = ("owlrl", "reasonable")
_PATIENCE_S = 60.0
_LOOK_S = 0.1
"""The polling interval for the CPU time of a process."""
_COLUMNS = ("file", "triples", "compiled", "load_s", "add_p50_ms", "memory_mb", "warnings")


def ontologies(folder: Path) -> list[Path]:
    """Return the ontologies in a folder and its subfolders."""
    found = (path for suffix in ontology_files.SUFFIXES for path in folder.rglob(f"*{suffix}"))
    return sorted({path for path in found if path.is_file() and path.name != catalogue.FILENAME})


def row(file: Path, imports: Mapping[str, Path]) -> dict[str, Any]:
    """Measure semmap with an ontology in this process."""
    try:
        report = tbox_check.check([file], imports)
    except errors.BadFile as error:
        return {"warnings": [error.text]}
    warnings = [f"{iri} is missing" for iri in report.missing]
    warnings += [f"inconsistent: {report.inconsistent}"] if report.inconsistent else []
    warnings += [f"nothing can be a {wrong.iri}: {wrong.why}" for wrong in report.unsatisfiable]
    if inert := sum(report.outside_rl.values()):
        warnings.append(f"{inert} axioms outside OWL 2 RL")
    quick = report.quickness
    if quick is not None and quick.not_incremental:
        warnings.append(f"not incremental: {quick.not_incremental}")
    return {
        "triples": report.triples,
        "compiled": quick is not None and not quick.not_incremental,
        "load_s": quick and round(quick.load_s, 3),
        "add_p50_ms": quick and quick.add_p50_ms and round(quick.add_p50_ms, 4),
        "memory_mb": round(psutil.Process().memory_info().rss / 1e6),
        "warnings": warnings,
    }


def closure_s(engine: str, file: Path, imports: Mapping[str, Path]) -> dict[str, Any]:
    """Measure another engine's closure of an ontology in this process."""
    from rdflib import Graph

    from semmap.nodes.kb_node.documents import rdf
    from semmap.nodes.kb_node.owlrl.closure_process import QuickGraph, close

    triples = ontology_files.gather([file], imports).triples
    graph = (QuickGraph if engine == "owlrl" else Graph)()
    graph.parse(data=rdf.serialise(triples, "ntriples"), format="nt")
    if engine == "owlrl":
        began_s = time.process_time()
        close(graph)
    else:
        import reasonable

        reasoner = reasonable.PyReasoner()
        reasoner.from_graph(graph)
        began_s = time.process_time()
        reasoner.reason()
    return {f"{engine}_s": round(time.process_time() - began_s, 3)}


def measured(file: Path, engine: str, imports: Sequence[str], patience_s: float) -> dict[str, Any]:
    """Measure one engine in a separate process; return its figures, or that it timed out or failed."""
    command = [sys.executable, "-m", "benchmarks.ontologies", str(file), "--one", engine]
    command += [word for said in imports for word in ("--import", said)]
    nothing: dict[str, Any] = {"warnings": []} if engine == "semmap" else {f"{engine}_s": None}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        said = _within(process, patience_s)
        if said is None:
            return nothing | {f"{engine}_says": f"more than {patience_s:g} s"}
    out, wrong = said
    if process.returncode:
        last = (wrong.strip().splitlines() or [f"exit status {process.returncode}"])[-1]
        return nothing | {f"{engine}_says": f"failed: {last}"}
    return dict(json.loads(out))


def _within(process: subprocess.Popen[str], patience_s: float) -> tuple[str, str] | None:
    """Return the output of a process, or None if it exceeds the CPU time and is killed."""
    while True:
        try:
            return process.communicate(timeout=_LOOK_S)
        except subprocess.TimeoutExpired:
            took = psutil.Process(process.pid).cpu_times()
            if took.user + took.system > patience_s:
                process.kill()
                return None


def rows(folder: Path, imports: Sequence[str], patience_s: float) -> Iterator[dict[str, Any]]:
    """Yield a row for each ontology."""
    installed = [engine for engine in OTHERS if importlib.util.find_spec(engine)]
    for file in ontologies(folder):
        found: dict[str, Any] = {"file": str(file.relative_to(folder))}
        for engine in ("semmap", *installed):
            found |= measured(file, engine, imports, patience_s)
        yield found


def line(found: Mapping[str, Any]) -> str:
    """Return a row in Markdown."""
    cells = [_cell(found, name) for name in _COLUMNS[:-1]]
    cells += [_cell(found, f"{engine}_s", found.get(f"{engine}_says", "")) for engine in OTHERS]
    amiss = [*found["warnings"], *filter(None, [found.get("semmap_says")])]
    return "| " + " | ".join((*cells, "; ".join(amiss))) + " |"


def _cell(found: Mapping[str, Any], name: str, instead: str = "") -> str:
    value = found.get(name)
    return instead if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)


def main(folder: Path, imports: Sequence[str], patience_s: float, json_file: Path | None) -> None:
    """Print the rows, and write them as JSON."""
    heads = (*_COLUMNS[:-1], *(f"{engine}_s" for engine in OTHERS), _COLUMNS[-1])
    print("| " + " | ".join(heads) + " |\n|" + " --- |" * len(heads), flush=True)
    found = []
    for one in rows(folder, imports, patience_s):
        found.append(one)
        print(line(one), flush=True)
    if json_file is not None:
        json_file.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--import", dest="imports", action="append", default=[], metavar="IRI=FILE")
    parser.add_argument("--patience", type=float, default=_PATIENCE_S, metavar="S")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--one", choices=("semmap", *OTHERS), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one is None:
        main(arguments.folder, arguments.imports, arguments.patience, arguments.json)
    else:
        given = {iri: Path(file) for iri, _, file in (said.rpartition("=") for said in arguments.imports)}
        own = arguments.one == "semmap"
        print(
            json.dumps(
                row(arguments.folder, given) if own else closure_s(arguments.one, arguments.folder, given)
            )
        )
