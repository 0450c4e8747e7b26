"""owlrl in a process of its own: it can be given up."""

import pytest

from semmap.nodes.kb_node.owlrl import consistency_check
from semmap.schemas import errors
from tests.kb_node import home


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    monkeypatch.setattr(consistency_check, "_LOOK_S", 0.01)


def test_it_is_given_up_when_nobody_wants_it_any_more():
    with pytest.raises(errors.Refused, match="the knowledge base is stopping"):
        consistency_check.find_owlrl_faults(home.TBOX, is_over=lambda: True)


def test_it_is_given_up_after_a_while(monkeypatch):
    monkeypatch.setattr(consistency_check, "TIMEOUT_S", 0.0)
    with pytest.raises(errors.Refused, match="did not finish within 0 s"):
        consistency_check.find_owlrl_faults(home.TBOX)
