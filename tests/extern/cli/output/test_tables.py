"""Tables in a terminal: cells are complete at any width."""

import io
import re
import time
from collections import Counter

import pytest
from msgspec import structs
from rich.console import Console

from semmap.nodes.extern.cli.output import show, tables
from semmap.schemas.entities import BodyState, Entity, Pose, Provenance, RuleInfo
from semmap.schemas.relations import Described
from semmap.schemas.replies import LoggedCommit, NodeStatus, SystemStatus


@pytest.mark.parametrize(("count", "last"), [(0, []), (20, ["p19"]), (21, ["… and 1 more problem"])])
def test_of_many_problems_a_few_are_shown_and_the_rest_counted(count, last):
    status = SystemStatus(
        truth="map",
        commit=1,
        entities=0,
        bodies=0,
        in_agreement=True,
        nodes=(),
        problems=tuple(f"p{i}" for i in range(count)),
    )
    lines = [line.partition(";")[0] for line in show.problem_lines(status)]
    assert lines[:20] == [f"p{i}" for i in range(min(count, 20))]
    assert lines[-1:] == last


def entity(name, size_m=(0.0802, 0.125, 0.095)):
    provenance = Provenance(source="operator", agent="cli/ann", commit=7, stamp_ns=1, reason="add it")
    return Entity(
        name=name, class_="Alternative_Armchair", iri=f"http://www.example.org/semantic_mapping/2016#{name}",
        types=("Armchair",), pose=Pose(position_m=(12.345, -6.789, 0.761)), size_m=size_m,
        preferred_reference="the old coffee cup of my grandmother", provenance=provenance,
        pose_provenance=provenance, shape_provenance=provenance, reference_provenance=provenance,
    )  # fmt: skip


def commit(seq):
    return LoggedCommit(
        seq=seq, stamp_ns=seq * 10**9, source="operator", agent="cli/ann", verb="add", reason="add Cup cup1",
        confidence=None, undoes=(), tbox=False, inserted=1524, retracted=3, changed=("cup1", "cup2"),
        removed=("abat_jour1",),
    )  # fmt: skip


def node(name, last_error=""):
    return NodeStatus(
        node=name, state="ready", pid=12345, uptime_s=70, heartbeat_age_s=0.1, last_error=last_error,
        detail="commit 10, into 2026-11-21T08-58-41.rrd, live at 127.0.0.1:9876",
    )  # fmt: skip


def system(*nodes):
    return SystemStatus(
        truth="map", commit=3, entities=2, bodies=1, in_agreement=True, nodes=nodes, problems=()
    )


@pytest.mark.parametrize(
    ("nodes", "text"),
    [
        ((), "no simulator is running"),
        ((structs.replace(node("sim_node"), state="starting"),), "the simulator is starting"),
    ],
)
def test_a_status_without_a_scene_tells_whether_the_simulator_starts(nodes, text):
    status = structs.replace(system(*nodes), in_agreement=None)
    assert f"; {text}; " in f"{show.status_line(status)}; "


TABLES = {
    "entities": lambda: show.entity_table([entity("chair1"), entity("chair_in_the_corner_12")]),
    "card": lambda: show.entity_card(Described.of(entity("chair1"))),
    "history": lambda: show.history_table([commit(8), commit(1234)]),
    "status": lambda: show.status_table(system(node("kb_node"), node("perception_node", "09:12:01 no disk"))),
}


def test_a_card_of_what_is_not_in_space_has_what_refers_to_it_and_no_pose():
    person = structs.replace(
        Described.of(entity("anna")),
        in_space=False,
        properties={"age": 41, "name": "Anna B."},
        referred_by={"knows": ("bob", "carla")},
    )
    card = drawn(show.entity_card(person), 80)
    for text in (
        "none: not in space",
        "knows: bob and carla",
        "age",
        "name (property)  Anna B.",
        "last change      commit 7",
    ):
        assert text in card
    assert "pose set" not in card
    assert "label set" in card
    bare = drawn(
        show.entity_card(structs.replace(Described.of(entity("c")), pose=None, preferred_reference="")), 80
    )
    assert not re.search("(pose|label) set", bare)
    assert show.entity_line([entity("chair1"), person]) == "1 entity and 1 individual not in space"


def drawn(table, width, *, is_terminal=True):
    out = io.StringIO()
    terminal = {"force_terminal": is_terminal, "color_system": None}
    Console(file=out, width=width, highlight=False, soft_wrap=True, markup=False, **terminal).print(table)
    return out.getvalue()


def signs(text):
    return Counter(c for c in text if not c.isspace() and c != "─")


@pytest.mark.parametrize("width", [40, 80, 100])
@pytest.mark.parametrize("name", TABLES)
def test_nothing_is_cut_off(name, width):
    text = drawn(TABLES[name](), width)
    assert "…" not in text
    assert signs(text) == signs(drawn(TABLES[name](), 1000))


def test_very_many_rows_are_the_same_without_being_laid_out():
    few = [entity(f"chair{i}") for i in range(500)] + [entity("a\nb"), entity("椅子")]
    text, longer = drawn(show.entity_table(few), 1000), drawn(show.entity_table(few * 3), 1000)
    assert "a\\nb" in longer
    assert longer.count("chair7 ") == 3
    lines = [line.rstrip() for line in text.splitlines() if line.strip()]
    assert [line.split() for line in longer.splitlines()[1 : len(lines) - 1]] == [
        x.split() for x in lines[2:]
    ]
    columns = {line.index("Alternative") for line in longer.splitlines()[1:] if line.isascii()}
    assert columns == {longer.splitlines()[0].index("class")}


def test_in_a_pipe_it_is_the_header_and_a_line_for_each_row():
    text = drawn(show.entity_table([entity("cup2"), entity("a\nb")], ("name", "z")), 40, is_terminal=False)
    assert [line.split() for line in text.splitlines()] == [
        ["name", "z"],
        ["cup2", "0.761"],
        [r"a\nb", "0.761"],
    ]


def test_entities_are_sorted_by_a_column_and_those_without_a_value_come_last():
    low, high, lost = entity("b"), entity("a"), structs.replace(entity("c"), pose=None)
    low = structs.replace(low, pose=Pose(position_m=(0.0, 0.0, -1.0)), size_m=(3.0, 3.0, 3.0))
    names = {
        column: [e.name for e in show.sort_entities([lost, low, high], column)]
        for column in ["z", "name", "size"]
    }
    assert names == {"z": ["b", "a", "c"], "name": ["a", "b", "c"], "size": ["c", "a", "b"]}
    assert show.sort_entities([lost, low], None) == [lost, low]


def test_a_list_of_very_many_rows_takes_no_time():
    chairs = [entity(f"chair{i}") for i in range(2_000)]
    begun = time.process_time()
    drawn(show.entity_table(chairs), 100)
    assert time.process_time() - begun < 3.0  # laid out it takes six seconds


def test_what_a_row_is_known_by_stays_on_one_line():
    text = drawn(show.entity_table([entity("chair_in_the_corner_12")]), 60)
    assert all(word in text for word in ("chair_in_the_corner_12", " 12.345 ", " -6.789 ", " 0.761 "))
    assert " 1234 " in drawn(show.history_table([commit(1234)]), 60)


def test_a_common_list_and_history_fit_80_columns():
    common = tables.table("name", "class", "size [m]", "reference", fold=("class", "size [m]", "reference"))
    common.add("cup1", "Cup", "0.08 x 0.11 x 0.095", "the old coffee cup of my grandmother, a blue one")
    for table in (common, show.history_table([commit(8)]), TABLES["status"]()):
        assert all(len(line) <= 80 for line in drawn(table, 80).splitlines())


def test_errors_have_a_column_only_if_there_are_any():
    assert "last error" not in drawn(show.status_table(system(node("kb_node"))), 120)
    assert "no disk" in drawn(show.status_table(system(node("kb_node", "no disk"))), 120)


def test_large_sizes_are_written_out():
    assert "1000 x 99.5 x 0.0802" in drawn(show.entity_table([entity("hall", (1000.0, 99.5, 0.0802))]), 200)


def test_bodies_that_could_not_be_made_are_reported_below_the_list():
    failed = BodyState(status="failed", detail="too long")
    chairs = [entity("chair1"), structs.replace(entity("chair2"), body=failed)]
    assert (
        show.entity_line(chairs)
        == "2 entities; 1 body could not be created; for the reason see: semmap status"
    )
    assert show.entity_line(chairs[:1]) == "1 entity"


def test_each_note_on_a_commit_has_a_row_of_its_own():
    noted = structs.replace(commit(8), notes=("retracted: one", "on table1 was cup1"))
    lines = drawn(show.history_table([noted, commit(9)]), 200).splitlines()
    assert [line.strip() for line in lines if "note: " in line] == [
        "note: retracted: one",
        "note: on table1 was cup1",
    ]


def test_the_table_of_rules_has_the_reason_of_a_rule_without_effect():
    rules = [
        RuleInfo(name="", text="if x is a mug, then x is a cup", holds=2),
        RuleInfo(name="much", text="if x is a mug, then y is a cup", holds=9, at_least=True),
        RuleInfo(name="unused", text="", holds=0, unsupported="disabled"),
    ]
    console = Console(file=io.StringIO(), width=100)
    console.print(show.rule_table(rules))
    lines = console.file.getvalue().splitlines()
    assert [line.split() for line in lines[1:]] == [
        ["2", "if", "x", "is", "a", "mug,", "then", "x", "is", "a", "cup"],
        ["≥", "9", "much", "if", "x", "is", "a", "mug,", "then", "y", "is", "a", "cup"],
        ["-", "unused", "no", "effect:", "disabled"],
    ]
