import json
import subprocess
import sys

import pytest

from benchmarks import ontologies

SOUND = """@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
<urn:o> a owl:Ontology ; owl:imports <urn:nowhere> . <urn:A> a owl:Class ;
  rdfs:subClassOf <urn:B> . <urn:B> a owl:Class .
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "sound.ttl").write_text(SOUND)
    (tmp_path / "bad.ofn").write_text("Ontology(\nNonsense())")
    (tmp_path / "catalog-v001.xml").write_text("<catalog/>")
    (tmp_path / "readme.md").write_text("no ontology")
    return tmp_path


@pytest.mark.long
def test_a_folder_has_a_row_for_each_ontology(folder, tmp_path):
    file = tmp_path / "rows.json"
    command = [sys.executable, "-m", "benchmarks.ontologies", str(folder), "--json", str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert len(done.stdout.splitlines()) == 4
    bad, sound = json.loads(file.read_text())
    assert (bad["file"], sound["file"]) == ("bad.ofn", "below/sound.ttl")
    assert "line 2" in bad["warnings"][0]
    assert (sound["triples"], sound["compiled"]) == (5, True)
    assert sound["warnings"] == ["urn:nowhere is missing"]
    for figure in ("load_s", "add_p50_ms", "memory_mb", "owlrl_s", "reasonable_s"):
        assert sound[figure] >= 0


def test_a_timeout_is_reported(folder):
    found = ontologies.measured(folder / "below" / "sound.ttl", "owlrl", (), 0.01)
    assert found == {"owlrl_s": None, "owlrl_says": "more than 0.01 s"}
    assert "more than 0.01 s" in ontologies.line({"file": "f", "warnings": []} | found)


def test_a_failure_is_reported(folder):
    found = ontologies.measured(folder / "bad.ofn", "owlrl", (), 60.0)
    assert found["owlrl_s"] is None
    assert found["owlrl_says"].startswith("failed: ")
