"""Opens a recording in the Rerun viewer."""

from __future__ import annotations

import os
import subprocess
import sysconfig
from pathlib import Path

from nodes.recorder.recorded_commits import require_recording
from schemas import errors


def replay(path: Path) -> None:
    """Open a recording in a viewer of its own, on loopback, and wait until it is closed.

    Raises BadFile when `path` is no recording, and Refused when the viewer cannot be opened.
    """
    require_recording(path)
    viewer = Path(sysconfig.get_path("scripts"), "rerun")
    command = [str(viewer), "--bind", "127.0.0.1", "--port", "auto", str(path)]
    status = subprocess.run(command, env=viewer_environment()).returncode
    if status not in (0, 130):
        raise errors.Refused(
            f"the viewer exited with status {status}; it needs a display and a graphics driver "
            f"(in a browser instead: rerun --web-viewer --bind 127.0.0.1 {path})"
        )


def viewer_environment() -> dict[str, str]:
    """The environment for a viewer: it sends no usage data where it believes to be in a CI job."""
    return {**os.environ, "CI": "1"}
