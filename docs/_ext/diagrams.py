"""Mermaid diagrams as committed SVG files, so that the manual builds and reads without a network.

A ```` ```mermaid ```` block stays text, which GitHub draws by itself. `make diagrams` draws what has changed
into docs/diagrams/<digest>.svg by Mermaid's command line, with node and Chromium; the build fails where one
is missing.
"""

from __future__ import annotations

import hashlib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive

DOCS = Path(__file__).parents[1]
DRAWN = DOCS / "diagrams"
BLOCK = re.compile(r"^```mermaid\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = [DOCS.parent / "ARCHITECTURE.md", DOCS.parent / "README.md", *DOCS.rglob("*.md")]


def drawn(text: str) -> Path:
    """The SVG file of a diagram."""
    return DRAWN / f"{hashlib.blake2b(text.strip().encode(), digest_size=8).hexdigest()}.svg"


class Mermaid(Directive):
    """Puts the drawn SVG where the text of a diagram stands."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The SVG as it is. Warns, and so fails the build, where `make diagrams` was forgotten."""
        path = drawn("\n".join(self.content))
        if not path.exists():
            return [self.state.document.reporter.warning(f"{path.name} is missing: make diagrams")]
        return [
            nodes.raw(
                "", f'<div style="background: white; padding: 0.5em">{path.read_text()}</div>', format="html"
            )
        ]


def setup(app: object) -> dict[str, bool]:
    """Sphinx's entry point."""
    app.add_directive("mermaid", Mermaid)  # type: ignore[attr-defined]
    return {"parallel_read_safe": True}


def draw() -> None:
    """Draw what is missing, and remove what no page uses any more."""
    texts = [text for page in PAGES for text in BLOCK.findall(page.read_text())]
    wanted = {drawn(text): text for text in texts}
    for path in set(DRAWN.glob("*.svg")) - wanted.keys():
        path.unlink()
    for path, text in wanted.items():
        if path.exists():
            continue
        with tempfile.TemporaryDirectory() as folder:
            source, browser = Path(folder, "diagram.mmd"), Path(folder, "browser.json")
            source.write_text(text)
            browser.write_text('{"executablePath": "/usr/bin/chromium", "args": ["--no-sandbox"]}')
            command = ["npx", "--yes", "@mermaid-js/mermaid-cli", "-p", browser, "-i", source, "-o", path]
            command += ["-b", "transparent", "-t", "neutral", "-I", f"d{path.stem}"]
            subprocess.run(command, check=True, env={**os.environ, "PUPPETEER_SKIP_DOWNLOAD": "1"})
        print(f"{path.name}: {text.strip().splitlines()[0]}", file=sys.stderr)


if __name__ == "__main__":
    draw()
