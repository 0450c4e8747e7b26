"""Opens a recording in the Rerun viewer."""

from __future__ import annotations

import os
import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path

from semmap.nodes.recorder.intact_part import open_intact_part
from semmap.schemas import errors


def replay(path: Path, tell: Callable[[str], None] = lambda text: None) -> None:
    """Open a recording in a separate viewer on loopback, and wait until it is closed.

    If the file is truncated or damaged, its intact part is shown, and `tell` receives a note on the rest.
    Raises BadFile if `path` is not a readable recording, and Refused if the viewer cannot be opened.
    """
    with open_intact_part(path) as whole:
        if text := whole.describe(path):
            tell(text)
        viewer = Path(sysconfig.get_path("scripts"), "rerun")
        command = [str(viewer), "--bind", "127.0.0.1", "--port", "auto", str(whole.path)]
        status = subprocess.run(command, env=viewer_environment()).returncode
    if status not in (0, 130):
        raise errors.Refused(
            f"the viewer exited with status {status}; it needs a display and a graphics driver; "
            f"to use a browser: rerun --web-viewer --bind 127.0.0.1 {path}"
        )


def viewer_environment() -> dict[str, str]:
    """Return the environment for a viewer. In a CI job it sends no usage data."""
    return {**os.environ, "CI": "1"}
