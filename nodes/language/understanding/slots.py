"""What fills a role, told for all frames alike: the thing acted on is Taking's Theme and Attaching's Item.

What is learnt of one frame so holds of others. A slot of a frame is a role of it; the roles are FrameNet's,
as the Human Robot Interaction Corpus uses them.
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
# Roles that a slot's other words stand for: told apart again by what is spoken of (`role`).
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
    """The slot that a role of a frame is. Raises KeyError for a role that nobody knows."""
    for name, roles in _ROLES.items():
        if roles.get(frame) == role:
            return name
    for name, roles in _ROLES.items():
        if frame not in roles and roles[""] == role:
            return name
    return _ALSO[role]


def role(frame: str, slot: str, branch: str, verb: str) -> str:
    """The role that a slot is in a frame. branch: what kind of thing fills it; verb: the base form."""
    if frame == "Closure" and slot == "thing" and branch in _PORTALS:
        return "Container_portal"
    if frame == "Locating" and slot == "agent" and verb != "find":
        return "Cognizer"
    roles = _ROLES[slot]
    return roles.get(frame, roles[""])
