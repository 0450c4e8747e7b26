import itertools
import time
from pathlib import Path

import pytest

from semmap.nodes.extern.cli.output import show_tbox
from semmap.nodes.kb_node.documents.tbox.tbox_check import check
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas import errors
from tests.data import data_folder

PREFIXES = "@prefix : <http://o.org/o#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
PREFIXES += "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
ONTOLOGY = """
<http://o.org/o> a owl:Ontology ; owl:versionIRI <http://o.org/o/1> ;
  owl:imports <http://o.org/more> , <urn:none> .
:Cup a owl:Class . :Glass a owl:Class ; rdfs:subClassOf :Cup . :Plate a owl:Class ; owl:disjointWith :Cup .
:holds a owl:ObjectProperty . :weight a owl:DatatypeProperty . :note a owl:AnnotationProperty .
:cup1 a :Cup . :cup2 a owl:NamedIndividual .
:Cup rdfs:subClassOf [ a owl:Restriction ; owl:onProperty :holds ; owl:someValuesFrom :Plate ] .
"""
MORE = "<http://o.org/more> a owl:Ontology . <http://o.org/more#Cup> a owl:Class ."


@pytest.fixture
def report(tmp_path):
    def report(more: str = "", text: str = ONTOLOGY):
        (tmp_path / "more.ttl").write_text(PREFIXES + MORE)
        (tmp_path / "o.ttl").write_text(PREFIXES + text + more)
        return check([tmp_path / "o.ttl"], {})

    return report


def test_the_contents_of_an_ontology_are_reported(report, tmp_path):
    found = report()
    assert found.is_sound
    assert [Path(file).name for file in found.files] == ["o.ttl", "more.ttl"]
    assert found.ontologies == {"http://o.org/more": "", "http://o.org/o": "http://o.org/o/1"}
    assert found.imports == {"http://o.org/more": str(tmp_path / "more.ttl")}
    assert found.missing == ("urn:none",)
    assert (found.classes, found.individuals) == (4, 2)
    assert (found.object_properties, found.data_properties, found.annotation_properties) == (1, 1, 1)
    assert found.outside_rl == {"existential restriction as a superclass": 1}
    assert found.ambiguous == {"Cup": {"more:Cup": "http://o.org/more#Cup", "o:Cup": "http://o.org/o#Cup"}}
    assert (found.inconsistent, found.unsatisfiable, found.untried) == ("", (), 0)


def test_rules_and_shapes_are_counted(report):
    found = report(
        "[] a <http://www.w3.org/2003/11/swrl#Imp> . :s a <http://www.w3.org/ns/shacl#NodeShape> ."
    )
    assert found.inert == {"SWRL rule (incomplete body)": 1}
    lines = [" ".join(line.split()) for line in show_tbox.report(found)]
    assert "ignored 1 x SWRL rule (incomplete body) (stored, but not evaluated)" in lines


def test_terms_of_rules_that_nothing_declares_are_listed(report):
    found = report(
        "@prefix swrl: <http://www.w3.org/2003/11/swrl#> . :x a swrl:Variable . [] a swrl:Imp ;"
        " swrl:body ( [ a swrl:ClassAtom ; swrl:classPredicate :Cpu ; swrl:argument1 :x ] ) ;"
        " swrl:head ( [ a swrl:ClassAtom ; swrl:classPredicate :Cup ; swrl:argument1 :x ] ) ."
    )
    assert found.undeclared == ("http://o.org/o#Cpu",)
    lines = [" ".join(line.split()) for line in show_tbox.report(found)]
    assert "not declared http://o.org/o#Cpu (used by a SWRL rule)" in lines


def test_a_class_with_impossible_members_is_unsatisfiable(report):
    """Like the ice cream of the Pizza ontology, which no rule of OWL 2 RL finds."""
    found = report("""
:Topping a owl:Class . :hasTopping a owl:ObjectProperty ; rdfs:domain :Cup ; rdfs:label "has topping" .
:Ice rdfs:label "ice cream" ; a owl:Class ; rdfs:subClassOf :Plate ,
  [ a owl:Restriction ; owl:onProperty :hasTopping ; owl:someValuesFrom :Topping ] .
""")
    (wrong,) = found.unsatisfiable
    assert (wrong.iri, found.untried, found.is_sound) == ("http://o.org/o#Ice", 0, False)
    assert wrong.why == (
        "nothing is an ice cream, because every ice cream has a topping that is a Topping, every ice cream"
        " is a Plate, everything that has a topping is an o:Cup, and nothing is both a Plate and an o:Cup."
    )


def test_the_time_of_changes_is_measured(report, monkeypatch):
    clock = itertools.count()
    for read in ("process_time", "perf_counter"):
        monkeypatch.setattr(time, read, lambda: next(clock) / 1000)
    quick = report().quickness
    assert quick is not None
    assert quick.add_p50_ms == pytest.approx(1.0)
    assert quick.load_s > 0
    assert quick.not_incremental == ""


def test_the_reason_for_slow_changes_is_reported(report):
    quick = report(":Cup owl:sameAs :Tasse .").quickness
    assert quick is not None
    assert "sameAs" in quick.not_incremental
    assert quick.add_p50_ms is not None


def test_unsatisfiable_classes_are_found(report):
    found = report(
        ":Both a owl:Class ; rdfs:subClassOf :Cup , :Plate . :Deep a owl:Class ; rdfs:subClassOf :Both ."
        " :Nil a owl:Class ; owl:equivalentClass owl:Nothing ."
    )
    assert [wrong.iri.partition("#")[2] for wrong in found.unsatisfiable] == ["Both", "Deep", "Nil"]
    assert "Cup" in found.unsatisfiable[0].why
    assert "Plate" in found.unsatisfiable[0].why
    assert not found.is_sound
    assert found.quickness is not None


def test_an_inconsistent_ontology_is_explained(report):
    found = report(":cup1 a :Plate .")
    assert "Cup" in found.inconsistent
    assert not found.is_sound
    assert (found.quickness, found.classes, found.missing) == (None, 4, ("urn:none",))


def test_an_ontology_with_only_unsatisfiable_classes_has_no_time_of_changes(report):
    found = report(text="<http://o.org/o> a owl:Ontology . :A a owl:Class ; rdfs:subClassOf owl:Nothing .")
    assert found.quickness is not None
    assert found.quickness.add_p50_ms is None


@pytest.mark.parametrize(
    ("axioms", "candidate"),
    [
        (":B rdfs:subClassOf :A . :C rdfs:subClassOf :B . :E rdfs:subClassOf :D .", "A"),
        (
            ":E rdfs:subClassOf :B , :C . :B rdfs:subClassOf :D . :C rdfs:subClassOf :D .",
            "D",
        ),
        (":B rdfs:subClassOf :A . :A rdfs:subClassOf :B . :C rdfs:subClassOf :B .", "A"),
        (":B rdfs:subClassOf :A , :Undeclared . :C rdfs:subClassOf :Undeclared . :A :broader :C .", "A"),
        ("", "A"),
    ],
)
def test_the_class_with_most_subclasses_is_proposed_as_that_of_things_in_space(report, axioms, candidate):
    classes = " ".join(f":{name} a owl:Class ." for name in "ABCDE")
    found = report(text=f"<http://o.org/o> a owl:Ontology . {classes} {axioms}")
    assert (found.spatial_classes, found.spatial_candidate) == (0, candidate)


def test_an_unreadable_file_is_reported(tmp_path):
    (tmp_path / "bad.ttl").write_text("\n\n:a")
    with pytest.raises(errors.BadFile, match=r"bad.ttl is not valid Turtle: .*line 3"):
        check([tmp_path / "bad.ttl"], {})


def test_the_household_ontology_has_no_errors():
    found = check([HOUSEHOLD_TTL], {})
    assert found.is_sound
    assert (found.missing, found.ambiguous) == ((), {})
    assert 0 < (found.spatial_classes or 0) < found.classes


@pytest.mark.parametrize(
    ("file", "ambiguous", "empty"),
    [
        ("oro/oro.owl", "Hand", ()),
        pytest.param(
            "soma/SOMA-HOME.owl",
            "Configuration",
            ("PreferenceOrder", "PreferenceRegion"),
            marks=pytest.mark.long,
        ),
        ("bfo", None, ()),
    ],
)
@pytest.mark.process  # not Turtle
def test_real_ontologies_are_read_quickly(file, ambiguous, empty):
    path = data_folder() / "ontologies" / file
    if not path.exists():
        pytest.skip(f"there is no {path}")
    found = check([path], {})
    assert (found.inconsistent, found.untried) == ("", 0)
    assert tuple(wrong.iri.partition("#")[2] for wrong in found.unsatisfiable) == empty
    assert ambiguous is None or ambiguous in found.ambiguous
    assert found.quickness is not None
    assert found.quickness.not_incremental == ""
    assert (found.quickness.add_p50_ms or 99) < 20
