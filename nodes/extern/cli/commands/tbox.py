"""The commands about TBoxes that need no running system: `tbox check`."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from pathlib import Path

import click

from semmap.nodes.extern.cli.command import group
from semmap.nodes.extern.cli.common import print_json, print_lines
from semmap.nodes.extern.cli.ontology_options import (
    TBoxFile,
    import_option,
    require_there,
    spatial_root_option,
)
from semmap.nodes.extern.cli.output import show_tbox
from semmap.nodes.runtime import extras
from semmap.nodes.runtime.isolated_process import CPU_S, limited
from semmap.schemas import errors
from semmap.schemas.tbox_report import TBoxReport


@group(example="semmap tbox check household.ttl")
def tbox() -> None:
    """Check ontologies, without a running system."""


@tbox.command(example="semmap tbox check household.ttl")
@click.argument("files", type=TBoxFile(), nargs=-1, required=True)
@import_option
@spatial_root_option
@click.option("--format", type=click.Choice(["text", "json"]), default="text", show_default=True)
def check(
    files: tuple[Path, ...], imports: tuple[tuple[str, Path], ...], spatial_root: tuple[str, ...], format: str
) -> None:
    """Show the contents of ontologies, and their errors.

    The report includes axioms outside OWL 2 RL, which have no effect, and the expected time of a change.
    FILES (or folders, or the word household) are checked together, with their imports. The exit status is 1
    if they are inconsistent or have an unsatisfiable class, and 2 if a file cannot be read.
    """
    extras.require("semmap tbox check", "kb")
    for file in files:
        require_there(file)
    from semmap.nodes.kb_node.documents.tbox.tbox_check import check as check_files

    report = _check_limited(lambda: check_files(files, dict(imports), spatial_root))
    if format == "json":
        print_json(report)
    else:
        print_lines(show_tbox.report(report))
    if not report.is_sound:
        sys.exit(errors.Inconsistent.exit_status)


def _check_limited(check: Callable[[], TBoxReport]) -> TBoxReport:
    """Return the report of `check`. Raises BadFile if it takes too much time or memory."""

    def end(*_: object) -> None:
        raise errors.BadFile(f"checking the ontology takes longer than {CPU_S:g} s; check parts of it")

    before = signal.signal(signal.SIGXCPU, end)
    try:
        with limited():
            return check()
    except MemoryError:
        raise errors.BadFile("checking the ontology needs too much memory; check parts of it") from None
    finally:
        signal.signal(signal.SIGXCPU, before)
