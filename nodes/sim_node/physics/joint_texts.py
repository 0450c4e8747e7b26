"""Texts in an MJCF file that declare which joints are switches, and their closed or off positions."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

import mujoco

CLOSED_TEXT: Final = "semmap-closed:"
OFF_TEXT: Final = "semmap-off:"
"""`<text name="semmap-off:JOINT" data="upper"/>`: the joint is a switch, and off at its upper limit."""
ENDS: Final = ("lower", "upper")

_SWITCHES: Final = ("switch", "knob", "button")
_DIAL: Final = "dial"
_DOOR: Final = "door"
_JOINT: Final = int(mujoco.mjtEq.mjEQ_JOINT)


class JointTexts(NamedTuple):
    """The declarations of a file, by joint name: `lower` or `upper`."""

    closed: dict[str, str]
    off: dict[str, str]

    @classmethod
    def of(cls, spec: mujoco.MjSpec) -> JointTexts:
        """Read the declarations of a file; invalid ends are ignored."""
        return cls(
            *(
                {name: end for name, end in read_texts(spec, p) if end in ENDS}
                for p in (CLOSED_TEXT, OFF_TEXT)
            )
        )

    def closed_end(self, joint: str) -> str | None:
        """Return the declared end at which a joint is closed, or off."""
        return self.off.get(joint) or self.closed.get(joint)

    def is_switch(self, model: mujoco.MjModel, joint: int) -> bool:
        """Return whether a joint is a switch: by a text, else by its name or that of the body it moves.

        `knob_1`, `lightswitch` and `PowerButton` are switches; a `door_knob` is not.
        """
        name = model.joint(joint).name
        if name in self.off or name in self.closed:
            return name in self.off
        called = (name, model.body(int(model.jnt_bodyid[joint])).name)
        words = [word for text in called for word in _words(text)]
        return _DOOR not in words and any(_means_switch(word) for word in words)


def coupled_joints(model: mujoco.MjModel, joints: set[int]) -> set[int]:
    """Return the other joints that equality constraints couple to some of these."""
    found = set(joints)
    pairs = [
        {int(model.eq_obj1id[number]), int(model.eq_obj2id[number])}
        for number in range(model.neq)
        if int(model.eq_type[number]) == _JOINT and model.eq_obj2id[number] >= 0
    ]
    while grown := [pair for pair in pairs if pair & found and not pair <= found]:
        found.update(*grown)
    return found - joints


def read_texts(spec: mujoco.MjSpec, prefix: str) -> list[tuple[str, str]]:
    """Return the texts of a file whose names have this prefix: the rest of the name, and the data."""
    texts = ((text.name, text.data) for text in spec.texts)
    return [(name.removeprefix(prefix), data) for name, data in texts if name.startswith(prefix)]


def _words(name: str) -> list[str]:
    """Split a name into words: power, button for `PowerButton_2`."""
    return [word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name)]


def _means_switch(word: str) -> bool:
    return any(sort in word for sort in _SWITCHES) or word == _DIAL
