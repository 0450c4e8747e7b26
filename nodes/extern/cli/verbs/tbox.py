"""The verbs about TBoxes that need no running system: `tbox check`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from semmap.nodes.extern.cli.calling import print_json, print_lines
from semmap.nodes.extern.cli.ontology_options import (
    TBoxFile,
    import_option,
    require_there,
    spatial_root_option,
)
from semmap.nodes.extern.cli.output import show_tbox
from semmap.nodes.runtime import extras
from semmap.schemas import errors


@click.group()
def tbox() -> None:
    """Look at ontologies, without a running system."""


@tbox.command()
@click.argument("files", type=TBoxFile(), nargs=-1, required=True)
@import_option
@spatial_root_option
@click.option("--format", type=click.Choice(["text", "json"]), default="text", show_default=True)
def check(
    files: tuple[Path, ...], imports: tuple[tuple[str, Path], ...], spatial_root: tuple[str, ...], format: str
) -> None:
    """Show what is in ontologies, and what of it is wrong.

    That includes what of them is inert, and how quick changes will be. FILES (or folders, or the word
    household) are checked together, with what they import. Exit status 1 says that they contradict
    themselves, or that nothing can be of some class; 2 that a file cannot be read.
    """
    extras.require("semmap tbox check", "kb")
    for file in files:
        require_there(file)
    from semmap.nodes.kb_node.documents.tbox.tbox_check import check as check_files

    report = check_files(files, dict(imports), spatial_root)
    if format == "json":
        print_json(report)
    else:
        print_lines(show_tbox.report(report))
    if not report.is_sound:
        sys.exit(errors.Inconsistent.exit_status)
