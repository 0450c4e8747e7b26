"""Runs one node in this process: `python -m semmap.nodes.supervisor.launch NODE SETTINGS`.

With `seed` instead of a node, it creates the journal and exits.
"""

from __future__ import annotations

import importlib
import logging
import os
import shlex
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from semmap.nodes.bus import FOREVER_S, RESTART_S
from semmap.nodes.runtime.memory import uncollected
from semmap.nodes.supervisor.orphans import end_when_orphaned
from semmap.nodes.supervisor.privacy import UMASK
from semmap.nodes.supervisor.settings import Settings
from semmap.ontology import EMPTY_WORLD, FLAT_START_M, FLAT_WORLD
from semmap.ontology.model_shapes import add_own
from semmap.schemas import codec, errors
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE
from semmap.schemas.keys import ROUTER, WEB

if TYPE_CHECKING:
    from semmap.nodes.sim_node.config import RobotConfig

_RECORDED = "SEMMAP_RECORDED"
"""Passed by a recorder to its successor: the last commit in its file."""


def run_node(name: str, settings: Settings) -> None:
    """Run a node until it is stopped. Raises the error that prevents its start."""
    if name not in _LAUNCHERS:
        raise errors.BadRequest(f"unknown node '{name}'; available: {', '.join(sorted(_LAUNCHERS))}")
    with uncollected(freeze=True):  # modules stay, and collections take a tenth of the time to import them
        if name == "sim_node":
            from semmap.nodes.sim_node.mujoco_import import import_mujoco

            import_mujoco()
        importlib.import_module(
            "semmap.nodes.extern.web.server" if name == WEB else f"semmap.nodes.{name}.node"
        )
    _LAUNCHERS[name](settings)


def seed(settings: Settings) -> None:
    """Create the journal, or print that it exists; first validate the world and read the models.

    Without the knowledge base there is no journal, and nothing is printed.
    """
    from semmap.nodes.kb_node.storage.existing_map import describe_existing_map

    _read_world(settings)
    if settings.reset_world:
        reset_world(settings)
    if "kb_node" not in settings.nodes:
        return
    if (replay := settings.replay) is not None:
        print(f"replay of {replay.of}, from commit {replay.since} to {replay.until}; read-only")
        return
    if not settings.fresh and (summary := describe_existing_map(Path(settings.data))) is not None:
        print(summary)
        return
    from semmap.nodes.coordinator.files.content import kind_of
    from semmap.nodes.kb_node.storage.seed import seed as seed_journal

    abox = Path(settings.abox) if settings.abox is not None else None
    if abox is not None and kind_of(abox.read_bytes(), abox.name) != "abox":
        load = f"semmap load {shlex.quote(str(abox))}"
        raise errors.BadFile(f"{abox.name} is not an ABox; start with --abox none, then: {load}")
    imports = {iri: Path(file) for iri, file in settings.imports.items()}
    summary = seed_journal(
        Path(settings.data),
        settings.tboxes,
        abox,
        imports=imports,
        spatial_root=settings.spatial_root,
        skip_unknown=settings.skip_unknown,
        tbox_from_abox=settings.tbox_from_abox,
        fresh=settings.fresh,
        enforce_shapes=settings.enforce_shapes,
    )
    print(summary)


def _read_world(settings: Settings) -> None:
    """Validate the world and the robot, and write the shapes of the models."""
    has_own_world = settings.sim and Path(settings.world) not in (FLAT_WORLD, EMPTY_WORLD)
    if settings.sim and settings.robot is not None and not has_own_world:
        from semmap.nodes.sim_node.robots.robot import read

        read(Path(settings.robot))
    if not has_own_world and settings.models is None and not _own_shapes(settings).is_file():
        return
    from semmap.nodes.runtime.isolated_process import limited
    from semmap.nodes.sim_node.models.model_reader import ModelReader
    from semmap.nodes.sim_node.models.sources import Models
    from semmap.nodes.sim_node.models.write_shapes import write_own
    from semmap.nodes.sim_node.world_file import require_world

    folder = None if settings.models is None else Path(settings.models)
    with ModelReader() as reader:
        if has_own_world:
            models = Models(folder, Path(settings.data), reader)
            with limited():
                require_world(Path(settings.world), models, robot_config(settings))
        if folder is not None or _own_shapes(settings).is_file():
            Path(settings.data).mkdir(parents=True, exist_ok=True)
            write_own(folder, _own_shapes(settings), reader)


def reset_world(settings: Settings) -> None:
    """Delete the stored scene, so that the bodies begin as in the world file."""
    from semmap.nodes.sim_node.scene_state import FILENAME

    (Path(settings.data) / FILENAME).unlink(missing_ok=True)


def _own_shapes(settings: Settings) -> Path:
    """Return the file with the shapes of the models in `--models`, for nodes that cannot read model files."""
    return Path(settings.data) / "model_shapes.json"


def _kb_node(settings: Settings) -> None:
    from semmap.nodes.kb_node.config import KbConfig, Replay
    from semmap.nodes.kb_node.node import run

    add_own(_own_shapes(settings))
    replay = settings.replay
    run(
        KbConfig(
            data=Path(settings.data),
            network=settings.network("kb_node"),
            replay=None
            if replay is None
            else Replay(replay.until, replay.speed, replay.longest_s, settings.nodes),
            enforce_shapes=settings.enforce_shapes,
        )
    )


def _coordinator(settings: Settings) -> None:
    from semmap.nodes.coordinator.config import CoordinatorConfig, LiveRules, Thresholds
    from semmap.nodes.coordinator.node import run

    add_own(_own_shapes(settings))
    thresholds = Thresholds(distance_m=settings.threshold_m, angle_rad=settings.angle_threshold_rad)
    live = LiveRules(stale_s=settings.stale_s, journal_every_s=settings.journal_every_s)
    keys = None if settings.secure is None else Path(settings.secure)
    run(CoordinatorConfig(settings.truth, thresholds, live, settings.network("coordinator"), keys))


def robot_config(settings: Settings) -> RobotConfig | None:
    """Return the configuration of the robot, if there is one."""
    from semmap.nodes.sim_node.config import RobotConfig

    if settings.robot is None:
        return None
    origin_m = FLAT_START_M if Path(settings.world) == FLAT_WORLD else (0.0, 0.0, 0.0)
    at_m = settings.robot_at or origin_m
    return RobotConfig(Path(settings.robot), settings.robot_name, at_m, settings.robot_yaw)


def _sim_node(settings: Settings) -> None:
    from semmap.nodes.sim_node.config import CameraConfig, SimConfig
    from semmap.nodes.sim_node.node import run

    width, height = settings.camera_size
    cameras = CameraConfig(
        rate_hz=settings.camera_hz, width=width, height=height, noise=settings.camera_noise, segments=True
    )
    models = Path(settings.models) if settings.models is not None else None
    network = settings.network("sim_node")
    patience_s = FOREVER_S if settings.only else RESTART_S  # another host may start later
    data = Path(settings.data)
    still = settings.replay is not None
    world, robot = Path(settings.world), robot_config(settings)
    run(
        SimConfig(
            world,
            models,
            settings.window,
            cameras,
            network,
            data,
            patience_s,
            still,
            robot,
            settings.class_map,
            settings.truth == "scene",
        )
    )


def _perception_node(settings: Settings) -> None:
    from semmap.nodes.perception_node.config import (
        DetectorConfig,
        PerceptionConfig,
        RobotMaskConfig,
        TrackingConfig,
    )
    from semmap.nodes.perception_node.exemplar_store import FILENAME
    from semmap.nodes.perception_node.node import run

    tracking = TrackingConfig(when_gone=settings.when_gone)
    lessons = Path(settings.data) / FILENAME
    detector = None
    if settings.detector is not None:
        names = None if settings.detector_names is None else Path(settings.detector_names)
        detector = DetectorConfig(
            Path(settings.detector), names, settings.detector_layout, settings.detector_score
        )
    robot = None
    if settings.mask_robot is not None:
        robot = RobotMaskConfig(settings.mask_robot_name, Path(settings.mask_robot))
    network = settings.network("perception_node")
    run(PerceptionConfig(tracking, network, settings.label_map, lessons, detector, robot))


def _recorder(settings: Settings) -> None:
    from semmap.nodes.recorder.config import RecorderConfig
    from semmap.nodes.recorder.node import run
    from semmap.nodes.recorder.retention import KEEP_ALL, Retention

    started = time.strftime("%Y-%m-%dT%H-%M-%S")
    path = Path(settings.data) / "recordings" / f"{started}.rrd"
    after = os.environ.get(_RECORDED)
    config = RecorderConfig(
        path=path,
        network=settings.network("recorder"),
        serve=settings.live_view,
        keep=KEEP_ALL if settings.record_keep is None else Retention.read(settings.record_keep),
        after=None if after is None else int(after),
        begun_ns=settings.started_ns,
    )
    if (recorded := run(config)) is not None:  # continue in another file, in the same process
        os.environ[_RECORDED] = str(recorded)
        os.execv(sys.executable, sys.orig_argv)


def _web(settings: Settings) -> None:
    from semmap.nodes.extern.web.server import WebConfig, run

    token = os.environ.get(WEB_TOKEN_VARIABLE, "")
    run(WebConfig(network=settings.network(WEB), port=settings.web_port, token=token), on_ready=_log_address)


def _log_address(address: str) -> None:
    """Print the address without its token: logs are read by more people than a terminal."""
    print(f"web: serving {address.partition('?')[0]}", flush=True)


def _router(settings: Settings) -> None:
    from semmap.nodes.router.config import RouterConfig
    from semmap.nodes.router.node import run

    keys = None if settings.secure is None else Path(settings.secure)
    run(RouterConfig(keys, settings.network(ROUTER), settings.namespace))


_LAUNCHERS: dict[str, Callable[[Settings], None]] = {
    "kb_node": _kb_node,
    ROUTER: _router,
    "coordinator": _coordinator,
    "sim_node": _sim_node,
    "perception_node": _perception_node,
    "recorder": _recorder,
    WEB: _web,
}


def main(argv: list[str]) -> int:
    """Run the node or `seed`. Returns 0 after a stop, 1 or 2 for an error that a restart would not fix."""
    name, settings_path = argv
    end_when_orphaned()
    os.umask(UMASK)
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    settings: Settings = codec.decode(Path(settings_path).read_bytes(), Settings)
    try:
        if name == "seed":
            seed(settings)
        else:
            run_node(name, settings)
    except errors.SemmapError as error:
        print(f"{name}: {error.text}", file=sys.stderr, flush=True)
        return error.exit_status
    except MemoryError:
        if name != "seed":
            raise
        print("seed: the world or the TBox needs too much memory to read; use smaller files", file=sys.stderr)
        return errors.BadFile.exit_status
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
