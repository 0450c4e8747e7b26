"""Reader of semantic maps of the Human Robot Interaction Corpus (`.hrc`).

Each file has a spoken command and a map of the house in which it was spoken.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

from semmap.schemas import codec
from semmap.schemas.errors import BadFile, BadRequest
from semmap.schemas.nesting import require_shallow_xml
from semmap.schemas.scene_files import Described

_ABILITIES = {"contain_ability": "containing", "support_ability": "supporting"}


def read(content: bytes, filename: str) -> tuple[Described, ...]:
    """Return the entities of the map in a HuRIC example. Raises BadFile with the entity that is invalid."""
    name = filename or "the file"
    if b"<!ENTITY" in content or b"<!DOCTYPE" in content:
        raise BadFile(f"{name} declares XML entities, which are not allowed in HuRIC maps")
    try:
        require_shallow_xml(content)
        root = ET.fromstring(content)
    except ValueError as error:
        raise BadFile(f"{name} is not valid XML: {error}") from None
    elements = root.findall("./semanticMap/entities/entity")
    if not elements:
        raise BadFile(f"{name} has no semantic map with entities")
    return tuple(_described(element, name) for element in elements)


def _described(element: ET.Element, filename: str) -> Described:
    values = {
        attribute.get("name", ""): [(value.text or "").strip() for value in attribute.findall("value")]
        for attribute in element.findall("./attributes/attribute")
    }
    references = [text for text in values.get("lexical_references", []) if text]
    described: dict[str, object] = {
        "class": element.get("type", ""),
        "name": element.get("atom", ""),
        "alt": references[1:],
        "affords": [word for ability, word in _ABILITIES.items() if values.get(ability) == ["true"]],
    }
    if references:
        described["ref"] = references[0]
    place = element.find("coordinate")
    try:
        if place is not None:
            described["at"] = [float(place.get(axis, "0")) for axis in "xyz"]
            described["yaw"] = float(place.get("angle", "0"))
        return codec.convert(described, Described)
    except (BadRequest, ValueError) as error:
        reason = str(error).removeprefix("malformed message: ")
        raise BadFile(f"{filename}: entity '{element.get('atom')}': {reason}") from None
