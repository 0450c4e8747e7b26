import json
import os
import signal

import pytest

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.extern.cli.commands import tbox
from semmap.schemas import errors

pytestmark = pytest.mark.process  # files other than Turtle are parsed in a process

SOUND = "Ontology(<http://o.org/o> <http://o.org/o/1> Import(<http://o.org/m>) Declaration(Class(<http://o.org/o#A>)))"
UNSOUND = SOUND[:-1] + " SubClassOf(<http://o.org/o#A> owl:Nothing))"


@pytest.fixture
def file(tmp_path):
    def file(text: str):
        path = tmp_path / "o.ofn"
        path.write_text(text)
        return str(path)

    return file


def test_what_is_found_is_reported(file, capsys):
    assert execute(["tbox", "check", file(SOUND)]) == 0
    said = capsys.readouterr().out
    assert "ontology        http://o.org/o (http://o.org/o/1)\n" in said
    assert "contents        1 class" in said
    assert "missing         http://o.org/m (add --import http://o.org/m=FILE)\n" in said
    assert "consistent      yes, and every class is satisfiable\n" in said
    assert " ms (median)\n" in said


def test_an_import_may_be_said(file, tmp_path, capsys):
    other = tmp_path / "elsewhere.ttl"
    other.write_text("<http://o.org/m> a <http://www.w3.org/2002/07/owl#Ontology> .")
    assert execute(["tbox", "check", file(SOUND), "--import", f"http://o.org/m={other}"]) == 0
    said = capsys.readouterr().out
    assert f"imports         http://o.org/m from {other}\n" in said
    assert "missing" not in said


def test_an_unsatisfiable_class_is_the_exit_status(file, capsys):
    assert execute(["tbox", "check", file(UNSOUND), "--format", "json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert [wrong["iri"] for wrong in report["unsatisfiable"]] == ["http://o.org/o#A"]
    assert execute(["tbox", "check", file(UNSOUND)]) == 1
    assert "unsatisfiable   http://o.org/o#A: " in capsys.readouterr().out


@pytest.mark.parametrize("text", ["Ontology(<http://o.org/o>\n  Nonsense())", ""])
def test_what_cannot_be_read_is_one_line(file, capsys, text):
    path = file(text)
    assert execute(["tbox", "check", path]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert path in line


def test_several_files_are_checked_together(file, tmp_path, capsys):
    (tmp_path / "m.ttl").write_text("<http://o.org/m> a <http://www.w3.org/2002/07/owl#Ontology> .")
    assert execute(["tbox", "check", file(SOUND), str(tmp_path)]) == 0
    assert "2 files" in capsys.readouterr().out


def test_an_extension_is_checked_with_the_household_tbox(file, capsys):
    words = ["tbox", "check", "household", file(SOUND), "--spatial-root", "A", "--format", "json"]
    assert execute(words) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["missing"] == ["http://o.org/m"]
    assert report["spatial_classes"] > 200  # those of the household remain


def test_without_classes_of_things_in_space_the_next_step_is_shown(file, capsys):
    below = " Declaration(Class(<http://o.org/o#B>)) SubClassOf(<http://o.org/o#A> <http://o.org/o#B>))"
    assert execute(["tbox", "check", file(SOUND[:-1] + below)]) == 0
    assert (
        "spatial         nothing can be placed; add --spatial-root CLASS, such as B, or extend the household"
        " TBox: semmap up --tbox household --tbox FILE\n"
    ) in capsys.readouterr().out
    assert execute(["tbox", "check", file(SOUND), "--spatial-root", "A"]) == 0
    assert "spatial  " not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("work", "text"),
    [
        (lambda: os.kill(os.getpid(), signal.SIGXCPU), "checking the ontology takes longer than 300 s"),
        (lambda: bytearray(1 << 40), "checking the ontology needs too much memory"),
    ],
)
def test_checking_has_limits(work, text):
    before = signal.getsignal(signal.SIGXCPU)
    with pytest.raises(errors.BadFile, match=text):
        tbox._check_limited(work)
    assert signal.getsignal(signal.SIGXCPU) == before
