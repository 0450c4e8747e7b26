"""The commands that start, stop and repair a system: `up`, `down`, `node`, `repair`."""

from __future__ import annotations

import functools
import logging
import os
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.extern.cli.angles import ANGLE
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import ENDPOINT, json_option, print_error, print_result
from semmap.nodes.extern.cli.detector_options import detector_options, detector_settings
from semmap.nodes.extern.cli.ontology_options import (
    TBoxFile,
    import_option,
    require_there,
    spatial_root_option,
)
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.files import read_label_map
from semmap.nodes.identity import SUPERVISOR
from semmap.nodes.identity.register import Register
from semmap.nodes.runtime import extras
from semmap.nodes.supervisor.parts import nodes_of
from semmap.nodes.supervisor.settings import JOURNAL, SETTINGS, Settings, default_data
from semmap.ontology import EMPTY_WORLD, FLAT_TTL, FLAT_WORLD, HOUSEHOLD_TTL
from semmap.schemas import codec, errors
from semmap.schemas.endpoints import ALL_ROBOTS, CONNECT_VARIABLE, NAMESPACE_VARIABLE
from semmap.schemas.endpoints import robot_name as checked_namespace
from semmap.schemas.keys import NODES, ROUTER

_ROBOTS = Path(__file__).parents[3] / "sim_node" / "robots"
"""The folder of the robot models that are included in semmap."""
_path = click.Path(path_type=Path)

_PERCEPTION_HZ = 5.0
"""Default frame rate of the simulator's cameras with --perception [Hz]."""


def settings_options(function: Callable[..., None]) -> Callable[..., None]:
    """Add the options of `up` and `node`, which the function receives as Settings."""

    @click.option(
        "--tbox",
        type=TBoxFile(),
        multiple=True,
        help="Ontology (file or folder) with its imports, or the word household; may be repeated."
        " Default: household.",
    )
    @import_option
    @spatial_root_option
    @click.option(
        "--abox",
        help="ABox file, or none for an empty map. Default: the flat; none with --tbox other than household,"
        " --truth perceived, or --truth scene with --world.",
    )
    @click.option(
        "--skip-unknown", is_flag=True, help="Skip individuals of the ABox file of unknown classes."
    )
    @click.option(
        "--tbox-from-abox", is_flag=True, help="Add classes and properties of the ABox file to the TBox."
    )
    @click.option(
        "--enforce-shapes", is_flag=True, help="Reject changes that violate a SHACL shape of the TBox."
    )
    @click.option(
        "--world",
        help="MJCF file, JSON scene, or empty. Default: the previous world, or the world of the flat.",
    )
    @click.option(
        "--data",
        type=_path,
        default=None,
        help="Folder for the journal, logs and recordings. Default: your user data folder.",
    )
    @click.option("--fresh", is_flag=True, help="Start a new map; the old one is moved to DIR/kept.")
    @click.option(
        "--truth",
        type=click.Choice(["map", "scene", "perceived"]),
        default=None,
        help="Source of truth for which entities exist. Default: the previous value, or map.",
    )
    @click.option(
        "--threshold",
        type=float,
        default=0.05,
        show_default=True,
        metavar="M",
        help="Minimum displacement of a body that updates the map.",
    )
    @click.option(
        "--angle-threshold",
        type=float,
        default=5.0,
        show_default=True,
        metavar="DEG",
        help="Minimum rotation of a body that updates the map.",
    )
    @click.option(
        "--stale",
        type=float,
        default=2.0,
        show_default=True,
        metavar="SECONDS",
        help="Timeout of live poses.",
    )
    @click.option(
        "--journal-every",
        type=float,
        default=0.0,
        metavar="SECONDS",
        help="Commit interval of tracked poses. Default: commit only when an entity stops.",
    )
    @click.option(
        "--listen",
        type=ENDPOINT,
        default=bus.DEFAULT_ENDPOINT,
        show_default=True,
        metavar="EP",
        help="Zenoh endpoint that the system listens on.",
    )
    @click.option(
        "--connect",
        type=ENDPOINT,
        multiple=True,
        metavar="EP",
        help="Zenoh endpoint to join; may be repeated.",
    )
    @click.option(
        "--only",
        metavar="NODES",
        default=None,
        help="Run only these nodes, such as kb,coordinator; the others run on other hosts.",
    )
    @click.option(
        "--namespace",
        envvar=NAMESPACE_VARIABLE,
        show_envvar=True,
        default="",
        metavar="ROBOT",
        help="Name of this robot: the prefix of its Zenoh keys, so that robots can share a network.",
    )
    @click.option(
        "--secure",
        type=_path,
        default=None,
        metavar="DIR",
        help="Require a certificate of this folder from every client (see: semmap keys).",
    )
    @click.option(
        "--zenoh-config",
        type=_path,
        default=None,
        metavar="FILE",
        help="Zenoh configuration for settings that semmap does not set.",
    )
    @click.option(
        "--insecure", is_flag=True, help="Accept connections from other hosts without certificates."
    )
    @click.option(
        "--robot",
        metavar="FILE",
        default=None,
        help="Add a robot to the world: an MJCF file, or porter, which is included in semmap.",
    )
    @click.option("--robot-name", default="robot1", show_default=True, help="Name of the robot in the map.")
    @click.option(
        "--robot-at",
        nargs=3,
        type=float,
        default=None,
        metavar="X Y Z",
        help="Position of a new robot [m]; a robot in the map starts at its last pose. Default: 0 0 0, or a"
        " free place in the flat.",
    )
    @click.option(
        "--robot-yaw",
        type=ANGLE,
        default=0.0,
        metavar="ANGLE",
        help="Yaw of a new robot: radians, or degrees as in 90deg.",
    )
    @click.option(
        "--reset-world",
        is_flag=True,
        help="With --truth scene: begin as in the world file. Default: where bodies last stood.",
    )
    @click.option("--window", is_flag=True, help="Show the scene in a window (needs a display).")
    @click.option(
        "--models",
        type=_path,
        default=None,
        help="Folder of model files that replace library models (chair.glb for chair).",
    )
    @click.option(
        "--camera-hz",
        type=float,
        default=None,
        metavar="HZ",
        help="Frame rate of the simulated cameras. Default: 0 (off), 5 with --perception.",
    )
    @click.option(
        "--camera-size",
        nargs=2,
        type=int,
        default=(640, 480),
        metavar="W H",
        show_default=True,
        help="Image size of the simulated cameras [pixel].",
    )
    @click.option("--camera-noise", is_flag=True, help="Add Kinect-like noise to depth images.")
    @click.option("--perception", is_flag=True, help="Update the map from camera frames.")
    @click.option(
        "--when-gone",
        type=click.Choice(["remove", "mark"]),
        default="remove",
        show_default=True,
        help="What to do with perceived entities that are no longer observed.",
    )
    @detector_options
    @click.option(
        "--label-map",
        type=click.Path(path_type=Path),
        default=None,
        metavar="FILE.json",
        help='Labels of a detector and their classes, as in {"coffee mug": "Cup"}.',
    )
    @click.option(
        "--class-map",
        type=click.Path(path_type=Path),
        default=None,
        metavar="FILE.json",
        help='Bodies of the world and their classes, as in {"mug_blue": "Cup"}.',
    )
    @click.option("--no-sim", is_flag=True, help="Do not start the simulator.")
    @click.option("--no-record", is_flag=True, help="Do not start the recorder.")
    @click.option(
        "--record-keep",
        metavar="LIMIT",
        default=None,
        help="Delete recordings older than 12h or 7d, or beyond 500MB or 20GB. Default: keep all.",
    )
    @click.option("--web", is_flag=True, help="Also start the page: the map in a browser.")
    @click.option(
        "--web-port",
        type=click.IntRange(0, 65_535),
        default=None,
        metavar="N",
        help="Port of the page; 0 is any free one. Default: 8080.",
    )
    @click.option("--web-as", metavar="NAME", help="With --secure: certificate that the page uses.")
    @functools.wraps(function)
    def with_settings(name: str | None = None, **options: Any) -> None:
        node_name = {} if name is None else {"name": name}
        function(settings=_settings(single=name is not None, **options), **node_name)

    return with_settings


@command(example="semmap up --data maps/flat --world scene.xml --web")
@settings_options
def up(settings: Settings) -> None:
    """Start the system in the foreground; Ctrl-C stops it."""
    if settings.secure is not None:
        for name in (SUPERVISOR, *settings.nodes):
            settings.identity_of(name).require_valid()
    extras.require_nodes(settings.nodes, named=bool(settings.only))
    from semmap.nodes.supervisor.up import up as run_up

    if settings.truth == "perceived" and not settings.perception and not settings.only:
        print_error("warning: no perception node started; add --perception or publish observations")
    run_up(settings, say=print_escaped)


@command(example="semmap down --data maps/flat")
@click.option("--data", type=_path, default=None, help="Data folder of the system.")
@click.option(
    "--connect",
    type=ENDPOINT,
    envvar=CONNECT_VARIABLE,
    metavar="EP",
    help="Endpoint that the system listens on.",
)
@json_option
def down(data: Path | None, connect: str | None) -> None:
    """Stop a system that runs on this machine."""
    extras.require("semmap down", "kb")
    from semmap.nodes.supervisor import registry
    from semmap.nodes.supervisor.control import Supervisor

    if data is None and connect is not None:
        wanted = {connect, bus.to_tls(connect)}
        found = [Path(s.data) for s in registry.systems() if wanted & {s.listen, s.reachable}]
        if not found:
            raise errors.NoAnswer(f"no system of this user listens on {connect}")
        (data,) = found
    Supervisor((data or default_data()).resolve()).shut_down()
    print_result({"text": "stopped"}, lambda reply: [reply["text"]])


@command(example="semmap repair --data maps/flat")
@click.option("--data", type=_path, default=None, help="Data folder of the map; its system must be stopped.")
@click.option("--tbox", type=TBoxFile(), default=None, help="TBox file to use if the stored TBox is damaged.")
@json_option
def repair(data: Path | None, tbox: Path | None) -> None:
    """Recover a damaged map up to its last intact commit.

    The damaged file is kept.
    """
    extras.require("semmap repair", "kb")
    from semmap.nodes.kb_node.storage.repair.repair import repair as repair_journal

    text = repair_journal((data or default_data()).resolve(), print_error, tbox=tbox)
    print_result({"text": text}, lambda reply: [reply["text"]])


@command(example="semmap node sim_node --connect tcp/192.168.1.10:7447")
@click.argument("name", type=click.Choice((*NODES, ROUTER)))
@settings_options
def node(name: str, settings: Settings) -> None:
    """Run a single node in the foreground.

    The coordinator (with --secure, the router) listens on --listen. The other nodes connect to that endpoint,
    or to the router at --connect. A router with --namespace '*' is shared by several robots.
    """
    if settings.namespace == ALL_ROBOTS and name != ROUTER:
        raise errors.BadRequest("--namespace '*' requires a shared router: semmap node router")
    extras.require(f"semmap node {name}", extras.OF_NODE[name])
    from semmap.nodes.supervisor.launch import reset_world, run_node, seed
    from semmap.nodes.supervisor.privacy import UMASK, make_private

    os.umask(UMASK)
    make_private(Path(settings.data))
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    if name == "kb_node":
        seed(settings)
    elif name == "sim_node" and settings.reset_world:
        reset_world(settings)
    run_node(name, settings)


def _settings(
    *, tbox: tuple[Path, ...], imports: tuple[tuple[str, Path], ...], spatial_root: tuple[str, ...],
    abox: str | None, skip_unknown: bool, tbox_from_abox: bool, enforce_shapes: bool, world: str | None,
    data: Path | None, fresh: bool, truth: str | None,
    threshold: float, angle_threshold: float, robot: str | None, robot_name: str,
    robot_at: tuple[float, float, float] | None, robot_yaw: float, stale: float, journal_every: float,
    listen: str, connect: tuple[str, ...], reset_world: bool, window: bool, models: Path | None,
    camera_hz: float | None,
    camera_size: tuple[int, int], camera_noise: bool, perception: bool, when_gone: str,
    detector: Path | None, detector_names: Path | None, detector_layout: str | None,
    detector_score: float | None,
    label_map: Path | None, class_map: Path | None, no_sim: bool, no_record: bool, record_keep: str | None,
    only: str | None, single: bool, secure: Path | None,
    zenoh_config: Path | None, insecure: bool, namespace: str,
    web: bool, web_port: int | None, web_as: str | None,
) -> Settings:  # fmt: skip
    """Return settings with absolute paths to existing files. Raises BadFile, BadRequest."""
    folder = (data or default_data()).resolve()
    nodes: tuple[str, ...] = ()
    if only is not None:
        without = {"--no-sim": no_sim, "--no-record": no_record, "--perception": perception}
        nodes = _part(only, single=single, without=without)
        perception, no_sim, no_record = (
            "perception_node" in nodes,
            "sim_node" not in nodes,
            "recorder" not in nodes,
        )
    _require_for_web(web=web, port=web_port, name=web_as, secure=secure, single=single)
    before = None if fresh else _settings_before(folder)
    if abox is not None and (folder / JOURNAL).exists() and not fresh:
        print_error(f"warning: --abox is ignored: {folder} has a map; add --fresh to start a new one")
    if spatial_root and (folder / JOURNAL).exists() and not fresh:
        print_error(
            f"warning: --spatial-root is ignored: {folder} has a map; for its TBox use:"
            " semmap load --tbox FILE --spatial-root CLASS"
        )
    for path in tbox:
        require_there(path)
    of_the_flat = abox is None and (not tbox or HOUSEHOLD_TTL in tbox)
    if world is None:
        world = before.world if before is not None else str(FLAT_WORLD if of_the_flat else EMPTY_WORLD)
    if truth is None:
        truth = before.truth if before is not None else "map"
    world = str(EMPTY_WORLD) if world in ("empty", "none") else world
    if abox is None:
        of_its_world = truth == "scene" and world != str(FLAT_WORLD)
        abox = "none" if truth == "perceived" or of_its_world or not of_the_flat else str(FLAT_TTL)
    values = {
        "data": str(folder),
        "tbox": tuple(_existing(path, or_folder=True) for path in tbox or (HOUSEHOLD_TTL,)),
        "imports": {iri: str(file) for iri, file in imports},
        "spatial_root": spatial_root,
        "abox": None if abox == "none" else _existing(Path(abox)),
        "skip_unknown": skip_unknown,
        "tbox_from_abox": tbox_from_abox,
        "enforce_shapes": enforce_shapes,
        "world": _existing(Path(world)),
        "truth": truth,
        "threshold_m": threshold,
        "angle_threshold_deg": angle_threshold,
        "robot": None if robot is None else _robot_file(robot),
        "robot_name": robot_name,
        "robot_at": robot_at,
        "robot_yaw": robot_yaw,
        "stale_s": stale,
        "journal_every_s": journal_every,
        "listen": listen if secure is None else bus.to_tls(listen),
        "connect": connect if secure is None else tuple(map(bus.to_tls, connect)),
        "only": nodes,
        "single": single,
        "reset_world": reset_world,
        "window": window,
        "models": None if models is None else _folder(models),
        "camera_hz": (_PERCEPTION_HZ if perception else 0.0) if camera_hz is None else camera_hz,
        "camera_size": camera_size,
        "camera_noise": camera_noise,
        "perception": perception,
        "when_gone": when_gone,
        "class_map": _class_map(class_map, before),
        **detector_settings(
            detector, detector_names, detector_layout, detector_score, perception=perception or single
        ),
        "label_map": {} if label_map is None else read_label_map(label_map),
        "sim": not no_sim,
        "record": not no_record,
        "record_keep": record_keep,
        "web": web,
        "web_port": 8080 if web_port is None else web_port,
        "web_as": web_as or "",
        "fresh": fresh,
        "secure": None if secure is None else _folder(secure),
        "namespace": namespace if single else checked_namespace(namespace),
        "zenoh_config": None if zenoh_config is None else _existing(zenoh_config),
    }
    _require_protected(values, insecure=insecure)
    try:
        return codec.convert(values, Settings)
    except errors.BadRequest as error:
        field, _, fault = error.text.removeprefix("malformed message: ").partition(" ")
        raise errors.BadRequest(f"{_option_of(field)} {fault}") from None


def _class_map(file: Path | None, before: Settings | None) -> dict[str, str]:
    """Return the classes of bodies of the world by name, by default those of the previous start."""
    if file is None:
        return {} if before is None else before.class_map
    return read_label_map(file, "bodies", "mug_blue")


def _robot_file(word: str) -> str:
    """Return the file of a robot, which is a path or the name of an included robot. Raises BadFile."""
    shipped = _ROBOTS / f"{word}.xml"
    if word.isidentifier() and shipped.is_file():
        return str(shipped)
    if not Path(word).exists():
        names = ", ".join(sorted(path.stem for path in _ROBOTS.glob("*.xml")))
        raise errors.BadFile(f"there is no file {word}; included robots: {names}")
    return _existing(Path(word))


def _part(only: str, *, single: bool, without: dict[str, bool]) -> tuple[str, ...]:
    """Return the nodes that `--only` names. Raises BadRequest if another option also selects nodes."""
    if single:
        raise errors.BadRequest("--only applies to semmap up; semmap node runs a single node")
    for option, is_set in without.items():
        if is_set:
            raise errors.BadRequest(f"--only and {option} exclude each other; remove {option}")
    return nodes_of(only)


def _require_for_web(
    *, web: bool, port: int | None, name: str | None, secure: Path | None, single: bool
) -> None:
    """Raise BadRequest for options of the page that exclude each other."""
    if not web:
        if port is not None or name is not None:
            raise errors.BadRequest(f"{'--web-as' if port is None else '--web-port'} requires --web")
        return
    if single:
        raise errors.BadRequest("--web applies to semmap up; for a single page use: semmap web")
    if secure is None and name is not None:
        raise errors.BadRequest("--web-as requires --secure")
    if secure is not None and name is None:
        raise errors.BadRequest(
            "--web with --secure requires --web-as NAME (to create a certificate:"
            f" semmap keys add NAME --role operator --dir {shlex.quote(str(secure))})"
        )


def _require_protected(values: dict[str, Any], *, insecure: bool) -> None:
    """Reject a system without certificates that other hosts can reach.

    Raises BadRequest, BadFile, NoAnswer.
    """
    listen, secure, config = values["listen"], values["secure"], values["zenoh_config"]
    if config is not None:
        bus.zenoh_config.require_sound(config, secure=secure is not None)
    if secure is not None:
        if insecure:
            raise errors.BadRequest("--secure and --insecure exclude each other; remove one of them")
        for endpoint in (listen, *values["connect"]):
            bus.require_tls(endpoint)
        if values["single"] and values["connect"]:
            return  # the router runs on another host
        register = Register.read(Path(secure))
        host = bus.host_of(listen)
        if host not in ("0.0.0.0", "::", *register.hosts):
            raise errors.BadRequest(
                f"the router's certificate is valid for {', '.join(register.hosts)}, not for {host}; add it:"
                f" semmap keys renew router --host {host} --dir {shlex.quote(secure)}"
            )
    elif not bus.is_local(listen) and not (config is not None and bus.zenoh_config.is_protected(config)):
        if not insecure:
            raise errors.BadRequest(
                f"{listen} can be reached from other hosts, which could read and change the map; create"
                " certificates (semmap keys init DIR) and add --secure DIR, or add --insecure"
            )
        print_error(f"warning: every host that reaches {listen} can read and change the map (--insecure)")


def _option_of(field: str) -> str:
    """Return the option of the setting that begins an error text: `--threshold` for `threshold_m`."""
    name = field.removesuffix(":")
    if name not in Settings.__struct_fields__:
        return field
    option = name.removesuffix("_m").removesuffix("_s").removesuffix("_deg").replace("_", "-")
    return f"--{option}{field[len(name) :]}"


def _settings_before(data: Path) -> Settings | None:
    """Return the previous settings of the data folder, if it has a map or its map is on another host.

    Settings that can no longer be used are reported on stderr.
    """
    has_map = (data / JOURNAL).exists()
    try:
        settings: Settings = codec.decode((data / SETTINGS).read_bytes(), Settings)
    except OSError:
        return None
    except errors.BadRequest:
        if has_map:
            print_error(
                f"warning: {data / SETTINGS} cannot be read; --truth and --world are reset to their defaults"
            )
        return None
    if not has_map and (not settings.only or "kb_node" in settings.only):
        return None
    if not (world := Path(settings.world)).exists():
        shipped = {path.name: path for path in (FLAT_WORLD, EMPTY_WORLD)}
        if world.parent.name == FLAT_WORLD.parent.name and world.name in shipped:  # of another installation
            return structs.replace(settings, world=str(shipped[world.name]))
        print_error(f"warning: the world {settings.world} no longer exists; using the world of the flat")
        return structs.replace(settings, world=str(FLAT_WORLD))
    return settings


def _folder(path: Path) -> str:
    if not path.is_dir():
        raise errors.BadFile(f"{path} is not a folder")
    return str(path.resolve())


def _existing(path: Path, *, or_folder: bool = False) -> str:
    if path.is_dir() and not or_folder:
        raise errors.BadFile(f"{path} is a directory, not a file")
    if not path.exists():
        raise errors.BadFile(f"there is no file {path}")
    return str(path.resolve())
