"""Drives: joints on their way to where somebody wants them, pushed with bounded force."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import mujoco

from semmap.nodes.sim_node.bodies import BodyIndex

STEPS_A_PUSH = 5
"""So often is the force of a drive worked out anew: every 10 ms."""

_HINGE, _SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_SPEED = {_HINGE: 1.5, _SLIDE: 0.5}
"""At most so fast [rad/s, m/s]."""
_THERE = {_HINGE: 0.004, _SLIDE: 0.001}
"""Near enough [rad, m]."""
_APPROACH = 8.0
"""Near its end it slows down to this many times the rest of the way, each second."""
_GRIP = 25.0
"""How quickly it takes up speed [1/s]."""
_SPARE = {_HINGE: 1.0, _SLIDE: 8.0}
"""What it can push beyond its own weight and friction [N m, N]."""
_STABLE = 0.5
"""Where a force comes after the step, it takes up so much of a speed that differs at most."""
_STUCK_S = 0.4
"""Who has not come any nearer for so long is stopped by something."""


@dataclass
class _Drive:
    target: float
    left: float
    """How far it was at the nearest."""
    nearer_s: float
    """When that was."""
    model: mujoco.MjModel | None = None
    """In which it is braked, at this degree of freedom, that has this much damping by itself."""
    dof: int = 0
    damping: float = 0.0

    def brake(self, model: mujoco.MjModel, dof: int, gain: float) -> None:
        """Hold its speed by as much more damping: MuJoCo works that out within the step.

        A force that is worked out after it throws what is light, like a knob, from end to end.
        """
        if self.model is not model:  # it was compiled anew
            self.model, self.dof, self.damping = model, dof, float(model.dof_damping[dof])
            model.dof_damping[dof] = self.damping + gain

    def release(self) -> None:
        """Leave its damping as it was."""
        if self.model is not None:
            self.model.dof_damping[self.dof] = self.damping


class Drives:
    """The joints of one engine that are being moved, by their names in MuJoCo."""

    def __init__(self) -> None:
        self._under_way: dict[str, _Drive] = {}

    def __bool__(self) -> bool:
        """Whether anything is under way."""
        return bool(self._under_way)

    def begin(self, targets: Mapping[str, float], time_s: float) -> None:
        """Drive joints to these positions [rad, m], from now on."""
        self.stop(targets)
        for name, target in targets.items():
            self._under_way[name] = _Drive(target, float("inf"), time_s)

    def stop(self, names: Iterable[str]) -> None:
        """Let go of these."""
        for name in names:
            if (drive := self._under_way.pop(name, None)) is not None:
                drive.release()

    def rows(self, index: BodyIndex) -> list[int]:
        """The joints that are under way, as rows of the index."""
        return [index.joint_row[name] for name in self._under_way if name in index.joint_row]

    def push(self, model: mujoco.MjModel, data: mujoco.MjData, index: BodyIndex) -> list[int]:
        """Set the forces for the next steps; what has arrived, or is stuck, is let go of.

        Gives those that have arrived, as rows of the index: they stand still.
        """
        done, arrived = [], []
        for name, drive in self._under_way.items():
            row = index.joint_row.get(name)
            if row is None:
                done.append(name)
                continue
            joint, dof = int(index.joint[row]), int(index.joint_dof[row])
            kind = int(model.jnt_type[joint])
            way = drive.target - float(data.qpos[index.joint_qpos[row]])
            if abs(way) < drive.left - _THERE[kind]:
                drive.left, drive.nearer_s = abs(way), data.time
            data.qfrc_applied[dof] = 0.0
            if abs(way) <= _THERE[kind] or data.time - drive.nearer_s > _STUCK_S:
                data.qvel[dof] = 0.0
                if abs(way) <= _THERE[kind]:
                    data.qpos[index.joint_qpos[row]] = drive.target
                    arrived.append(row)
                done.append(name)
                continue
            speed = max(-_SPEED[kind], min(_SPEED[kind], _APPROACH * way))
            wanted = float(model.dof_M0[dof]) * _GRIP * (speed - float(data.qvel[dof]))
            friction = float(model.dof_frictionloss[dof]) * (1.0 if way > 0.0 else -1.0)
            most = float(model.dof_M0[dof]) * _GRIP * _SPEED[kind] + _SPARE[kind]
            gain = _SPARE[kind] / _SPEED[kind]
            if _damps_within_the_step(model):
                drive.brake(model, dof, gain)
                push = max(-most, min(most, wanted + gain * speed))
            else:
                gain = min(gain, _STABLE * float(model.dof_M0[dof]) / (STEPS_A_PUSH * model.opt.timestep))
                push = max(-most, min(most, wanted + gain * (speed - float(data.qvel[dof]))))
            own = float(data.qfrc_bias[dof] - data.qfrc_gravcomp[dof] - data.qfrc_spring[dof])
            data.qfrc_applied[dof] = push + friction + own
        self.stop(done)
        return arrived


def _damps_within_the_step(model: mujoco.MjModel) -> bool:
    """Is damping stable in this world, however light a joint is?"""
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER:
        return not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    return bool(model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4)
