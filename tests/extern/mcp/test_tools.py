import json
import re
from pathlib import Path
from unittest.mock import Mock

import pytest

from semmap.nodes.extern.mcp import arguments
from semmap.nodes.extern.mcp.answers import Answer
from semmap.nodes.extern.mcp.changes import Changes
from semmap.nodes.extern.mcp.limits import Rate
from semmap.nodes.extern.mcp.tools import READ_TOOLS, Tool, Tools, change_tools, error_text
from semmap.schemas import errors
from semmap.schemas.commands import COMMANDS

ECHO = Tool("echo", "Says what it is given.", arguments.Get, lambda _, asked: told(asked))


def told(asked):
    return Answer(first=1, last=1, head={"name": asked.name})


def tools(**options):
    return Tools(lambda: None, (ECHO,), **options)


def test_a_tool_is_called_by_name_with_its_arguments():
    assert json.loads(tools().call("echo", {"name": "cup1"}).text)["name"] == "cup1"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({}, "echo: name is missing"),
        ({"name": "a", "nmae": 1}, "echo: there is no field 'nmae'; did you mean name?"),
        ({"name": 7}, "echo: name must be a text"),
        ({"name": "x" * 1001}, "up to 1000 characters"),
        ({"name": ["a"]}, "echo: name must be a text"),
        ({"name": None}, "echo: name must be a text"),
        ({"name": "a", "cursor": "nonsense"}, "no cursor"),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence(arguments, sentence):
    with pytest.raises(errors.BadRequest, match=sentence.replace("?", r"\?")):
        tools().call("echo", arguments)


def test_an_unknown_tool_is_named_with_those_that_there_are():
    with pytest.raises(errors.UnknownVerb, match="unknown tool 'lst'; did you mean list"):
        tools().call("lst", {})
    with pytest.raises(errors.UnknownVerb, match="available: overview, find, understand"):
        tools().call("x" * 5000, {})


def test_a_thousand_calls_at_once_are_bounded_and_the_rest_told_when_to_come_again():
    served, refused = 0, []
    own = tools(rate=Rate(20.0, 60.0))
    for _ in range(1000):
        try:
            own.call("echo", {"name": "a"})
            served += 1
        except errors.Busy as error:
            refused.append(error)
    assert 60 <= served < 200
    assert all(0.0 < error.again_s <= 0.06 for error in refused)
    assert json.loads(error_text(refused[0]))["again_s"] == pytest.approx(refused[0].again_s, abs=0.01)


def test_a_complaint_is_short_whatever_was_given():
    assert len(error_text(errors.BadRequest("no " * 10_000))) < 4000


def test_tools_that_read_say_so_and_none_changes():
    assert not any(tool.changes for tool in READ_TOOLS)


def test_every_tool_is_described_and_has_a_schema_without_references():
    for tool in READ_TOOLS:
        schema = tool.schema
        assert schema["type"] == "object"
        assert schema["additionalProperties"] is False
        assert "$ref" not in json.dumps(schema)
        assert 40 < len(tool.description) < 400, tool.name
        for name, field in schema["properties"].items():
            assert "description" in field or "enum" in field or "anyOf" in field or name, name


def tuples_in(schema):
    """The schemas of tuples within a schema."""
    if isinstance(schema, dict):
        yield from [schema] if "prefixItems" in schema else []
    for each in schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ():
        yield from tuples_in(each)


def test_tuples_have_items_without_which_some_hosts_reject_them():
    found = {tool.name: [*tuples_in(tool.schema)] for tool in (*READ_TOOLS, *change_tools(Changes("tester")))}
    assert all(isinstance(each["items"], dict) for tuples in found.values() for each in tuples)
    assert found["propose"]
    assert found["drive"]


@pytest.mark.parametrize(
    "name",
    [
        "find",
        "understand",
        "list",
        "get",
        "relations",
        "explain",
        "history",
        "diff",
        "when",
        "trail",
        "could",
        "route",
    ],
)
def test_arguments_are_named_as_the_fields_of_the_command(name):
    tool = next(tool for tool in READ_TOOLS if tool.name == name)
    fields = set(COMMANDS[name].__struct_encode_fields__)
    assert set(tool.schema["properties"]) - {"cursor"} <= fields


def test_the_page_on_agents_says_what_each_tool_takes():
    page = (Path(__file__).parents[3] / "docs" / "agents.md").read_text()
    rows = re.findall(r"^\| `(\w+)` \| ([^|]*) \|", page, re.MULTILINE)
    page_says = {tool: set(takes.split(", ")) - {"nothing"} for tool, takes in rows}
    for tool in (*READ_TOOLS, *change_tools(Mock())):
        required = tool.schema.get("required", ())
        takes = {f"**{name}**" if name in required else name for name in tool.schema["properties"]}
        assert page_says[tool.name] == takes, tool.name
