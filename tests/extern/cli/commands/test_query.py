"""Queries about one triple through the command line, the client and a raw Zenoh query."""

import io
import json
from contextlib import redirect_stdout

import pytest

from semmap.nodes.extern.cli.app import execute
from semmap.schemas import errors, keys


@pytest.fixture(scope="module")
def system(empty_map):
    with empty_map.client() as client:
        client.add("Kitchen", "kitchen1", at=(0, 0, 0), size=(4, 4, 3))
        client.add("Chair", "chair1", at=(1, 1, 0), ref="chair")
    return empty_map


def said(system, monkeypatch, *words):
    """What a verb prints, and its exit status."""
    monkeypatch.setenv("SEMMAP_CONNECT", system.endpoint)
    out = io.StringIO()
    with redirect_stdout(out):
        status = execute([*words])
    return out.getvalue(), status


def test_could_says_yes_or_no_and_changes_nothing(system, monkeypatch):
    with system.client() as client:
        before = client.status().commit
        text, status = said(system, monkeypatch, "could", "chair1", "type", "Armchair")
        assert (text, status) == ("yes: nothing excludes that chair1 is an armchair\n", 0)
        text, status = said(system, monkeypatch, "could", "chair1", "type", "Kitchen")
        assert text.startswith("no: chair1 is not a kitchen, because it is a chair (asserted), ")
        assert (status, client.status().commit) == (1, before)
        assert client.could("chair1", "type", "Seat").text == "yes: chair1 is a seat already"
        assert not client.could("kitchen1", "is on", "kitchen1").possible
        assert client.check().consistent


def test_could_in_json(system, monkeypatch):
    text, status = said(system, monkeypatch, "could", "chair1", "type", "Kitchen", "--format", "json")
    answer = json.loads(text)
    assert (status, answer["possible"]) == (1, False)
    assert answer["explanation"]["supposed"][2].endswith("#Kitchen>")
    with system.client() as client:
        selector = f"{keys.CMD}/could?name=chair1;predicate=type;value=Kitchen;format=json"
        (reply,) = client.session.get(selector)
        assert json.loads(reply.ok.payload.to_string()) == answer


def test_why_something_cannot_be(system, monkeypatch):
    text, status = said(system, monkeypatch, "explain", "--not", "chair1", "type", "Kitchen")
    assert text.startswith("chair1 is not a kitchen, because it is a chair (asserted), ")
    assert status == 0
    text, _ = said(system, monkeypatch, "explain", "chair1", "differentFrom", "kitchen1")
    assert text.startswith("chair1 is different from kitchen1, because ")
    with system.client() as client:
        with pytest.raises(errors.Refused, match="it does not hold: chair1 is not a kitchen, because"):
            client.explain("chair1", "type", "Kitchen")
        with pytest.raises(errors.Refused, match="that chair1 is an armchair, but nothing excludes it"):
            client.explain("chair1", "type", "Armchair", negated=True)


def test_a_map_that_is_not_worked_out_change_by_change_is_asked_beside(system, monkeypatch):
    """Classes that are the same are beyond the compiled engine, so the answer comes from a copy."""
    text, status = said(system, monkeypatch, "could", "Chair", "sameAs", "Stool")
    assert (text, status) == ("yes: nothing excludes that Chair is the same as Stool\n", 0)
    text, status = said(system, monkeypatch, "could", "Chair", "sameAs", "Kitchen")
    assert text.startswith("no: Chair is different from Kitchen, because chair1 is a chair (asserted)")
    assert status == 1
