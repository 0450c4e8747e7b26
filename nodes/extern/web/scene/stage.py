"""The scene as viser shows it: one for the process, and a part for each tab."""

from __future__ import annotations

from nodes.extern.web.live import Live
from nodes.extern.web.page import Page
from nodes.extern.web.scene.viser_server import SceneServer


class Stage:
    """Draws the scene of the process; `show` draws what is a tab's own."""

    def __init__(self, live: Live, server: SceneServer) -> None:
        self._live = live
        self._viser = server.viser
        self._viser.gui.configure_theme(
            control_layout="collapsible", show_logo=False, show_share_button=False
        )

    def show(self, page: Page) -> None:
        """A tab has been opened."""
