"""Slots: roles that several frames share, so that training examples of one frame apply to others.

The slot *thing*, for example, is Taking's Theme and Attaching's Item. The roles are FrameNet's, as in the
Human Robot Interaction Corpus.
"""

from __future__ import annotations

from typing import Final

_MOVERS: Final = ("Motion", "Change_direction", "Cotheme")

# slot -> frame -> role; "" stands for all other frames
_ROLES: Final[dict[str, dict[str, str]]] = {
    "agent": {
        "": "Agent",
        **dict.fromkeys(_MOVERS, "Theme"),
        "Inspecting": "Inspector",
        "Locating": "Perceiver",
        "Giving": "Donor",
        "Being_in_category": "Item",
    },
    "thing": {
        "": "Theme",
        "Arriving": "Goal",
        "Attaching": "Item",
        "Change_operational_state": "Device",
        "Closure": "Containing_object",
        "Cotheme": "Cotheme",
        "Inspecting": "Ground",
        "Locating": "Sought_entity",
        "Manipulation": "Entity",
        "Perception_active": "Phenomenon",
    },
    "place": {"": "Location", "Locating": "Ground"},
    "state": {"": "Operational_state", "Inspecting": "Desired_state"},
    "beneficiary": {"": "Beneficiary", "Giving": "Recipient"},
    "manner": {"": "Manner", "Change_direction": "Speed"},
    "goal": {"": "Goal"},
    "source": {"": "Source"},
    "path": {"": "Path"},
    "direction": {"": "Direction"},
    "angle": {"": "Angle"},
    "distance": {"": "Distance"},
    "area": {"": "Area"},
    "category": {"": "Category"},
    "degree": {"": "Degree"},
    "reason": {"": "Reason"},
    "unwanted": {"": "Unwanted_entity"},
}
# Other roles of the corpus and their slots; `role` distinguishes them by the kind of filler.
_ALSO: Final = {
    "Container_portal": "thing",
    "Cognizer": "agent",
    "Place": "place",
    "Speed": "manner",
    "Manner": "manner",
    "Theme": "thing",
    "Item": "thing",
    "Goal": "goal",
}
_PORTALS: Final = ("Door", "Window", "Connecting_Architecture")


def slot(frame: str, role: str) -> str:
    """Return the slot of a frame's role. Raises KeyError for an unknown role."""
    for name, roles in _ROLES.items():
        if roles.get(frame) == role:
            return name
    for name, roles in _ROLES.items():
        if frame not in roles and roles[""] == role:
            return name
    return _ALSO[role]


def role(frame: str, slot: str, branch: str, verb: str) -> str:
    """Return the role of a slot in a frame, for a filler of the kind `branch` and a verb in base form."""
    if frame == "Closure" and slot == "thing" and branch in _PORTALS:
        return "Container_portal"
    if frame == "Locating" and slot == "agent" and verb != "find":
        return "Cognizer"
    roles = _ROLES[slot]
    return roles.get(frame, roles[""])
