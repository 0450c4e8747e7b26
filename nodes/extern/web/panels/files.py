"""Files: load by upload, tried first and done then; and export by download."""

from __future__ import annotations

import asyncio
import contextlib
import time
from typing import Final

from nicegui import events, ui

from semmap.nodes.extern.cli.output.lines import format_change
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.uploads import (
    BEGINNING,
    LARGEST,
    megabytes,
    refusal,
    spatial_roots,
    takes_long,
    too_large,
)
from semmap.schemas import errors
from semmap.schemas.commands import Export, Load, RdfFormat
from semmap.schemas.packing import packed

_TIMEOUT_S: Final = 1800.0
_BROWSER_S: Final = 10.0
_FORMATS: Final[dict[RdfFormat, str]] = {
    "turtle": "Turtle", "rdfxml": "RDF/XML", "ntriples": "N-Triples", "jsonld": "JSON-LD",
}  # fmt: skip
_ENDINGS: Final[dict[RdfFormat, str]] = {
    "turtle": "ttl", "rdfxml": "rdf", "ntriples": "nt", "jsonld": "jsonld"
}  # fmt: skip


def files(page: Page) -> None:
    """Loading, where that is permitted, and exporting."""
    with ui.row().classes("w-full gap-4 items-stretch"):
        if page.may("load"):
            _Loading(page)
        if page.may("export"):
            _exporting(page)


class _Loading:
    """A file is tried as soon as it is chosen: what it would do is said, and done when somebody says so."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self._tried: Load | None = None
        self._size = 0
        """Bytes of the file as it was uploaded; on the wire it is packed."""
        self._turn = 0
        """Which file, and which try of it, is waited for; what comes of an earlier one is left."""
        with ui.card().classes("grow").props("flat bordered").style("min-width: 18rem; flex-basis: 24rem"):
            ui.label("Load").classes("text-subtitle1")
            ui.label(
                "A map in any RDF syntax or OWL, a scene in JSON, a HuRIC map, or an ontology; up to "
                f"{megabytes(LARGEST)}. It is tried first, and nothing changes until you say so."
            ).classes("text-caption")
            with ui.row().classes("gap-2"):
                self._replace = ui.checkbox("In place of what is there", on_change=self._again)
                self._skip = ui.checkbox("Leave out unknown classes", on_change=self._again)
                self._tbox = ui.checkbox("It is the ontology (TBox)", on_change=self._again)
            self._roots = ui.input("Classes of things in space").props("dense outlined clearable")
            self._roots.classes("w-full").on("keydown.enter", self._rooted).on("blur", self._rooted)
            self._roots.tooltip("By IRI or name, where the ontology does not tell by itself")
            self._roots.bind_visibility_from(self._tbox, "value")
            self._upload = ui.upload(
                label="Choose a file, or drop it here",
                auto_upload=True,
                max_files=None,
                max_file_size=LARGEST,
                on_begin_upload=self._begun,
                on_upload=self._uploaded,
                on_rejected=self._rejected,
            )
            self._upload.classes("w-full").props("flat bordered").mark("upload").on("failed", self._failed)
            self._said = ui.column().classes("w-full gap-0").props('role="status"').mark("load-said")
            self._error = ui.label().classes("text-negative whitespace-pre-wrap").props('role="alert"')
            self._error.mark("load-error")
            with ui.row().classes("gap-2"):
                self._button = ui.button("Load", icon="file_upload", on_click=self._load)
                self._button.props("no-caps dense").classes("px-3").mark("load-button")
                self._stop = ui.button("Stop", icon="stop", on_click=self._stopped)
                self._stop.props("no-caps dense outline").classes("px-3").mark("load-stop")
            self._button.visible = self._stop.visible = False

    def _rejected(self) -> None:
        self._forget()
        self._error.text = too_large("the file", LARGEST + 1).replace(
            f" has {megabytes(LARGEST + 1)}", " is larger"
        )

    def _begun(self) -> None:
        self._forget()
        self._stop.visible = True
        self._say("Sending the file ...")

    async def _stopped(self) -> None:
        """What is being sent or tried is left; a try that is under way in the system changes nothing."""
        self._forget()
        turn = self._turn
        await self._empty()
        if turn == self._turn:
            self._say("Stopped: nothing was loaded.")

    async def _empty(self) -> None:
        """Have the browser send nothing, and forget what it sent, before anybody is told to choose again.

        Told first, somebody quick had the next file taken away by this.
        """
        with contextlib.suppress(TimeoutError):  # the tab may be gone
            await self._upload.run_method("reset", timeout=_BROWSER_S)

    def _failed(self) -> None:
        if self._stop.visible:  # nobody stopped it
            self._forget()
            self._error.text = "The file was not sent whole; choose it again."

    async def _uploaded(self, event: events.UploadEventArguments) -> None:
        self._forget()
        turn = self._turn
        await self._empty()
        if turn != self._turn:
            return
        file = event.file
        beginning = b""
        async for chunk in file.iterate(chunk_size=BEGINNING):
            beginning = chunk
            break
        if sentence := refusal(file.name, file.size(), beginning):
            self._error.text = sentence
            return
        self._stop.visible = True
        content = await asyncio.to_thread(packed, await file.read())
        if turn != self._turn:
            return
        self._tried, self._size = Load(content=content, filename=file.name), file.size()
        await self._try()

    async def _again(self) -> None:
        """Another way to load the same file."""
        if self._tried is not None:
            await self._try()

    async def _rooted(self) -> None:
        """Other classes are said to be of things in space."""
        if self._tried is not None and spatial_roots(self._roots.value) != self._tried.spatial_root:
            await self._try()

    async def _try(self) -> None:
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
        self._error.text, self._button.visible, self._stop.visible = "", False, True
        self._turn += 1
        turn = self._turn
        self._say(
            f"Trying {name} ({megabytes(size)}) ..."
            + (" this may take a while" if takes_long(len(self._tried.content)) else "")
        )
        with self._said:
            elapsed = ui.label().classes("text-caption")
            ticking = ui.timer(1.0, lambda: elapsed.set_text(f"{time.monotonic() - began_s:.0f} s so far"))
        try:
            reply = await self._page.live.ask(self._tried, _TIMEOUT_S)
        except errors.SemmapError as error:
            if turn == self._turn:
                self._say()
                self._error.text, self._stop.visible = error.text, False
            return
        finally:
            ticking.cancel()
        if turn != self._turn:
            return
        self._stop.visible = False
        self._say(f"If {name} is loaded:", *format_change(reply))
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
            self._forget()
            self._say(*format_change(reply))

    def _forget(self) -> None:
        self._turn += 1
        self._tried, self._error.text = None, ""
        self._button.visible = self._stop.visible = False
        self._say()

    def _say(self, *lines: str) -> None:
        self._said.clear()
        with self._said:
            for line in lines:
                ui.label(line).classes("whitespace-pre-wrap")


def _exporting(page: Page) -> None:
    with ui.card().classes("grow").props("flat bordered").style("min-width: 16rem; flex-basis: 18rem"):
        ui.label("Export").classes("text-subtitle1")
        of = ui.label().classes("text-caption")
        syntax = ui.select(dict(_FORMATS), value="turtle", label="Format").props("dense outlined")
        syntax.classes("w-full").mark("export-format")
        inferred = ui.checkbox("With what follows").tooltip("Also what is inferred and measured")
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
            page.tell(f"{name}: {document.triples:,} triples", "positive")

        ui.button("Export", icon="file_download", on_click=export).props("no-caps dense").classes(
            "px-3"
        ).mark("export-button")

        def show() -> None:
            moment = "as it is now" if page.moment.is_now else f"as it was after commit {page.state.commit}"
            of.text = f"The map {moment}"

        page.on_change(show)
        show()
