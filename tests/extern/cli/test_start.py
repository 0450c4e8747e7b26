"""The command line, started as a process of its own."""

import signal
import subprocess
import sys
from pathlib import Path

# Ctrl-C while the verbs are being imported.
INTERRUPTED = """
import sys, importlib.abc
class Interrupted(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "nodes.extern.cli.all_verbs":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupted())
from nodes.extern.cli.app import main
main()
"""


def test_ctrl_c_while_it_starts_is_quiet():
    ended = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (128 + signal.SIGINT, "", "")


def test_it_starts_without_numpy():
    code = "import sys, nodes.extern.cli.all_verbs; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_it_says_its_version():
    semmap = Path(sys.executable).parent / "semmap"
    ended = subprocess.run([semmap, "--version"], capture_output=True, text=True, check=True)
    assert ended.stdout.startswith("semmap, version ")
