"""The command line, started as a process of its own."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from semmap.nodes.extern.cli.app import execute

# Ctrl-C while the verbs are being imported.
INTERRUPTED = """
import sys, importlib.abc
class Interrupted(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "semmap.nodes.extern.cli.all_verbs":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupted())
from semmap.nodes.extern.cli.app import main
main()
"""


def test_ctrl_c_while_it_starts_is_quiet():
    ended = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (128 + signal.SIGINT, "", "")


def test_it_starts_without_numpy():
    code = (
        "import sys; from semmap.nodes.extern.cli.all_verbs import app\n"
        "for verb in app.list_commands(None): app.get_command(None, verb)\n"
        "sys.exit('numpy' in sys.modules or len(app.commands) < 30)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize(
    ("words", "needless"),
    [
        (("--version",), {"zenoh", "rich.console", "semmap.nodes.extern.client"}),
        (("tbox", "--help"), {"zenoh", "rich.console", "semmap.nodes.extern.client"}),
        (
            ("update", "cup1", "--connect", "tcp/127.0.0.1:9"),
            {"rich.console", "semmap.nodes.extern.availability"},
        ),
        (("sparql", "ASK {}", "--connect", "tcp/127.0.0.1:9"), {"rich.console", "rich.table"}),
    ],
)
def test_a_verb_imports_only_what_it_needs(words, needless):
    code = (
        "import sys; from semmap.nodes.extern.cli.app import execute\n"
        f"execute({list(words)!r})\nsys.exit(sorted({needless!r} & sys.modules.keys()) or 0)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("list", "--json"), "there is no option '--json'; did you mean --format json?"),
        (("sparql", "ASK {}", "--csv"), "there is no option '--csv'; did you mean --format csv?"),
        (("list", "--clas"), "there is no option '--clas'; did you mean --class?"),
        (("status", "--xyz"), "there is no option '--xyz'; see: --help"),
    ],
)
def test_an_unknown_option_says_which_one_may_be_meant(words, said, capsys):
    assert execute([*words]) == 2
    assert capsys.readouterr().err == f"semmap: {said}\n"


def test_each_verb_that_talks_to_a_system_says_how_it_is_told_which(capsys):
    assert execute(["run", "--help"]) == 0
    said = capsys.readouterr().out
    assert "Zenoh endpoint of the system." in said
    assert "SEMMAP_CONNECT" in said


def test_it_says_its_version():
    semmap = Path(sys.executable).parent / "semmap"
    ended = subprocess.run([semmap, "--version"], capture_output=True, text=True, check=True)
    assert ended.stdout.startswith("semmap, version ")
