"""Sleeping bodies. MuJoCo's unit of sleep is the kinematic tree: here, one free body.

`tree_asleep` counts up to -1 while a tree comes to rest, and then holds the next tree of its sleeping island.
`tree_awake` is the result of the last step; setting it for a sleeping tree wakes its island.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.bodies import Ints

_AWAKE = -(1 + mujoco.mjMINAWAKE)
_READY = -1


def all_asleep(data: mujoco.MjData) -> bool:
    """Return whether every tree sleeps and none is about to wake."""
    if (data.tree_asleep < 0).any() or data.tree_awake.any():
        return False
    return not (data.xfrc_applied.any() or data.qvel.any())


def awake(data: mujoco.MjData) -> int:
    """Return the number of trees that are awake, or about to wake."""
    return int(np.count_nonzero((data.tree_asleep < 0) | (data.tree_awake > 0)))


def sleeping(data: mujoco.MjData, tree: Ints) -> NDArray[np.bool_]:
    """Return (N,) which of these trees sleep; -1 is a static body, which never wakes."""
    return _where(data, tree, data.tree_asleep >= 0)


def asleep_or_ready(data: mujoco.MjData, tree: Ints) -> NDArray[np.bool_]:
    """Return (N,) which of these trees stay asleep, or are about to sleep."""
    asleep = data.tree_asleep
    return _where(data, tree, (asleep == _READY) | ((asleep >= 0) & (data.tree_awake == 0)))


def _where(data: mujoco.MjData, tree: Ints, condition: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return np.append(condition, True)[tree]  # the last value is for bodies without a tree


def wake(data: mujoco.MjData, tree: int) -> None:
    """Wake a tree; the next step wakes its island."""
    if tree >= 0 and data.tree_asleep[tree] < 0:
        data.tree_asleep[tree] = _AWAKE
    elif tree >= 0:
        data.tree_awake[tree] = 1


def let_sleep(data: mujoco.MjData, trees: Ints) -> None:
    """Let trees sleep after the next step, if they are awake only because the model was recompiled."""
    data.tree_asleep[trees[trees >= 0]] = _READY
