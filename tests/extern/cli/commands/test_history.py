"""History, undo and the TBox through the command line and a whole system without a simulator."""

from __future__ import annotations

import json
import re

import pytest

from semmap.nodes.extern.client import connect
from semmap.ontology import HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.conftest import until

DM = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#"
MORE = f"""
@prefix dm: <{DM}> . @prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
dm:Throne a owl:Class ; rdfs:subClassOf dm:Chair ; rdfs:label "throne"@en .
"""


@pytest.fixture(scope="module")
def system(empty_map):
    """Commits: 1 the seed, 2 chair1, 3 chair1 moved by perception, 4 chair2, 5 chair2 removed."""
    with connect(empty_map.endpoint, agent="ann") as client:
        client.add("Chair", "chair1", at=(1.0, 1.0, 0.0), ref="chair")
        with connect(empty_map.endpoint, source="perception", agent="camera") as camera:
            camera.update("chair1", at=(2.0, 1.0, 0.0), confidence=0.5)
        client.add("Chair", "chair2", at=(3.0, 1.0, 0.0))
        client.remove("chair2")
    return empty_map


def test_what_changed_and_when_a_relation_held(system):
    moved, counted = system.cli("diff", "2", "3").splitlines()
    assert moved == "chair1: moved from (1, 1, 0) to (2, 1, 0)"
    assert re.fullmatch(
        r"1 entity changed between commits 2 and 3 \(\d\d:\d\d:\d\d and \d\d:\d\d:\d\d\)", counted
    )
    assert system.cli("diff", "3", "5").startswith("nothing changed between commits 3 and 5 (")
    assert system.cli("diff", "5", "5").startswith("nothing has changed since commit 5 (")
    found = json.loads(system.cli("diff", "3", "4", "--format", "json"))
    assert [(change["name"], change["kind"]) for change in found["changes"]] == [("chair2", "added")]
    with system.client() as client:
        assert client.when("chair1", "isOn", "chair2").text == "chair1 was never on chair2"


def test_history(system):
    table = system.cli("history", "chair1", "--until", "5")
    for word in ("operator/ann", "perception/camera", "0.50", "add Chair chair1", "2 commits"):
        assert word in table
    assert max(map(len, system.cli("history", "--until", "5").splitlines())) <= 120
    rows = json.loads(system.cli("history", "--until", "5", "--format", "json"))
    assert [row["seq"] for row in rows] == [1, 2, 3, 4, 5]
    assert [row["verb"] for row in rows] == ["", "add", "update", "add", "remove"]
    assert rows[-1]["removed"] == ["chair2"]
    assert "0 commits" in system.cli("history", "--until", "2001-01-01")


def test_as_of(system):
    then = json.loads(system.cli("list", "--class", "Chair", "--as-of", "4", "--format", "json"))
    assert [e["name"] for e in then] == ["chair1", "chair2"]
    first = json.loads(system.cli("get", "chair1", "--as-of", "2", "--format", "json"))
    assert first["pose"]["position_m"] == [1.0, 1.0, 0.0]
    time = json.loads(system.cli("history", "chair1", "--format", "json"))[1]["stamp_ns"] / 1e9 + 1e-4
    at_that_time = json.loads(system.cli("get", "chair1", "--as-of", f"{time}", "--format", "json"))
    assert at_that_time["pose"]["position_m"] == [2.0, 1.0, 0.0]
    assert "chair2" in system.cli("list", "--as-of", "4")


def test_a_time_copied_from_history_shows_the_map_with_its_commit(system):
    rows = json.loads(system.cli("history", "--until", "5", "--format", "json"))
    table = [line.split() for line in system.cli("history", "--until", "5").splitlines()]
    shown = next(cells[1] for cells in table if cells[:1] == ["5"])
    for when in (shown, f"{rows[-1]['stamp_ns']}"):
        assert "1 entity" in system.cli("list", "--as-of", when)
        assert int(system.cli("history", "--since", when, "--until", when).split()[-2]) >= 1
    with connect(system.endpoint) as client:
        assert client.list(as_of=rows[3]["stamp_ns"])[-1].name == "chair2"
        assert client.get("chair2", as_of=rows[3]["stamp_ns"] / 1e9).class_ == "Chair"


def test_last_seen(system):
    said = system.cli("last-seen", "chair2")
    assert "(3.000, 1.000, 0.000) m" in said
    assert "commit 4" in said
    assert "removed" in said
    seen = json.loads(system.cli("last-seen", "chair1", "--format", "json"))
    assert (seen["provenance"]["source"], seen["removed"], seen["gone"]) == ("perception", None, None)
    assert re.fullmatch(
        r"last seen at commit 3, \d+ s ago; not seen since, not reported missing", seen["text"]
    )
    with system.client() as client:
        assert re.fullmatch(
            r"removed at commit 5, \d+ s ago by operator/ann", client.last_seen("chair2").text
        )


def test_get_shows_who_when_why_and_how_sure(system):
    card = system.cli("get", "chair1")
    assert "operator/ann: add Chair chair1" in card
    assert "perception/camera: update chair1 (confidence 0.50)" in card


@pytest.mark.parametrize(
    ("words", "commits"),
    [
        (("--by", "camera"), [3]),
        (("--by", "Perception/camera"), [3]),
        (("--by", "ann"), [2, 4, 5]),
        (("--by", "ann", "--limit", "1"), [5]),
        (("chair2", "--by", "perception"), []),
        (("--by", "ann", "--since", "3"), [4, 5]),
    ],
)
def test_history_of_an_author(system, words, commits):
    rows = json.loads(system.cli("history", *words, "--format", "json"))
    assert [row["seq"] for row in rows] == commits


@pytest.mark.parametrize(
    ("words", "status", "text"),
    [
        (("list", "--as-of", "999"), 1, "there is no commit 999 yet"),
        (("get", "chair1", "--as-of", "2999-01-01"), 1, "the time is in the future"),
        (("list", "--as-of", "2001-01-01"), 1, "there was no map at that time; it begins with commit 1"),
        (("list", "--as-of", "someday"), 2, "'someday' is neither a commit number nor a time"),
        (("list", "--as-of", "2", "--class", "Chiar"), 2, "did you mean Chair"),
        (("get", "chair2", "--as-of", "5"), 1, "no entity was named 'chair2' after commit 5"),
        (("history", "chair9"), 1, "no entity was ever named 'chair9'"),
        (("history", "--limit", "0"), 2, "limit"),
        (("history", "--by", "an"), 1, "no commit is by 'an'; did you mean ann?"),
        (("history", "--by", "ben"), 1, "no commit is by 'ben'; the authors are ann, "),
        (("history", "--in", "kitchen9"), 1, "no entity was ever named 'kitchen9'"),
        (("history", "--in", "chair1"), 1, "nothing can be in chair1"),
        (("history", "--since", "-1"), 2, "-1"),
        (("last-seen", "chair9"), 1, "no entity was ever named"),
        (("undo", "999"), 1, "there is no commit 999 yet"),
        (("undo", "0"), 2, "commit must be"),
        (("undo", "2"), 1, "cannot be undone: "),
        (("load", "--tbox", "nowhere.ttl"), 2, "there is no file nowhere.ttl"),
        (("load", "--tbox", HOUSEHOLD_TTL, "--replace"), 2, "always replaces the present"),
        (("repair", "--data", "nowhere"), 2, "there is no map in"),
    ],
)
def test_bad_requests_get_one_line(system, words, status, text):
    assert text in system.cli(*words, status=status)


def test_undo(system):
    system.cli("add", "Chair", "chair7", "--at", "5", "5", "0")
    assert "undid commit" in system.cli("undo")
    assert "label or class 'chair7'" in system.cli("get", "chair7", status=1)
    commits = json.loads(system.cli("history", "--limit", "2", "--format", "json"))
    assert commits[1]["undoes"] == [commits[0]["seq"]]
    system.cli("undo", str(commits[1]["seq"]))
    assert "chair7" in system.cli("list")


def test_another_tbox_comes_with_its_imports(system, tmp_path):
    (tmp_path / "house.ttl").write_text(HOUSEHOLD_TTL.read_text())
    (tmp_path / "thrones.ofn").write_text(
        "Ontology(<http://o.org/thrones> Import(<http://o.org/house>) Import(<http://o.org/nowhere>)"
        f" SubClassOf(<{v.TBOX}Throne> <{v.TBOX}Chair>) Declaration(Class(<{v.TBOX}Throne>)))"
    )
    words = ("load", "--tbox", tmp_path / "thrones.ofn", "--import")
    assert "is not IRI=FILE" in system.cli(*words, "http://o.org/house", status=2)
    said = system.cli(*words, f"http://o.org/house={tmp_path / 'house.ttl'}")
    assert "classes from thrones.ofn and 1 more file (commit" in said
    note = "1 import was not found; the TBox is used without: http://o.org/nowhere"
    assert f"note: {note}" in said
    until(lambda: f"TBox: {note}" in system.cli("status"), "the note in the status")
    assert "Throne" in system.cli("classes")
    assert "unchanged: the TBox is already that of thrones.ofn and 1 more file" in system.cli(
        *words, f"http://o.org/house={tmp_path / 'house.ttl'}"
    )
    with system.client() as client:
        client.undo(client.status().commit)
        until(
            lambda: not [n for node in client.status().nodes for n in node.notes if "import" in n], "no note"
        )


def test_undescribed_entities_are_reported_or_rejected(system, tmp_path):
    file = tmp_path / "strange.ttl"
    file.write_text(
        f"@prefix : <{v.ABOX}> . @prefix dm: <{v.TBOX}> . :stool9 a dm:Chair ; dm:isLocatedIn :hal ."
    )
    refusal = system.cli("load", file, "--strict", status=1)
    assert "referenced but not described: hal (stool9 isLocatedIn hal)" in refusal
    assert "note: referenced but not described: hal" in system.cli("load", file)
    with system.client() as client:
        client.undo(client.status().commit)


def test_another_tbox(system, tmp_path):
    file = tmp_path / "more.ttl"
    file.write_text(MORE)
    assert "the map does not fit the TBox: unknown class" in system.cli("load", "--tbox", file, status=1)
    assert "unknown class 'Throne'" in system.cli("add", "Throne", status=2)
    file.write_text(HOUSEHOLD_TTL.read_text() + MORE)
    assert "classes from more.ttl (commit" in system.cli("load", "--tbox", file)
    system.cli("add", "Throne", "throne1", "--at", "6", "6", "0", "--default")
    with system.client() as client:
        throne = client.get("throne1")
        assert (throne.preferred_reference, "Chair" in throne.types) == ("throne", True)
        assert "the map does not fit the TBox: unknown class 'Throne'" in system.cli(
            "load", "--tbox", HOUSEHOLD_TTL, status=1
        )
        with pytest.raises(errors.Refused, match="the map does not fit the TBox: unknown class 'Throne'"):
            client.undo(throne.provenance.commit - 1)
        client.remove("throne1")
        assert client.undo(throne.provenance.commit - 1).commit
        with pytest.raises(errors.UnknownClass):
            client.add("Throne")
        then = client.list("Throne", as_of=throne.provenance.commit)
        assert [e.name for e in then] == ["throne1"]


def test_an_extension_of_the_tbox(system, tmp_path):
    file = tmp_path / "more.ttl"
    file.write_text(MORE)
    refusal = system.cli("load", "--tbox", file, status=1)
    assert refusal.strip().endswith("to add it to the current TBox use --extend")
    assert "--extend applies to TBoxes only" in system.cli("load", "--extend", file, status=2)
    extend = ("load", "--tbox", "--extend", file)
    assert "it would be: the TBox extended by more.ttl" in system.cli(*extend, "--dry-run")
    assert "the TBox extended by more.ttl: 1 class added, " in system.cli(*extend)
    assert "unchanged: the TBox already contains more.ttl" in system.cli(*extend)
    system.cli("add", "Throne", "throne2", "--at", "6", "6", "0", "--default")
    with system.client() as client:
        assert "Chair" in client.get("throne2").types
        client.remove("throne2")
        client.undo(client.get("throne2", as_of=client.status().commit - 1).provenance.commit - 1)
        with pytest.raises(errors.UnknownClass):
            client.add("Throne")
