"""Keys, messages and their encoding, for programs that use Zenoh directly.

A camera publishes raw planes at `camera_key(name, plane)`, each with an encoded `CameraFrame` as its
attachment:

    publisher = session.declare_publisher(camera_key("front", "depth"))
    publisher.put(depth_m.tobytes(), attachment=encode(CameraFrame(camera="front", encoding="depth32f", ...)))
"""

from semmap.schemas.codec import decode, encode
from semmap.schemas.health import Health
from semmap.schemas.keys import (
    ACK,
    COMMIT,
    ENTITY,
    HEALTH,
    MASKS,
    OBSERVATIONS,
    POSES,
    Topic,
    camera_key,
    entity_key,
)
from semmap.schemas.perception import CameraView, DetectedMasks, MaskImage, MaskRun, Observation, Observations
from semmap.schemas.replies import Ack
from semmap.schemas.scenes import CameraFrame, Poses

__all__ = [
    "ACK",
    "COMMIT",
    "ENTITY",
    "HEALTH",
    "MASKS",
    "OBSERVATIONS",
    "POSES",
    "Ack",
    "CameraFrame",
    "CameraView",
    "DetectedMasks",
    "Health",
    "MaskImage",
    "MaskRun",
    "Observation",
    "Observations",
    "Poses",
    "Topic",
    "camera_key",
    "decode",
    "encode",
    "entity_key",
]
