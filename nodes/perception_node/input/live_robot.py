"""Leaves a robot out of live frames, by the state that it publishes."""

from __future__ import annotations

import time
from collections import deque
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from semmap.nodes.perception_node.input.cloud import Cloud, Transform
from semmap.nodes.perception_node.input.robot_mask import RobotBody
from semmap.schemas import keys
from semmap.schemas.errors import BadRequest
from semmap.schemas.live import RobotState

_FRESH_NS = 100_000_000
"""Maximum difference between the stamps of a frame and of a state: an arm moves few centimetres in it."""
_KEPT = 1000
"""Number of states, which are kept until the frames of their moment are processed."""


class LiveRobot:
    """The body of one robot at its latest states. States may be added on any thread."""

    def __init__(self, name: str, model: Path) -> None:
        """Load the robot's MJCF or URDF file. Raises BadFile if it is not valid."""
        self.key = keys.robot_state_key(name)
        """The key on which its states are published."""
        self._name = name
        self._body = RobotBody(model)
        self._states: deque[tuple[int, RobotState]] = deque(maxlen=_KEPT)

    def keep(self, state: RobotState | None) -> None:
        """Add a state, or forget all after a deletion of the key."""
        if state is None:
            self._states.clear()
        else:
            self._states.append((state.stamp_ns or time.time_ns(), state))

    def remove_from(self, cloud: Cloud) -> Cloud:
        """Return a cloud without the points on the robot at the moment of the frame.

        Raises BadRequest without a state of that moment, or if it is not valid.
        """
        ages = [(abs(stamp_ns - cloud.stamp_ns), state) for stamp_ns, state in self._states.copy()]
        age_ns, state = min(ages, key=lambda row: row[0], default=(0, None))
        try:
            if state is None:
                raise BadRequest(f"nothing received on {self.key}")
            if age_ns > _FRESH_NS:
                raise BadRequest(
                    f"no state on {self.key} within {_FRESH_NS / 1e9:g} s of a frame; check stamp_ns of both"
                )
            self._body.set_state(state.joints, self._map_from_base(state))
        except BadRequest as error:
            raise BadRequest(f"{self._name} is not left out of frames: {error.text}") from None
        return self._body.remove_from(cloud, is_in_view=False)

    def _map_from_base(self, state: RobotState) -> Transform:
        try:
            pose = state.require_pose()
        except BadRequest:  # a text without numbers, which would be another note for each state
            raise BadRequest(f"{self.key} needs a unit quaternion as orientation, or a yaw") from None
        transform = np.eye(4)
        transform[:3, 3] = pose.position_m
        transform[:3, :3] = Rotation.from_quat(pose.orientation_wxyz, scalar_first=True).as_matrix()
        return transform
