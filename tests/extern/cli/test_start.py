"""The command line, started as a separate process."""

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from semmap.nodes.extern.cli.all_commands import _MODULE_OF
from semmap.nodes.extern.cli.app import execute

# Ctrl-C while the verbs are being imported.
INTERRUPTED = """
import sys, importlib.abc
class Interrupted(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "semmap.nodes.extern.cli.all_commands":
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
        "import sys; from semmap.nodes.extern.cli.all_commands import app\n"
        "for verb in app.list_commands(None): app.get_command(None, verb)\n"
        "sys.exit('numpy' in sys.modules or len(app.commands) < 30)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize(
    ("words", "needless"),
    [
        (("--version",), {"zenoh", "rich.console", "semmap.nodes.extern.client"}),
        (("perceive", "missing.pcd"), {"zenoh", "numpy"}),
        (("tbox", "--help"), {"zenoh", "rich.console", "semmap.nodes.extern.client"}),
        (
            ("update", "cup1", "--connect", "tcp/127.0.0.1:9"),
            {"rich.console", "semmap.nodes.extern.availability"},
        ),
        (("sparql", "ASK {}", "--connect", "tcp/127.0.0.1:9"), {"rich.console", "rich.table"}),
    ],
)
def test_a_command_imports_only_what_it_needs(words, needless):
    code = (
        "import sys; from semmap.nodes.extern.cli.app import execute\n"
        f"execute({list(words)!r})\nsys.exit(sorted({needless!r} & sys.modules.keys()) or 0)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("list", "--json"), "unknown option '--json'; did you mean --format json?"),
        (("sparql", "ASK {}", "--csv"), "unknown option '--csv'; did you mean --format csv?"),
        (("list", "--clas"), "unknown option '--clas'; did you mean --class?"),
        (("status", "--xyz"), "unknown option '--xyz'; see: semmap status --help"),
    ],
)
def test_an_unknown_option_says_which_one_may_be_meant(words, said, capsys):
    assert execute([*words]) == 2
    assert capsys.readouterr().err == f"semmap: {said}\n"


def test_each_command_with_a_client_lists_the_connection_options(capsys):
    assert execute(["run", "--help"]) == 0
    assert "--connect, --identity, --namespace" in capsys.readouterr().out
    assert execute(["help"]) == 0
    said = capsys.readouterr().out
    assert "Zenoh endpoint of the system." in said
    assert "SEMMAP_CONNECT" in said


def test_it_says_its_version():
    semmap = Path(sys.executable).parent / "semmap"
    ended = subprocess.run([semmap, "--version"], capture_output=True, text=True, check=True)
    assert ended.stdout.startswith("semmap, version ")


@pytest.mark.parametrize(
    ("typed", "meant"), [("rm", "remove"), ("delete", "remove"), ("show", "get"), ("ls", "list")]
)
def test_what_other_tools_call_a_command_suggests_ours(capsys, typed, meant):
    assert execute([typed]) == 2
    assert capsys.readouterr().err == f"semmap: unknown command '{typed}'; did you mean {meant}?\n"


def test_every_command_is_in_one_group_of_the_help(capsys):
    assert execute(["help"]) == 0
    listed = [
        line.split()[0]
        for line in capsys.readouterr().out.splitlines()
        if re.match(r"  [a-z]\S* {2,}\S", line)
    ]
    assert sorted(listed) == sorted(_MODULE_OF)


def test_help_shows_the_page_of_a_command_and_of_one_of_its_parts(capsys):
    assert execute(["help", "get"]) == 0
    assert capsys.readouterr().out.startswith("Usage: semmap get ")
    assert execute(["help", "fleet", "mirror"]) == 0
    assert capsys.readouterr().out.startswith("Usage: semmap fleet mirror ")
    assert execute(["help", "gte"]) == 2
    assert "unknown command 'gte'; did you mean get?" in capsys.readouterr().err


def test_the_system_may_be_named_before_the_command(capsys):
    assert execute(["--connect", "tcp/127.0.0.1:9", "list"]) == 3
    assert "no response from tcp/127.0.0.1:9" in capsys.readouterr().err
    assert execute(["--connect", "tcp/127.0.0.1:9", "completion", "bash"]) == 2
    assert "--connect is not an option of semmap completion" in capsys.readouterr().err
