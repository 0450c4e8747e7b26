"""Joint drives: move joints to target positions with limited force."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import mujoco

from semmap.nodes.sim_node.bodies import BodyIndex

STEPS_A_PUSH = 5
"""Steps between updates of the force: 10 ms."""

_HINGE, _SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_SPEED = {_HINGE: 1.5, _SLIDE: 0.5}
"""Maximum speed [rad/s, m/s]."""
_TOLERANCE = {_HINGE: 0.004, _SLIDE: 0.001}
"""Tolerance of the target [rad, m]."""
_APPROACH = 8.0
"""Near the target, the speed is the remaining distance times this factor [1/s]."""
_GRIP = 25.0
"""Gain of the speed control [1/s]."""
_SPARE = {_HINGE: 1.0, _SLIDE: 8.0}
"""Maximum force beyond weight and friction [N m, N]."""
_STABLE = 0.5
"""Maximum share of a speed error corrected per step, if the force is applied after the step."""
_STUCK_S = 0.4
"""Time without progress after which a joint counts as blocked."""


@dataclass
class _Drive:
    target: float
    left: float
    """The smallest distance so far."""
    nearer_s: float
    """The time of the smallest distance."""
    model: mujoco.MjModel | None = None
    """The model in which damping was added, with the degree of freedom and its own damping."""
    dof: int = 0
    damping: float = 0.0

    def brake(self, model: mujoco.MjModel, dof: int, gain: float) -> None:
        """Control the speed by additional damping, which MuJoCo integrates implicitly.

        An explicit force would make light joints, such as knobs, oscillate between their limits.
        """
        if self.model is not model:  # the model was recompiled
            self.model, self.dof, self.damping = model, dof, float(model.dof_damping[dof])
            model.dof_damping[dof] = self.damping + gain

    def release(self) -> None:
        """Restore the damping."""
        if self.model is not None:
            self.model.dof_damping[self.dof] = self.damping


class Drives:
    """The joints of one engine that are moving, by their names in MuJoCo."""

    def __init__(self) -> None:
        self._moving: dict[str, _Drive] = {}

    def __bool__(self) -> bool:
        """Return whether any joint is moving."""
        return bool(self._moving)

    def begin(self, targets: Mapping[str, float], time_s: float) -> None:
        """Start to move joints to these positions [rad, m]."""
        self.stop(targets)
        for name, target in targets.items():
            self._moving[name] = _Drive(target, float("inf"), time_s)

    def stop(self, names: Iterable[str]) -> None:
        """Stop moving these joints."""
        for name in names:
            if (drive := self._moving.pop(name, None)) is not None:
                drive.release()

    def rows(self, index: BodyIndex) -> list[int]:
        """Return the moving joints as rows of the index."""
        return [index.joint_row[name] for name in self._moving if name in index.joint_row]

    def push(self, model: mujoco.MjModel, data: mujoco.MjData, index: BodyIndex) -> list[int]:
        """Set the forces of the next steps; joints that arrived or are blocked are released.

        Returns the joints that arrived, as rows of the index.
        """
        done, arrived = [], []
        for name, drive in self._moving.items():
            row = index.joint_row.get(name)
            if row is None:
                done.append(name)
                continue
            joint, dof = int(index.joint[row]), int(index.joint_dof[row])
            kind = int(model.jnt_type[joint])
            remaining = drive.target - float(data.qpos[index.joint_qpos[row]])
            if abs(remaining) < drive.left - _TOLERANCE[kind]:
                drive.left, drive.nearer_s = abs(remaining), data.time
            data.qfrc_applied[dof] = 0.0
            if abs(remaining) <= _TOLERANCE[kind] or data.time - drive.nearer_s > _STUCK_S:
                data.qvel[dof] = 0.0
                if abs(remaining) <= _TOLERANCE[kind]:
                    data.qpos[index.joint_qpos[row]] = drive.target
                    arrived.append(row)
                done.append(name)
                continue
            speed = max(-_SPEED[kind], min(_SPEED[kind], _APPROACH * remaining))
            wanted = float(model.dof_M0[dof]) * _GRIP * (speed - float(data.qvel[dof]))
            friction = float(model.dof_frictionloss[dof]) * (1.0 if remaining > 0.0 else -1.0)
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
    """Return whether MuJoCo integrates damping implicitly in this world."""
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER:
        return not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    return bool(model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4)
