"""The commands that start, stop and repair a system: `up`, `down`, `node`, `repair`."""

from __future__ import annotations

import logging
import os
from pathlib import Path

import click

from semmap.nodes import bus
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import ENDPOINT, json_option, print_error, print_result
from semmap.nodes.extern.cli.ontology_options import TBoxFile
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.system_options import settings_options
from semmap.nodes.identity import SUPERVISOR
from semmap.nodes.runtime import extras
from semmap.nodes.supervisor.settings import Settings, default_data
from semmap.schemas import errors
from semmap.schemas.endpoints import ALL_ROBOTS, CONNECT_VARIABLE
from semmap.schemas.keys import NODES, ROUTER

_path = click.Path(path_type=Path)


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
