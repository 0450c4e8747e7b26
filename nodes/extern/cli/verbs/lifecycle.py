"""The verbs that start, stop and repair a system: `up`, `down`, `node`, `repair`."""

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
from semmap.nodes.extern.cli.calling import complain
from semmap.nodes.extern.cli.ontology_options import (
    TBoxFile,
    import_option,
    require_there,
    spatial_root_option,
)
from semmap.nodes.extern.cli.output.printable import say
from semmap.nodes.extern.files import read_label_map
from semmap.nodes.identity import SUPERVISOR
from semmap.nodes.identity.register import Register
from semmap.nodes.runtime import extras
from semmap.nodes.supervisor.parts import nodes_of
from semmap.nodes.supervisor.settings import JOURNAL, SETTINGS, Settings, default_data, is_endpoint
from semmap.ontology import EMPTY_WORLD, FLAT_TTL, FLAT_WORLD, HOUSEHOLD_TTL
from semmap.schemas import codec, errors
from semmap.schemas.endpoints import ALL_ROBOTS, CONNECT_VARIABLE, NAMESPACE_VARIABLE
from semmap.schemas.endpoints import robot_name as checked_namespace
from semmap.schemas.keys import NODES, ROUTER

_ROBOTS = Path(__file__).parents[3] / "sim_node" / "robots"
"""Where those are that come with semmap."""
_path = click.Path(path_type=Path)

_PERCEPTION_HZ = 5.0
"""Default frame rate of the simulator's cameras with --perception [Hz]."""


def settings_options(function: Callable[..., None]) -> Callable[..., None]:
    """The options of `up` and `node`; the function gets them as Settings."""

    @click.option(
        "--tbox",
        type=TBoxFile(),
        multiple=True,
        help="Ontology (file or folder), with its imports, or the word household; may be repeated. Default:"
        " household.",
    )
    @import_option
    @spatial_root_option
    @click.option(
        "--abox",
        help="ABox file, or none for an empty map. Default: the flat; none if perceived, with --tbox other"
        " than household, or with --truth scene and a --world.",
    )
    @click.option(
        "--world", help="MJCF file, JSON scene, or the word empty. Default: as before, else the flat's."
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
        help="What decides which entities exist. Default: as before, else map.",
    )
    @click.option(
        "--threshold",
        type=float,
        default=0.05,
        show_default=True,
        metavar="M",
        help="A body has moved when it is displaced by more.",
    )
    @click.option("--angle-threshold", type=float, default=5.0, show_default=True, metavar="DEG")
    @click.option(
        "--stale",
        type=float,
        default=2.0,
        show_default=True,
        metavar="SECONDS",
        help="A live pose is stale when no other follows for so long.",
    )
    @click.option(
        "--journal-every",
        type=float,
        default=0.0,
        metavar="SECONDS",
        help="Commit the poses of what is tracked and moves this often. Default: only where it stops.",
    )
    @click.option(
        "--listen",
        default=bus.DEFAULT_ENDPOINT,
        show_default=True,
        metavar="EP",
        help="Zenoh endpoint that the system listens on.",
    )
    @click.option("--connect", multiple=True, metavar="EP", help="Zenoh endpoint to join; may be repeated.")
    @click.option(
        "--only",
        metavar="NODES",
        default=None,
        help="Run only these nodes here, such as kb,coordinator; the others run on other hosts.",
    )
    @click.option(
        "--namespace",
        envvar=NAMESPACE_VARIABLE,
        show_envvar=True,
        default="",
        metavar="ROBOT",
        help="Name of this robot: its keys begin with it, so that robots can share a network.",
    )
    @click.option(
        "--secure",
        type=_path,
        default=None,
        metavar="DIR",
        help="Let in only those with a certificate of this folder of keys (see: semmap keys).",
    )
    @click.option(
        "--zenoh-config",
        type=_path,
        default=None,
        metavar="FILE",
        help="Zenoh configuration for what semmap does not set itself.",
    )
    @click.option("--insecure", is_flag=True, help="Listen beyond this machine without certificates.")
    @click.option(
        "--robot",
        metavar="FILE",
        default=None,
        help="Put a robot into the world: an MJCF file, or porter, which comes with semmap.",
    )
    @click.option("--robot-name", default="robot1", show_default=True, help="What it is called in the map.")
    @click.option(
        "--robot-at",
        nargs=3,
        type=float,
        default=None,
        metavar="X Y Z",
        help="Where a robot that the map does not know yet stands [m]; any other begins where it last stood."
        "  [default: 0 0 0]",
    )
    @click.option("--robot-yaw", type=float, default=0.0, metavar="RAD", help="How a new robot is turned.")
    @click.option("--window", is_flag=True, help="Open a window that shows the scene (needs a display).")
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
    @click.option("--camera-size", nargs=2, type=int, default=(640, 480), metavar="W H", show_default=True)
    @click.option("--camera-noise", is_flag=True, help="Add Kinect-like noise to depth images.")
    @click.option("--perception", is_flag=True, help="Update the map from camera frames.")
    @click.option(
        "--when-gone",
        type=click.Choice(["remove", "mark"]),
        default="remove",
        show_default=True,
        help="What to do with entities that perception added and no longer sees.",
    )
    @click.option(
        "--label-map",
        type=click.Path(path_type=Path),
        default=None,
        metavar="FILE.json",
        help='With a detector of your own: what its labels are called here, {"coffee mug": "Cup"}.',
    )
    @click.option("--no-sim", is_flag=True, help="Do not start the simulator.")
    @click.option("--no-record", is_flag=True, help="Do not start the recorder.")
    @click.option(
        "--record-keep",
        metavar="LIMIT",
        default=None,
        help="Delete recordings older than 12h or 7d, or beyond 500MB or 20GB. Default: keep all.",
    )
    @click.option("--web", is_flag=True, help="Start the page, too: the map in a browser.")
    @click.option(
        "--web-port",
        type=click.IntRange(0, 65_535),
        default=None,
        metavar="N",
        help="Port of the page; 0 is any free one. Default: 8080.",
    )
    @click.option("--web-as", metavar="NAME", help="With --secure: whose certificate the page acts under.")
    @functools.wraps(function)
    def with_settings(name: str | None = None, **options: Any) -> None:
        own = {} if name is None else {"name": name}
        function(settings=_settings(single=name is not None, **options), **own)

    return with_settings


@click.command()
@settings_options
def up(settings: Settings) -> None:
    """Start the system in the foreground; Ctrl-C stops it."""
    if settings.secure is not None:
        for name in (SUPERVISOR, *settings.nodes):
            settings.identity_of(name).require_valid()
    extras.require_nodes(settings.nodes, named=bool(settings.only))
    from semmap.nodes.supervisor.up import up as run_up

    if settings.truth == "perceived" and not settings.perception and not settings.only:
        complain("no perception node started; add --perception or publish your own observations")
    run_up(settings, say=say)


@click.command()
@click.option("--data", type=_path, default=None, help="Data folder of the system.")
@click.option("--connect", envvar=CONNECT_VARIABLE, metavar="EP", help="Endpoint that the system listens on.")
def down(data: Path | None, connect: str | None) -> None:
    """Stop a system that runs on this machine."""
    extras.require("semmap down", "kb")
    from semmap.nodes.supervisor import registry
    from semmap.nodes.supervisor.control import Supervisor

    if data is None and connect is not None:
        meant = {connect, bus.over_tls(connect)}
        there = [Path(s.data) for s in registry.systems() if meant & {s.listen, s.reachable}]
        if not there:
            raise errors.NoAnswer(f"no system of this user listens on {connect}")
        (data,) = there
    Supervisor((data or default_data()).resolve()).shut_down()
    click.echo("stopped")


@click.command()
@click.option("--data", type=_path, default=None, help="Data folder of the map; its system must be stopped.")
@click.option(
    "--tbox", type=TBoxFile(), default=None, help="TBox file to use if the stored one is damaged, too."
)
def repair(data: Path | None, tbox: Path | None) -> None:
    """Restore the last good commit of a damaged map.

    The damaged file is kept.
    """
    extras.require("semmap repair", "kb")
    from semmap.nodes.kb_node.storage.repair.repair import repair as repair_journal

    click.echo(repair_journal((data or default_data()).resolve(), complain, tbox=tbox))


@click.command()
@click.argument("name", type=click.Choice((*NODES, ROUTER)))
@settings_options
def node(name: str, settings: Settings) -> None:
    """Run a single node in the foreground.

    The coordinator (with --secure the router) listens on --listen; the other nodes connect to it there, or
    to the router at --connect. A router with --namespace '*' is shared by several robots.
    """
    if settings.namespace == ALL_ROBOTS and name != ROUTER:
        raise errors.BadRequest("--namespace '*' is for a router that robots share: semmap node router")
    extras.require(f"semmap node {name}", extras.OF_NODE[name])
    from semmap.nodes.supervisor.launch import run_node, seed
    from semmap.nodes.supervisor.privacy import UMASK, make_private

    os.umask(UMASK)
    make_private(Path(settings.data))
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    if name == "kb_node":
        seed(settings)
    run_node(name, settings)


def _settings(
    *, tbox: tuple[Path, ...], imports: tuple[tuple[str, Path], ...], spatial_root: tuple[str, ...],
    abox: str | None, world: str | None, data: Path | None, fresh: bool, truth: str | None,
    threshold: float, angle_threshold: float, robot: str | None, robot_name: str,
    robot_at: tuple[float, float, float] | None, robot_yaw: float, stale: float, journal_every: float,
    listen: str, connect: tuple[str, ...], window: bool, models: Path | None, camera_hz: float | None,
    camera_size: tuple[int, int], camera_noise: bool, perception: bool, when_gone: str,
    label_map: Path | None, no_sim: bool, no_record: bool, record_keep: str | None, only: str | None,
    single: bool, secure: Path | None,
    zenoh_config: Path | None, insecure: bool, namespace: str,
    web: bool, web_port: int | None, web_as: str | None,
) -> Settings:  # fmt: skip
    """Settings with absolute paths to files that exist. Raises BadFile, BadRequest."""
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
        complain(f"--abox is ignored: there is a map in {folder}; --fresh starts a new one")
    if spatial_root and (folder / JOURNAL).exists() and not fresh:
        complain(
            f"--spatial-root is ignored: there is a map in {folder}; for its TBox use:"
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
        "listen": listen if secure is None else bus.over_tls(listen),
        "connect": connect if secure is None else tuple(map(bus.over_tls, connect)),
        "only": nodes,
        "single": single,
        "window": window,
        "models": None if models is None else _folder(models),
        "camera_hz": (_PERCEPTION_HZ if perception else 0.0) if camera_hz is None else camera_hz,
        "camera_size": camera_size,
        "camera_noise": camera_noise,
        "perception": perception,
        "when_gone": when_gone,
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


def _robot_file(word: str) -> str:
    """The file of a robot, or of the one of that name that comes with semmap. Raises BadFile."""
    shipped = _ROBOTS / f"{word}.xml"
    if word.isidentifier() and shipped.is_file():
        return str(shipped)
    if not Path(word).exists():
        names = ", ".join(sorted(path.stem for path in _ROBOTS.glob("*.xml")))
        raise errors.BadFile(f"there is no file {word}; the robots that come with semmap: {names}")
    return _existing(Path(word))


def _part(only: str, *, single: bool, without: dict[str, bool]) -> tuple[str, ...]:
    """The nodes that `--only` names. Raises BadRequest where another option says which nodes run."""
    if single:
        raise errors.BadRequest("semmap node runs one node; --only is for semmap up")
    for option, is_given in without.items():
        if is_given:
            raise errors.BadRequest(f"--only names the nodes to run; leave out {option}")
    return nodes_of(only)


def _require_for_web(
    *, web: bool, port: int | None, name: str | None, secure: Path | None, single: bool
) -> None:
    """Raises BadRequest for options of the page that do not go together."""
    if not web:
        if port is not None or name is not None:
            raise errors.BadRequest(
                f"{'--web-as' if port is None else '--web-port'} is of the page: add --web"
            )
        return
    if single:
        raise errors.BadRequest("semmap node runs one node; --web is for semmap up, or use: semmap web")
    if secure is None and name is not None:
        raise errors.BadRequest("--web-as names a certificate; it goes with --secure")
    if secure is not None and name is None:
        raise errors.BadRequest(
            "say under whose certificate the page acts: --web-as NAME (to make one:"
            f" semmap keys add NAME --role operator --dir {shlex.quote(str(secure))})"
        )


def _require_protected(values: dict[str, Any], *, insecure: bool) -> None:
    """Without certificates a system listens on this machine only. Raises BadRequest, BadFile, NoAnswer."""
    listen, secure, config = values["listen"], values["secure"], values["zenoh_config"]
    if not is_endpoint(listen):
        return  # which the settings refuse
    if config is not None:
        bus.own_config.require_sound(config, secure=secure is not None)
    if secure is not None:
        if insecure:
            raise errors.BadRequest("give either --secure or --insecure")
        for endpoint in (listen, *values["connect"]):
            bus.require_tls(endpoint)
        if values["single"] and values["connect"]:
            return  # the router is elsewhere
        register = Register.read(Path(secure))
        host = bus.host_of(listen)
        if host not in ("0.0.0.0", "::", *register.hosts):
            raise errors.BadRequest(
                f"the router's certificate is for {', '.join(register.hosts)}, not for {host}; add it:"
                f" semmap keys renew router --host {host} --dir {shlex.quote(secure)}"
            )
    elif not bus.is_local(listen) and not (config is not None and bus.own_config.is_protected(config)):
        if not insecure:
            raise errors.BadRequest(
                f"without certificates everybody who reaches {listen} could read and change the map; make"
                " some (semmap keys init DIR) and add --secure DIR, or say --insecure"
            )
        complain(f"warning: everybody who reaches {listen} may read and change the map (--insecure)")


def _option_of(field: str) -> str:
    """The word of the command line that a setting comes from, if it begins a complaint: `threshold_m`."""
    name = field.removesuffix(":")
    if name not in Settings.__struct_fields__:
        return field
    option = name.removesuffix("_m").removesuffix("_s").removesuffix("_deg").replace("_", "-")
    return f"--{option}{field[len(name) :]}"


def _settings_before(data: Path) -> Settings | None:
    """What was last run in `data`, if there is a map, or it was a part whose map is on another host.

    What of it is lost is told.
    """
    has_map = (data / JOURNAL).exists()
    try:
        settings: Settings = codec.decode((data / SETTINGS).read_bytes(), Settings)
    except OSError:
        return None
    except errors.BadRequest:
        if has_map:
            complain(f"{data / SETTINGS} cannot be read; --truth and --world are reset to their defaults")
        return None
    if not has_map and (not settings.only or "kb_node" in settings.only):
        return None
    if not (world := Path(settings.world)).exists():
        shipped = {path.name: path for path in (FLAT_WORLD, EMPTY_WORLD)}
        if world.parent.name == FLAT_WORLD.parent.name and world.name in shipped:  # of another installation
            return structs.replace(settings, world=str(shipped[world.name]))
        complain(f"the world {settings.world} no longer exists; using the flat's")
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
