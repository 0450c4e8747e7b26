"""The report of `semmap tbox check` as text."""

from __future__ import annotations

from collections.abc import Iterator

from semmap.schemas.tbox_report import TBoxReport

_COLUMN = 15
_FEW = 20


def report(found: TBoxReport) -> Iterator[str]:
    """Yield the lines of a report."""
    for iri, version in found.ontologies.items():
        yield _line("ontology", iri + (f" ({version})" if version else ""))
    yield _line("contents", _contents(found))
    if found.spatial_classes == 0:
        root = (
            f"add --spatial-root CLASS, such as {found.spatial_candidate}" if found.spatial_candidate else ""
        )
        household = "extend the household TBox: semmap up --tbox household --tbox FILE"
        yield _line("spatial", f"nothing can be placed; {', or '.join(filter(None, (root, household)))}")
    for iri, file in found.imports.items():
        yield _line("imports", f"{iri} from {file}")
    for iri in found.missing:
        yield _line("missing", f"{iri} (add --import {iri}=FILE)")
    for kind, count in found.outside_rl.items():
        # one direction of these has its effect
        in_part = "in part, " if kind.endswith("in an equivalence") or kind == "disjoint union" else ""
        yield _line("ignored", f"{count} x {kind} ({in_part}outside OWL 2 RL)")
    for kind, count in found.inert.items():
        yield _line("ignored", f"{count} x {kind} (stored, but not evaluated)")
    for note in found.left_out:
        yield _line("graphs", note)
    for iri in found.undeclared[:_FEW]:
        yield _line("not declared", f"{iri} (used by a SWRL rule)")
    if (more := len(found.undeclared) - _FEW) > 0:
        yield _line("not declared", f"and {more} more terms of SWRL rules")
    yield from _names(found)
    yield from _verdict(found)
    if (quick := found.quickness) is not None:
        yield _line("load time", f"{quick.load_s:.2f} s")
        if quick.add_p50_ms is not None:
            yield _line("change time", f"{quick.add_p50_ms:.3f} ms (median)")
        if quick.not_incremental:
            yield _line("not incremental", quick.not_incremental)


def _contents(found: TBoxReport) -> str:
    spatial = "" if found.spatial_classes is None else f" ({found.spatial_classes} spatial)"
    counts = {
        f"object {_properties(found.object_properties)}": found.object_properties,
        f"data {_properties(found.data_properties)}": found.data_properties,
        f"annotation {_properties(found.annotation_properties)}": found.annotation_properties,
        "individual" if found.individuals == 1 else "individuals": found.individuals,
    }
    several = "".join(f", {count} {what}" for what, count in counts.items())
    files = "1 file" if len(found.files) == 1 else f"{len(found.files)} files"
    classes = "1 class" if found.classes == 1 else f"{found.classes} classes"
    return f"{classes}{spatial}{several}; {found.triples} triples in {files}"


def _properties(count: int) -> str:
    return "property" if count == 1 else "properties"


def _names(found: TBoxReport) -> Iterator[str]:
    for name, iris in list(found.ambiguous.items())[:_FEW]:
        yield _line("ambiguous", f"{name}: {' or '.join(iris)}")
    if (more := len(found.ambiguous) - _FEW) > 0:
        yield _line("ambiguous", f"and {more} more names")


def _verdict(found: TBoxReport) -> Iterator[str]:
    if found.inconsistent:
        yield _line("inconsistent", found.inconsistent)
        return
    for class_ in found.unsatisfiable:
        yield _line("unsatisfiable", f"{class_.iri}: {class_.why}")
    if found.untried:
        yield _line("not checked", f"{found.untried} classes, because the check would take too long")
    if found.is_sound and not found.untried:
        yield _line("consistent", "yes, and every class is satisfiable")


def _line(what: str, text: str) -> str:
    return f"{what:<{_COLUMN}} {text}"
