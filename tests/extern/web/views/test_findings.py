from msgspec import structs

from semmap.nodes.extern.web.views.findings import collect_findings, format_verdict, is_sound, names_in
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import BodyState
from semmap.schemas.explanations import Explanation, Step
from semmap.schemas.relations import Relation
from semmap.schemas.replies import Checked, Violation
from tests.recorder.messages import SINCE, entity

SOUND = Checked(
    consistent=True, engine="semmap", triples=4846, elapsed_s=0.0312, text="the map is consistent"
)
CUP, TABLE = entity("cup1", "Cup"), entity("table1", "Table")


def test_a_consistent_map_has_no_findings():
    assert collect_findings(SOUND, [CUP]) == ()
    assert format_verdict(SOUND) == "the map is consistent (4,846 triples, 31 ms, semmap)"


def test_contradictions_are_first_with_their_proof():
    fact = (v.entity_iri("cup1"), v.RDF_TYPE, v.dm("Cup"))
    explanation = Explanation(
        conclusion=None, support=(fact,), steps=(Step(rule="cax-dw", premises=(fact,), conclusion=None),),
        text="cup1 cannot be a Cup and a Table",
    )  # fmt: skip
    bad = structs.replace(
        SOUND, consistent=False, text="inconsistent", explanation=explanation, withheld=("x",)
    )
    first, second = collect_findings(bad, [CUP])
    assert (first.kind, first.names) == ("contradiction", ("cup1",))
    assert first.proof[0] == "these facts contradict one another (contradiction)"
    assert first.proof[1].strip() == "cup1 is a Cup (asserted)"
    assert second.kind == "suppressed"


def test_violations_of_shapes_name_their_entities_and_their_severity():
    def violation(severity, value=""):
        text = f"cup1: needs a support; isOn{value and f'; {value}'}"
        return Violation(
            name="cup1", message="needs a support", path="isOn", value=value, severity=severity, shape="",
            text=text,
        )  # fmt: skip

    checked = structs.replace(
        SOUND,
        conforms=False,
        shapes=2,
        violation_count=2,
        violations=(violation("violation", "table1"), violation("warning")),
        notes=("shapes not evaluated: too deep",),
    )
    found = [(f.kind, f.text, f.names) for f in collect_findings(checked, [CUP, TABLE])]
    assert found == [
        ("violation", "cup1: needs a support; isOn; table1", ("cup1", "table1")),
        ("violation", "warning: cup1: needs a support; isOn", ("cup1",)),
        ("unchecked", "shapes not evaluated: too deep", ()),
    ]
    assert format_verdict(checked).endswith("; 2 SHACL shapes: 2 violations")
    assert not is_sound(checked)
    assert is_sound(SOUND)


def test_suppressed_and_denied_facts_name_their_entities():
    denied = Relation(
        relation="isOn", subject="cup1", object="table1", holds=False, text="cup1 is not on table1"
    )
    checked = structs.replace(SOUND, withheld=("table1 would be inside cup1.",), denied=(denied,))
    assert [f.names for f in collect_findings(checked, [CUP, TABLE])] == [
        ("table1", "cup1"),
        ("cup1", "table1"),
    ]


def test_doubts_and_body_problems_are_listed():
    doubted = entity("cup2", "Cup", conflict="a bowl")
    unsure = structs.replace(CUP, provenance=structs.replace(SINCE, source="perception", confidence=0.3))
    ghost = structs.replace(TABLE, body=BodyState(status="ghost"))
    texts = [f.text for f in collect_findings(SOUND, [doubted, unsure, ghost])]
    assert texts == [
        "cup1: low confidence (30%, source perception)",
        "cup2: perception detects a bowl",
        "table1 has a non-colliding body, because another body occupies its place",
    ]


def test_names_match_whole_words_only():
    known = {"cup1", "cup10", "café.2"}
    assert names_in("cup10 is on café.2. cup1!", known) == ("cup10", "café.2", "cup1")
    assert names_in("cup100 and cup", known) == ()
