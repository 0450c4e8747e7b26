"""Files: loading of uploads, after a dry run, and export by download."""

from __future__ import annotations

import asyncio
import contextlib
import time
from typing import Final

from nicegui import events, ui

from semmap.nodes.extern.cli.output.lines import format_change
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.details.proof import draw_proof
from semmap.nodes.extern.web.panels.widgets.folded_list import draw_error, draw_folded
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.views.uploads import (
    BEGINNING,
    LARGEST,
    check_upload,
    megabytes,
    size_error,
    spatial_roots,
    takes_long,
)
from semmap.schemas import errors
from semmap.schemas.commands import Export, Load, RdfFormat
from semmap.schemas.explanations import Explanation
from semmap.schemas.packing import packed

_TIMEOUT_S: Final = 1800.0
_BROWSER_S: Final = 10.0
_FORMATS: Final[dict[RdfFormat, str]] = {
    "turtle": "Turtle", "rdfxml": "RDF/XML", "ntriples": "N-Triples", "jsonld": "JSON-LD",
    "functional": "OWL functional syntax", "manchester": "OWL Manchester syntax",
}  # fmt: skip
_ENDINGS: Final[dict[RdfFormat, str]] = {
    "turtle": "ttl", "rdfxml": "rdf", "ntriples": "nt", "jsonld": "jsonld",
    "functional": "ofn", "manchester": "omn",
}  # fmt: skip


def files(page: Page) -> None:
    """Draw the forms for loading and exporting, as far as they are permitted."""
    with ui.row().classes("w-full gap-4 items-stretch"):
        if page.is_allowed("load"):
            _LoadForm(page)
        if page.is_allowed("export"):
            _draw_export(page)


class _LoadForm:
    """The form that loads a file: an upload starts a dry run, and a button loads the file."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self._tried: Load | None = None
        self._size = 0
        """Size of the uploaded file [bytes]; it is compressed for sending."""
        self._request = 0
        """Number of the current file or dry run; results of earlier ones are ignored."""
        with ui.card().classes("grow").props("flat bordered").style("min-width: 18rem; flex-basis: 24rem"):
            ui.label("Load").classes("text-subtitle1")
            ui.label(
                "A map in any RDF syntax or OWL, a scene in JSON, a HuRIC map, or an ontology; up to "
                f"{megabytes(LARGEST)}. A dry run shows the changes before the file is loaded."
            ).classes("text-caption")
            with ui.row().classes("gap-2"):
                self._replace = ui.checkbox("Replace map", on_change=self._again)
                self._skip = ui.checkbox("Skip unknown classes", on_change=self._again)
                self._tbox = ui.checkbox("Ontology (TBox)", on_change=self._again)
            self._roots = ui.input("Classes with positions").props("dense outlined clearable")
            self._roots.classes("w-full").on("keydown.enter", self._on_roots).on("blur", self._on_roots)
            self._roots.tooltip(
                "IRIs or names of the classes of physical objects, if the ontology does not state them"
            )
            self._roots.bind_visibility_from(self._tbox, "value")
            self._upload = ui.upload(
                label="Choose or drop a file",
                auto_upload=True,
                max_files=None,
                max_file_size=LARGEST,
                on_begin_upload=self._on_begin,
                on_upload=self._on_upload,
                on_rejected=self._on_rejected,
            )
            self._upload.classes("w-full").props("flat bordered").mark("upload").on("failed", self._on_failed)
            self._status = ui.column().classes("w-full gap-0").props('role="status"').mark("load-status")
            self._error = ui.column().classes("w-full gap-0").props('role="alert"').mark("load-error")
            with ui.row().classes("gap-2"):
                self._button = ui.button("Load", icon="file_upload", on_click=self._load)
                self._button.props("no-caps dense").classes("px-3").mark("load-button")
                self._stop = ui.button("Stop", icon="stop", on_click=self._cancel)
                self._stop.props("no-caps dense outline").classes("px-3").mark("load-stop")
            self._button.visible = self._stop.visible = False

    def _on_rejected(self) -> None:
        self._reset()
        self._fail(size_error("file"))

    def _on_begin(self) -> None:
        self._reset()
        self._stop.visible = True
        self._show("Uploading ...")

    async def _cancel(self) -> None:
        """Cancel an upload, or ignore the result of a dry run, which changes nothing."""
        self._reset()
        request = self._request
        await self._clear_upload()
        if request == self._request:
            self._show("Stopped; no changes.")

    async def _clear_upload(self) -> None:
        """Have the browser cancel its upload and clear the field.

        This comes before any message, because it would remove a file that the user has chosen since.
        """
        with contextlib.suppress(TimeoutError):  # the tab may be closed
            await self._upload.run_method("reset", timeout=_BROWSER_S)

    def _on_failed(self) -> None:
        if self._stop.visible:  # not stopped by the user
            self._reset()
            self._fail("upload incomplete; choose the file again")

    async def _on_upload(self, event: events.UploadEventArguments) -> None:
        self._reset()
        request = self._request
        await self._clear_upload()
        if request != self._request:
            return
        file = event.file
        beginning = b""
        async for chunk in file.iterate(chunk_size=BEGINNING):
            beginning = chunk
            break
        if error := check_upload(file.name, file.size(), beginning):
            self._fail(error)
            return
        self._stop.visible = True
        content = await asyncio.to_thread(packed, await file.read())
        if request != self._request:
            return
        self._tried, self._size = Load(content=content, filename=file.name), file.size()
        await self._dry_run()

    async def _again(self) -> None:
        """Repeat the dry run with other options."""
        if self._tried is not None:
            await self._dry_run()

    async def _on_roots(self) -> None:
        """Repeat the dry run if the classes with positions have changed."""
        if self._tried is not None and spatial_roots(self._roots.value) != self._tried.spatial_root:
            await self._dry_run()

    async def _dry_run(self) -> None:
        if self._tried is None:
            raise errors.InternalError("no file was uploaded")
        self._tried = Load(
            content=self._tried.content,
            filename=self._tried.filename,
            replace=bool(self._replace.value),
            skip_unknown=bool(self._skip.value),
            tbox=bool(self._tbox.value),
            spatial_root=spatial_roots(self._roots.value) if self._tbox.value else (),
            dry_run=True,
        )
        name, size, began_s = self._tried.filename, self._size, time.monotonic()
        self._error.clear()
        self._button.visible, self._stop.visible = False, True
        self._request += 1
        request = self._request
        self._show(
            f"Checking {name} ({megabytes(size)}) ..."
            + (" This may take several seconds." if takes_long(len(self._tried.content)) else "")
        )
        with self._status:
            elapsed = ui.label().classes("text-caption")
            ticking = ui.timer(1.0, lambda: elapsed.set_text(f"{time.monotonic() - began_s:.0f} s"))
        try:
            reply = await self._page.live.ask(self._tried, _TIMEOUT_S)
        except errors.SemmapError as error:
            if request == self._request:
                self._show()
                self._fail(error.text, error.explanation)
                self._stop.visible = False
            return
        finally:
            ticking.cancel()
        if request != self._request:
            return
        self._stop.visible = False
        self._show(f"Changes by {name}:", *format_change(reply))
        self._button.text = f"Load {name}"
        self._button.visible = True

    async def _load(self) -> None:
        if self._tried is None:
            return
        tried = self._tried
        self._button.set_enabled(False)
        try:
            wanted = Load(
                content=tried.content,
                filename=tried.filename,
                replace=tried.replace,
                skip_unknown=tried.skip_unknown,
                tbox=tried.tbox,
                spatial_root=tried.spatial_root,
                reason=f"loaded {tried.filename}"[:1000],
            )
            reply = await self._page.change(wanted, _TIMEOUT_S)
        finally:
            self._button.set_enabled(True)
        if reply is not None:
            self._reset()
            self._show(*format_change(reply))

    def _reset(self) -> None:
        self._request += 1
        self._tried = None
        self._error.clear()
        self._button.visible = self._stop.visible = False
        self._show()

    def _show(self, *lines: str) -> None:
        """Show a line, and the others as a list below."""
        self._status.clear()
        with self._status:
            for line in lines[:1]:
                ui.label(line).classes("whitespace-pre-wrap")
            draw_folded(lines[1:])

    def _fail(self, text: str, proof: Explanation | None = None) -> None:
        """Show why the file cannot be loaded, and the proof of a contradiction."""
        self._error.clear()
        with self._error:
            draw_error(text, classes="text-negative")
            if proof is not None:
                with ui.expansion("Proof").classes("w-full").props("dense"):
                    draw_proof(proof, MapView.of(self._page).knowledge.words, sentence=False)


def _draw_export(page: Page) -> None:
    with ui.card().classes("grow").props("flat bordered").style("min-width: 16rem; flex-basis: 18rem"):
        ui.label("Export").classes("text-subtitle1")
        subject = ui.label().classes("text-caption")
        syntax = ui.select(dict(_FORMATS), value="turtle", label="Format").props("dense outlined")
        syntax.classes("w-full").mark("export-format")
        inferred = ui.checkbox("Include inferred").tooltip("Include inferred and computed facts")
        error = ui.label().classes("text-negative whitespace-pre-wrap").props('role="alert"')

        async def export() -> None:
            error.text = ""
            as_of = None if page.moment.is_now else page.state.commit
            try:
                command = Export(format=syntax.value, inferred=bool(inferred.value), as_of=as_of)
                document = await page.live.ask(command, _TIMEOUT_S)
            except errors.SemmapError as refused:
                error.text = refused.text
                return
            name = f"map-{document.seq}.{_ENDINGS[command.format]}"
            ui.download.content(document.content, name, document.media_type)
            page.notify(f"{name}: {document.triples:,} triples", "positive")

        ui.button("Export", icon="file_download", on_click=export).props("no-caps dense").classes(
            "px-3"
        ).mark("export-button")

        def show() -> None:
            commit = page.state.commit
            subject.text = "Current map" if page.moment.is_now else f"Map after commit {commit}"

        page.on_change(show)
        show()
