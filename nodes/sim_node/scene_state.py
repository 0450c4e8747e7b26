"""The last state of a scene that is the source of truth: where its bodies, joints and switches stood."""

from __future__ import annotations

import hashlib
import logging
import time
from contextlib import suppress
from pathlib import Path
from typing import Final

from msgspec import Struct

from semmap.nodes.sim_node.bodies import StoredBody
from semmap.nodes.sim_node.world import World
from semmap.schemas import codec, errors
from semmap.schemas.entities import Pose, angle_rad, distance_m
from semmap.schemas.scenes import Poses
from semmap.schemas.wording import few

log = logging.getLogger(__name__)

FILENAME: Final = "journal.sqlite.scene"
"""Beside the journal, with which it is archived if a new map is started."""
_INTERVAL_S: Final = 1.0
"""Between two writes while bodies move. When one comes to rest, it is written immediately."""
_SAME: Final = 1e-4
"""A smaller difference of poses [m, rad] is not a change of the world file."""


class StoredScene(Struct, frozen=True, forbid_unknown_fields=True):
    """The state of the bodies of a world file, with its path and the digest of its content.

    `begins` has the poses of the bodies in the world file.
    """

    world: str
    digest: str
    begins: dict[str, Pose]
    bodies: dict[str, StoredBody]


class SceneStore:
    """Restores the state of a world from a file, and writes it whenever bodies have moved."""

    def __init__(self, file: Path, world: World, path: Path) -> None:
        """`path` is the world file, from which `world` has just been opened."""
        self._file, self._world, self._path = file, world, path
        self._digest = hashlib.sha256(path.read_bytes()).hexdigest()
        self._begins = {body.name: body.pose for body in world.scene().bodies}
        self._written: tuple[object, ...] = ()
        self._written_s = 0.0

    def restore(self) -> tuple[str, ...]:
        """Put the bodies where they last stood, and return notes about those that begin as in the world file.

        A body whose pose in the world file has changed begins there.
        """
        name = self._path.name
        try:
            stored: StoredScene = codec.decode(self._file.read_bytes(), StoredScene)
        except FileNotFoundError:
            return ()
        except (OSError, errors.BadRequest) as error:
            log.warning("%s: %s", self._file, error)
            return (f"{self._file.name} cannot be read, so {name} begins as in its file",)
        if stored.world != str(self._path):
            return (f"another world than before ({Path(stored.world).name}); {name} begins as in its file",)
        kept = {
            body: state
            for body, state in stored.bodies.items()
            if body in self._begins and _are_equal(stored.begins[body], self._begins[body])
        }
        self._world.restore(kept)
        if stored.digest == self._digest:
            return ()
        changed = sorted(self._begins.keys() - kept)
        begins = "begins" if len(changed) == 1 else "begin"
        begin = f"{few(changed, 5)} {begins} as in the file; the others" if changed else "all bodies"
        return (f"{name} has changed: {begin} stand where they last stood; to reset all: --reset-world",)

    def update(self, poses: Poses) -> None:
        """Write the state if a body has come to rest or was attached, or some time after others moved."""
        state = (poses.version, poses.resting, poses.commits, poses.joint_commits)
        now_s = time.monotonic()
        if state == self._written and (self._world.asleep or now_s - self._written_s < _INTERVAL_S):
            return
        self.write()
        self._written, self._written_s = state, now_s

    def write(self) -> None:
        """Write the state of the bodies."""
        bodies = self._world.stored_bodies(self._begins)
        stored = StoredScene(str(self._path), self._digest, self._begins, bodies)
        beside = self._file.with_name(f"{self._file.name}.partly")
        try:
            beside.write_bytes(codec.encode(stored))
            beside.replace(self._file)
        except OSError as error:
            log.warning("%s cannot be written: %s", self._file, error.strerror)
            with suppress(OSError):
                beside.unlink()


def _are_equal(one: Pose, other: Pose) -> bool:
    return max(distance_m(one, other), angle_rad(one, other)) <= _SAME
