"""Which joints of an MJCF file open something and which switch it, and at which end that is shut or off."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

import mujoco

CLOSED_TEXT: Final = "semmap-closed:"
OFF_TEXT: Final = "semmap-off:"
"""`<text name="semmap-off:JOINT" data="upper"/>`: it is a switch, and off at its upper limit."""
ENDS: Final = ("lower", "upper")

_SWITCHES: Final = ("switch", "knob", "button")
_DIAL: Final = "dial"
_DOOR: Final = "door"
_JOINT: Final = int(mujoco.mjtEq.mjEQ_JOINT)


class JointTexts(NamedTuple):
    """What the texts of a file say of its joints, by the joint's name: `lower` or `upper`."""

    closed: dict[str, str]
    off: dict[str, str]

    @classmethod
    def of(cls, spec: mujoco.MjSpec) -> JointTexts:
        """What its texts say; what they say of other ends is passed over."""
        return cls(
            *(
                {name: end for name, end in read_texts(spec, p) if end in ENDS}
                for p in (CLOSED_TEXT, OFF_TEXT)
            )
        )

    def closed_end(self, joint: str) -> str | None:
        """The end at which a joint is said to be shut, or off."""
        return self.off.get(joint) or self.closed.get(joint)

    def is_switch(self, model: mujoco.MjModel, joint: int) -> bool:
        """Is a joint a switch: by a text or, without one, by its name or that of the body that it moves?

        `knob_1`, `lightswitch` and `PowerButton` are; a `door_knob` is none.
        """
        name = model.joint(joint).name
        if name in self.off or name in self.closed:
            return name in self.off
        called = (name, model.body(int(model.jnt_bodyid[joint])).name)
        words = [word for text in called for word in _words(text)]
        return _DOOR not in words and any(_means_switch(word) for word in words)


def coupled_joints(model: mujoco.MjModel, joints: set[int]) -> set[int]:
    """The other joints that equality constraints tie to some of these: they stand as those do."""
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
    """The texts of a file whose names begin so: the rest of the name, and what they say."""
    texts = ((text.name, text.data) for text in spec.texts)
    return [(name.removeprefix(prefix), data) for name, data in texts if name.startswith(prefix)]


def _words(name: str) -> list[str]:
    """`PowerButton_2` is power, button."""
    return [word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name)]


def _means_switch(word: str) -> bool:
    return any(sort in word for sort in _SWITCHES) or word == _DIAL
