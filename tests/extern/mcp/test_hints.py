"""Hints for agents name tools, not commands."""

import pytest

from semmap.nodes.extern.mcp.hints import translate_hints


@pytest.mark.parametrize(
    ("said", "told"),
    [
        (
            "say who it is: --from VIEWER, or --from-pose X Y Z YAW",
            "say who it is: viewer, or viewpoint as x, y, z, yaw",
        ),
        (
            "as a Cup it would be an object; if that is intended, add --force",
            "as a Cup it would be an object; only an operator can do that all the same",
        ),
        (
            "nearest and to (--nearest N, --to NAME) go together: the N nearest to NAME",
            "nearest and to go together: the N nearest to NAME",
        ),
        ("the viewer (--from) must be another entity", "the viewer must be another entity"),
        (
            "use in (--in) for what is in there, or say how far from it (--near PLACE --within M)",
            "use in for what is in there, or say how far from it (near the place, within so many metres)",
        ),
        (
            "the query has more than 9 rows; narrow it, add LIMIT to it, or raise the limit",
            "the query has more than 9 rows; narrow it, or add LIMIT and OFFSET to it",
        ),
        (
            "type is changed with: semmap update fridge1 --class CLASS",
            "type is changed with: propose verb=update name=fridge1 with class",
        ),
        (
            "hasPosition is changed with: semmap update cup1 --at X Y Z",
            "hasPosition is changed with: propose verb=update name=cup1 at=[x, y, z]",
        ),
        ("the name 'cup1' is taken; see: semmap get cup1", "the name 'cup1' is taken; see: get name=cup1"),
        (
            "for the reason: semmap explain cup1 isOn table1",
            "for the reason: explain name=cup1 predicate=isOn value=table1",
        ),
        ("undo that one first: semmap undo 7", "undo that one first: undo commit=7, if that is your own"),
        (
            "unknown property; see: semmap properties",
            "unknown property; see: the resource semmap://schema/properties",
        ),
        (
            "lamp1 has no door, lid or drawer to open; to switch it: semmap open lamp1 --joint switch",
            "lamp1 has no door, lid or drawer to open; to switch it: open name=lamp1 joint=switch",
        ),
        (
            "to change it: semmap open door1, or semmap close",
            "to change it: open name=door1, or close",
        ),
        ("see: semmap last-seen cup1", "see: last_seen name=cup1"),
        (
            "for the past use: semmap when, semmap last-seen, semmap find --as-of",
            "for the past use: when, last_seen, find with as_of",
        ),
        ("first: semmap detach cup1", "first: propose verb=detach name=cup1"),
        (
            "to attach the contents too: semmap attach tray1 --carry",
            "to attach the contents too: propose verb=attach name=tray1 carry=true",
        ),
        (
            "to change only the map: semmap set fridge1 isOpen true",
            "to change only the map: propose verb=set name=fridge1 property=isOpen values=[true]",
        ),
        ("to have none: semmap unset", "to have none: propose verb=unset"),
        ("add --carry", "add carry"),
        ("a well--known cup of semmap://schema", "a well--known cup of semmap://schema"),
        ("nothing is named 'cup1'", "nothing is named 'cup1'"),
    ],
)
def test_commands_and_options_become_tools_and_fields(said, told):
    assert translate_hints(said) == told
