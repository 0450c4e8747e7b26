"""The worker thread that fits models, one thing at a time."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from semmap.nodes.perception_node.fitting.fit import Fit
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from semmap.schemas.perception import Observation

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Request:
    """An entity to be fitted: `seen` is the `number`-th observation (from 1) of a frame of `clouds`.

    `box` is the pose of its track at that time.
    """

    name: str
    box: Pose
    seen: Observation
    number: int
    clouds: Sequence[Cloud]
    found: FrameResult


FitTo = Callable[[Request], Fit | None]


class FitWorker:
    """Fits requested things on its own thread. A request is ignored while it is busy."""

    def __init__(
        self, fit: FitTo, on_fit: Callable[[Request, Fit | None], None], complain: Callable[[str], None]
    ) -> None:
        """Start the thread. `on_fit(request, fit)` and `complain(text)` are called on it."""
        self._fit = fit
        self._on_fit = on_fit
        self._complain = complain
        self._request: Request | None = None
        self._stopping = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="fits", daemon=True)
        self._thread.start()

    @property
    def busy(self) -> bool:
        """Return whether a fit is requested or in progress."""
        with self._changed:
            return self._request is not None

    def ask(self, request: Request) -> None:
        """Request a fit; ignored while the worker is busy."""
        with self._changed:
            if self._request is None:
                self._request = request
                self._changed.notify()

    def close(self) -> None:
        """Finish the current fit and stop."""
        with self._changed:
            self._stopping = True
            self._changed.notify()
        self._thread.join()

    def _run(self) -> None:
        while True:
            with self._changed:
                while self._request is None and not self._stopping:
                    self._changed.wait()
                if self._stopping:
                    return
                request = self._request
            if request is None:
                raise errors.InternalError("there is nothing to fit")
            found = None
            try:
                found = self._fit(request)
            except Exception as error:
                log.exception("fitting a model failed")
                self._complain(f"fitting a model failed: {type(error).__name__}: {error}")
            self._on_fit(request, found)
            with self._changed:
                self._request = None
