"""The names of the package are imported on first use."""

import subprocess
import sys

import pytest

from semmap.nodes.kb_node import reasoner

_WORDS_ALONE = """
import sys
import semmap.nodes.kb_node.reasoner.explain.sentences
rules = [name for name in sys.modules if name.startswith("semmap.nodes.kb_node.reasoner.rules")]
sys.exit(str(rules) if rules else 0)
"""


def test_importing_words_does_not_import_the_rules():
    done = subprocess.run([sys.executable, "-c", _WORDS_ALONE], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_every_exported_name_exists():
    assert all(getattr(reasoner, name).__module__.startswith(reasoner.__name__) for name in reasoner.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'Reasonr'"):
        reasoner.Reasonr  # noqa: B018
