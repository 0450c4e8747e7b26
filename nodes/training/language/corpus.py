"""Annotated commands for training and evaluation: files of the HuRIC corpus."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from semmap.nodes.language.understanding.grounding import Thing


class Role(NamedTuple):
    """The filler of a role: first and last word, and the head if it is annotated."""

    name: str
    first: int
    last: int
    head: int | None = None


@dataclass(frozen=True, slots=True)
class Filled:
    """An annotated frame. Words are counted from 1."""

    name: str
    verb: tuple[int, ...]
    arguments: tuple[Role, ...]


@dataclass(frozen=True, slots=True)
class Example:
    """A command and the map that it was spoken in."""

    name: str
    group: str  # the folder that it comes from
    words: tuple[str, ...]
    frames: tuple[Filled, ...]
    things: tuple[Thing, ...]
    groundings: tuple[tuple[int, str], ...] = ()  # word and name of an entity, which need not be in the map


def read(folder: Path) -> list[Example]:
    """Return the examples of all `.hrc` files in a folder, by name. Raises FileNotFoundError for none."""
    paths = sorted(folder.rglob("*.hrc"), key=lambda path: path.stem)
    if not paths:
        raise FileNotFoundError(f"there are no .hrc files under {folder}")
    return [_example(path) for path in paths]


def _example(path: Path) -> Example:
    root = ET.parse(path).getroot()
    command = root.find("commands/command")
    if command is None:
        raise ValueError(f"{path} has no command")
    tokens = sorted(command.findall("tokens/token"), key=lambda token: int(token.get("id", "0")))
    words = [token.get("surface", "") for token in tokens] or command.findtext("sentence", "").split()
    frames = tuple(
        Filled(
            frame.get("name", ""),
            _ids(frame, "lexicalUnit/token"),
            tuple(
                Role(role.get("type", ""), ids[0], ids[-1], _head(role, ids))
                for role in frame.findall("frameElements/frameElement")
                if (ids := _ids(role, "token"))
            ),
        )
        for frame in command.findall("semantics/frames/frame")
    )
    things = tuple(_thing(entity) for entity in root.findall("semanticMap/entities/entity"))
    groundings = tuple(
        (int(found.get("tokenId", "0")), found.get("atom", ""))
        for found in root.findall("lexicalGroundings/lexicalGrounding")
    )
    lowered = tuple(word.lower() for word in words)
    return Example(path.stem, path.parent.name, lowered, frames, things, groundings)


def _head(role: ET.Element, inside: tuple[int, ...]) -> int | None:
    told = role.get("semanticHead", "")
    return int(told) if told.isdigit() and int(told) in inside else None


def _ids(element: ET.Element, path: str) -> tuple[int, ...]:
    return tuple(sorted(int(token.get("id", "0")) for token in element.findall(path)))


def _thing(entity: ET.Element) -> Thing:
    references = tuple(
        (value.text or "").strip()
        for attribute in entity.findall("attributes/attribute")
        if attribute.get("name") == "lexical_references"
        for value in attribute.findall("value")
    )
    place = entity.find("coordinate")
    at = None if place is None else tuple(float(place.get(axis, "0")) for axis in "xyz")
    return Thing(entity.get("atom", ""), entity.get("type", ""), references, at)  # type: ignore[arg-type]
