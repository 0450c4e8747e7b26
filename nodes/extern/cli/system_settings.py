"""The settings of a system from the options of `semmap up` and `semmap node`."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.extern.cli.common import print_error
from semmap.nodes.extern.cli.detector_options import detector_settings
from semmap.nodes.extern.cli.ontology_options import require_there
from semmap.nodes.extern.files import read_label_map
from semmap.nodes.identity.register import Register
from semmap.nodes.runtime import extras
from semmap.nodes.supervisor.parts import nodes_of
from semmap.nodes.supervisor.settings import JOURNAL, SETTINGS, Settings, default_data
from semmap.ontology import EMPTY_WORLD, FLAT_TTL, FLAT_WORLD, HOUSEHOLD_TTL
from semmap.schemas import codec, errors
from semmap.schemas.endpoints import robot_name as checked_namespace
from semmap.schemas.entities import is_name

_ROBOTS = Path(__file__).parents[2] / "sim_node" / "robots"
"""The folder of the robot models that are included in semmap."""
_PERCEPTION_HZ = 5.0
"""Default frame rate of the simulator's cameras with --perception [Hz]."""


def complete_settings(options: Mapping[str, Any], *, single: bool) -> Settings:
    """Return the settings that the options and their defaults define, with absolute paths to existing files.

    An option that is given and has the name of a setting is that setting, unless it is replaced here. Raises
    BadFile, BadRequest, NoAnswer.
    """
    fields = Settings.__struct_fields__
    given = {name: value for name, value in options.items() if name in fields and value is not None}
    folder = (options["data"] or default_data()).resolve()
    has_map = (folder / JOURNAL).exists() and not options["fresh"]
    nodes = _nodes(options, single=single)
    _require_for_web(options, single=single)
    before = None if options["fresh"] else _settings_before(folder)
    _report_ignored(options, folder, has_map=has_map)
    values = {
        **given,
        **nodes,
        **_map_and_world(options, before),
        "data": str(folder),
        "imports": {iri: str(file) for iri, file in options["imports"]},
        "robot": None if options["robot"] is None else _robot_file(options["robot"]),
        "single": single,
        "models": _folder(options["models"]),
        "camera_hz": _camera_hz(options["camera_hz"], perception=nodes["perception"]),
        "class_map": _class_map(options["class_map"], before),
        **detector_settings(
            *(options[f"detector{part}"] for part in ("", "_names", "_layout", "_score")),
            perception=nodes["perception"] or single,
        ),
        **_mask_robot(options["mask_robot"], options["robot_name"], perception=nodes["perception"] or single),
        "label_map": {} if options["label_map"] is None else read_label_map(options["label_map"]),
        **_network(options, single=single),
    }
    _require_protected(values, insecure=options["insecure"])
    try:
        return codec.convert(values, Settings)
    except errors.BadRequest as error:
        field, _, fault = error.text.removeprefix("malformed message: ").partition(" ")
        raise errors.BadRequest(f"{_option_of(field)} {fault}") from None


def _nodes(options: Mapping[str, Any], *, single: bool) -> dict[str, Any]:
    """Return the settings that select nodes."""
    if options["only"] is None:
        return {
            "only": (),
            "sim": not options["no_sim"],
            "record": not options["no_record"],
            "perception": options["perception"],
        }
    without = {
        "--no-sim": options["no_sim"],
        "--no-record": options["no_record"],
        "--perception": options["perception"],
    }
    only = _part(options["only"], single=single, without=without)
    return {
        "only": only,
        "sim": "sim_node" in only,
        "record": "recorder" in only,
        "perception": "perception_node" in only,
    }


def _report_ignored(options: Mapping[str, Any], folder: Path, *, has_map: bool) -> None:
    """Report options on stderr that apply to a new map only, where a map is continued."""
    if has_map and options["abox"] is not None:
        print_error(f"warning: --abox is ignored: {folder} has a map; add --fresh to start a new one")
    if has_map and options["tbox"]:
        print_error(
            f"warning: --tbox is ignored: {folder} has a map; to change its TBox: semmap load --tbox FILE"
        )
    if has_map and options["spatial_root"]:
        print_error(
            f"warning: --spatial-root is ignored: {folder} has a map; for its TBox use:"
            " semmap load --tbox FILE --spatial-root CLASS"
        )


def _map_and_world(options: Mapping[str, Any], before: Settings | None) -> dict[str, Any]:
    """Return the TBox, the ABox, the world and the source of truth."""
    tbox, abox, world, truth = (options[name] for name in ("tbox", "abox", "world", "truth"))
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
    return {
        "tbox": tuple(_existing(path, or_folder=True) for path in tbox or (HOUSEHOLD_TTL,)),
        "abox": None if abox == "none" else _existing(Path(abox)),
        "world": _existing(Path(world)),
        "truth": truth,
    }


def _network(options: Mapping[str, Any], *, single: bool) -> dict[str, Any]:
    """Return the settings of the connections."""
    secure, config = options["secure"], options["zenoh_config"]
    to_endpoint = (lambda endpoint: endpoint) if secure is None else bus.to_tls
    return {
        "listen": to_endpoint(options["listen"]),
        "connect": tuple(map(to_endpoint, options["connect"])),
        "secure": _folder(secure),
        "namespace": options["namespace"] if single else checked_namespace(options["namespace"]),
        "zenoh_config": None if config is None else _existing(config),
    }


def _camera_hz(given: float | None, *, perception: bool) -> float:
    """Return the frame rate of the simulated cameras [Hz]."""
    return given if given is not None else _PERCEPTION_HZ if perception else 0.0


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


def _mask_robot(word: str | None, robot: str, *, perception: bool) -> dict[str, Any]:
    """Return the settings of a robot that perception leaves out, whose model was tried.

    `robot` is the default name. Raises BadFile, BadRequest.
    """
    if word is None:
        return {}
    if not perception:
        raise errors.BadRequest("--mask-robot requires --perception, or with --only the node perception")
    extras.require("semmap up --mask-robot", "sim")
    from semmap.nodes.perception_node.input.robot_mask import RobotBody

    name, named, model = word.partition("=")
    if named and not is_name(name):
        raise errors.BadRequest(f"--mask-robot: '{name}' is not a name; use NAME=MODEL, as in robot1=porter")
    file = _robot_file(model if named else word)
    RobotBody(Path(file))
    return {"mask_robot": file, "mask_robot_name": name if named else robot}


def _part(only: str, *, single: bool, without: dict[str, bool]) -> tuple[str, ...]:
    """Return the nodes that `--only` names. Raises BadRequest if another option also selects nodes."""
    if single:
        raise errors.BadRequest("--only applies to semmap up; semmap node runs a single node")
    for option, is_set in without.items():
        if is_set:
            raise errors.BadRequest(f"--only and {option} exclude each other; remove {option}")
    return nodes_of(only)


def _require_for_web(options: Mapping[str, Any], *, single: bool) -> None:
    """Raise BadRequest for options of the page that exclude each other."""
    port, name, secure = options["web_port"], options["web_as"], options["secure"]
    if not options["web"]:
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


def _folder(path: Path | None) -> str | None:
    if path is None:
        return None
    if not path.is_dir():
        raise errors.BadFile(f"{path} is not a folder")
    return str(path.resolve())


def _existing(path: Path, *, or_folder: bool = False) -> str:
    if path.is_dir() and not or_folder:
        raise errors.BadFile(f"{path} is a directory, not a file")
    if not path.exists():
        raise errors.BadFile(f"there is no file {path}")
    return str(path.resolve())
