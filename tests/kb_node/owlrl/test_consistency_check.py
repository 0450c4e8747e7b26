"""The consistency check with owlrl can be aborted."""

import pytest

from semmap.nodes.kb_node.owlrl import consistency_check
from semmap.schemas import errors
from tests.kb_node import home


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    monkeypatch.setattr(consistency_check, "_POLL_S", 0.01)


def test_it_is_aborted_when_it_is_no_longer_needed():
    with pytest.raises(errors.Refused, match="the knowledge base is stopping"):
        consistency_check.find_owlrl_faults(home.TBOX, is_over=lambda: True)


def test_it_is_aborted_after_a_timeout(monkeypatch):
    monkeypatch.setattr(consistency_check, "TIMEOUT_S", 0.0)
    with pytest.raises(errors.Refused, match="timeout after 0 s"):
        consistency_check.find_owlrl_faults(home.TBOX)
