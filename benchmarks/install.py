"""Installation and import costs: `python -m benchmarks.install [--parts base,kb] [--json FILE]`.

Builds the wheel and installs it, alone and with each extra, into empty environments. Packages that are not
cached are downloaded from the package registry.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

from benchmarks.table import Row, lines

ROOT = Path(__file__).parents[1]
PARTS = ("base", "kb", "sim", "perception", "record", "all")
_NOT_OURS = ("pip", "setuptools", "pkg_resources", "_distutils_hack")
_IMPORT = "import time; t = time.perf_counter(); import semmap; print(time.perf_counter() - t)"
_IMPORTS = 7


def built_wheel(folder: Path) -> Path:
    """Build the wheel of this checkout in `folder`."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = folder.glob("semmap-*.whl")
    return wheel


def environment(folder: Path, *requirements: str) -> Path:
    """Create an environment in `folder` with these requirements; return its Python."""
    python = folder / "bin" / "python"
    uv = shutil.which("uv") or shutil.which(str(ROOT / ".tools" / "bin" / "uv"))
    if uv is not None:
        subprocess.run([uv, "venv", "-q", "--python", sys.executable, folder], check=True)
        install = [uv, "pip", "install", "-q", "--compile-bytecode", "--python", python]
    else:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        install = [python, "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    subprocess.run([*map(str, install), *requirements], check=True)
    return python


def megabytes(python: Path) -> float:
    """Return the size of the installed and compiled packages, without the installer [MB]."""
    (packages,) = python.parents[1].glob("lib/python*/site-packages")
    ours = (entry for entry in packages.iterdir() if entry.name.split("-")[0] not in _NOT_OURS)
    return sum(_size(entry) for entry in ours) / 1e6


def _size(entry: Path) -> int:
    files: Iterable[Path] = entry.rglob("*") if entry.is_dir() else (entry,)
    return sum(file.stat().st_size for file in files if file.is_file() and not file.is_symlink())


def import_s(python: Path) -> float:
    """Return the minimum duration of `import semmap` in a new process [s]."""
    command = [str(python), "-P", "-c", _IMPORT]
    return min(float(subprocess.check_output(command, cwd="/")) for _ in range(_IMPORTS))


def measured(parts: Iterable[str]) -> list[Row]:
    """Return a row for each figure."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        wheel = built_wheel(Path(folder))
        rows.append(Row("the wheel", wheel.stat().st_size / 1e6, "MB"))
        for part in parts:
            start_s = time.monotonic()
            extra = "" if part == "base" else f"[{part}]"
            python = environment(Path(folder) / part, f"semmap{extra} @ {wheel.as_uri()}")
            took_s = time.monotonic() - start_s
            base = part == "base"
            name = f"pip install 'semmap{extra}'"
            rows.append(Row(name, megabytes(python), "MB", *((60.0, 50.0) if base else ())))
            rows.append(Row(f"{name}: import semmap", import_s(python), "s", 0.25, 0.15))
            print(f"{name}: {rows[-2].value:.0f} MB, installed in {took_s:.0f} s", file=sys.stderr)
            shutil.rmtree(Path(folder) / part)
    return rows


def main() -> None:
    """Measure, print the table, and write the figures."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.install", description=__doc__.splitlines()[0])
    parser.add_argument("--parts", default=",".join(PARTS), help="Default: %(default)s.")
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    rows = measured(options.parts.split(","))
    print(lines(rows))
    if options.json is not None:
        options.json.write_text(json.dumps([row._asdict() for row in rows], indent=2))


if __name__ == "__main__":
    main()
