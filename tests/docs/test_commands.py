"""The commands and programs that README and manual print are run; those that start systems are parsed."""

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

import click
import pytest

from semmap.nodes.extern.cli.all_commands import app
from semmap.nodes.extern.cli.app import execute
from semmap.nodes.extern.cli.common import InputPath
from semmap.nodes.kb_node.storage.seed import seed
from semmap.ontology import FLAT_TTL
from tests.conftest import until

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
OTHER_MAPS = {
    "knowrob-kitchen.md": ("demo/knowrob_tbox.ttl", "demo/knowrob_kitchen.ttl"),
}
"""TBox and ABox of pages that are not about the flat."""
BLOCK = re.compile(r"^```(sh|console|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PARSED = {
    "up",
    "down",
    "node",
    "repair",
    "replay",
    "movie",
    "completion",
    "watch",
    "perceive",
    "learn",
    "learned",
    "forget",
    "tbox",
    "backup",
    "restore",
    "fleet",
    "mcp",
    "web",
    "ros",
    "mcap",
    *("drive", "attach", "detach"),  # a robot
}
"""Verbs that start, stop or need something else than one running system."""
BUSY_S = 300.0
"""What takes longer than that on a busy machine, hangs."""
CLOCK = re.compile(r"\b12:30\b")
"""A time of day: whatever is meant, it is not in the future."""
EXPECTED = {
    "semmap load demo/nonsense.ttl": 1,
    "semmap find 'la mela nel frigorifero'": 1,  # it is in the bowl, and that is said
    "semmap set door1 isOpen false --if-is yes": 1,  # it is shut already
    "semmap explain apple1 isOn table1": 1,  # it is in a bowl
    "semmap explain apple1 isInside drawer1": 1,  # so it is not in a drawer there
    "semmap check --shapes demo/shapes.ttl": 1,  # which warns of the fridge
}
"""Exit status of those that are printed because they are refused."""


def blocks(page, *languages):
    return [text for language, text in BLOCK.findall(page.read_text()) if language in languages]


def commands(page):
    """Command lines of a page, in order, without prompts and comments."""
    for text in blocks(page, "sh", "console"):
        is_console = any(line.startswith("$ ") for line in text.splitlines())
        for line in text.replace("\\\n", " ").splitlines():
            if is_console and not line.startswith("$ "):
                continue
            line = CLOCK.sub(time.strftime("%H:%M"), line.removeprefix("$ "))
            words = shlex.split(line, comments=True)
            if words and words[0] in ("semmap", "z"):
                yield words


def said_of_files(words, said):
    """Is it only that the reader's own file is not here?"""
    missing = [word for word in words if not (ROOT / word).exists()]
    return any(
        f"there is no {what} {word}" in said for word in missing for what in ("file", "file or folder")
    )


def programs(page):
    return [text for text in blocks(page, "python") if re.search("import semmap|from (semmap|mcp)", text)]


LINES = [pytest.param(page, id=page.name) for page in PAGES if any(commands(page))]
PROGRAMS = [
    pytest.param(
        text,
        id=f"{page.name}-{n}",
        marks=[pytest.mark.long] if "own_system" in text and page.name != "README.md" else [],
    )
    for page in PAGES
    for n, text in enumerate(programs(page), 1)
]


@pytest.fixture(scope="module")
def flat(flat_scene):
    """The shipped flat, and a folder like the checkout."""
    return flat_scene


@pytest.fixture(autouse=True)
def tidied(flat):
    """What one page's programs add does not stand in the way of another's, nor is what they remove missed."""
    with flat.client() as client:
        until(lambda: stands(client.list()), "every body stands there")
        before = {entity.name for entity in client.list()}
        yield
        after = {entity.name for entity in client.list()}
        if before - after:
            client.load(FLAT_TTL, replace=True)
        elif added := sorted(after - before):
            client.remove(*added)


def stands(entities):
    """Is there a body for each that is to have one, and a map that says so?"""
    return not any(entity.body.status in ("pending", "unknown") for entity in entities)


@pytest.fixture
def folder(tmp_path):
    for name in ("demo", "ontology", "examples", "schemas"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("data", "__pycache__"))
    return tmp_path


def environment(system):
    scripts = str(Path(sys.executable).parent)
    return dict(os.environ) | {
        "SEMMAP_CONNECT": system.endpoint,
        "PATH": f"{scripts}{os.pathsep}{os.environ['PATH']}",
        "PYTHONWARNINGS": "default",
    }


@pytest.fixture
def system(page, flat, folder, request):
    """A system with the map of a page; without a simulator if that is not the flat, because of the world."""
    if page.name not in OTHER_MAPS:
        yield flat
        return
    tbox, abox = OTHER_MAPS[page.name]
    seed(folder / "seeded", folder / tbox, folder / abox)
    other = request.getfixturevalue("flat_map")
    other.open_map(folder / "seeded")
    yield other
    other.begin_anew("flat")


@pytest.mark.parametrize("page", LINES)
def test_commands_work_as_printed(page, system, folder):
    for words in commands(page):
        line = shlex.join(words)
        if words[0] == "semmap" and (
            words[1] in PARSED
            or (words[1] == "undo" and len(words) > 2)  # a commit of another map
            or "--namespace" in words  # a robot that is not there: tests/extern/fleet
            or "--connect" in words  # a system elsewhere
            or "--identity" in words  # to a secure system: tests/test_secure.py
            or any("..." in word or "[" in word for word in words)
        ):
            parse(words[1 : words.index("|") if "|" in words else None])
            continue
        if words[0] == "z":
            words = ["zenoh", "--mode", "client", "--connect", system.endpoint, *words[1:]]
            if "subscribe" in words:
                continue  # it never ends
        pipe = words.index("|") if "|" in words else len(words)
        status, out, err = (in_process if words[0] == "semmap" else spawned)(words[:pipe], system, folder)
        if status == 2 and said_of_files(words, err):
            continue
        assert status == EXPECTED.get(line, 0), f"{line}\n{out}{err}"
        if EXPECTED.get(line, 0) == 0:
            assert not err.startswith("semmap: "), f"{line}\n{err}"


def in_process(words, system, folder):
    """As `spawned`, for `semmap` and many times as fast."""
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.chdir(folder)
        patch.setenv("SEMMAP_CONNECT", system.endpoint)
        patch.setattr(sys, "stdin", io.StringIO())
        status = execute(words[1:])
    return status, out.getvalue(), err.getvalue()


def spawned(words, system, folder):
    """Exit status, output and errors of a command that is run in `folder`."""
    done = subprocess.run(
        words,
        capture_output=True,
        text=True,
        cwd=folder,
        env=environment(system),
        timeout=BUSY_S,
        stdin=subprocess.DEVNULL,
    )
    return done.returncode, done.stdout, done.stderr


def parse(words):
    """Is it a command line that the verb understands? Nothing is started."""
    name, *rest = words
    command = app.get_command(None, name)
    while isinstance(command, click.Group) and rest:
        command, rest = command.commands[rest[0]], rest[1:]
    above = click.Context(app, info_name="semmap", **app.context_settings)  # click keeps the names of --help
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(InputPath, "convert", click.Path.convert)  # the files of examples do not exist
        command.make_context(name, [word.strip("[]") for word in rest if word != "..."], parent=above).close()


@pytest.mark.parametrize("text", PROGRAMS)
def test_programs_work_as_printed(text, flat, folder):
    script = folder / "test_program.py"
    script.write_text(text.replace("timeout=60", "timeout=0.5"))
    how = ["-m", "pytest", "-q", "-p", "no:cacheprovider"] if "def test_" in text else []
    done = subprocess.run(
        [sys.executable, *how, script],
        capture_output=True,
        text=True,
        cwd=folder,
        env=environment(flat),
        timeout=BUSY_S,
    )
    ended_for_lack_of_news = "timeout=60" in text and "NoAnswer" in done.stderr
    assert done.returncode == 0 or ended_for_lack_of_news, done.stdout + done.stderr
