"""The command `keys`: certificates that identify clients and their roles."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import click

from semmap.nodes.extern.cli.command import group
from semmap.nodes.extern.cli.common import ENDPOINT, is_json, json_option, print_json, print_result
from semmap.nodes.extern.cli.output import show
from semmap.nodes.extern.cli.output.tables import table
from semmap.nodes.identity.register import Member, Register
from semmap.nodes.runtime import extras
from semmap.schemas.keys import ROUTER
from semmap.schemas.role_names import ROLES, Role

_path = click.Path(path_type=Path)
_folder = click.option(
    "--dir", "folder", type=_path, default=Path("keys"), show_default=True, help="Folder of the certificates."
)
_days = click.option(
    "--days",
    type=click.IntRange(1, 3650),
    default=365,
    show_default=True,
    help="Validity of the certificate.",
)
_host = click.option(
    "--host",
    "hosts",
    multiple=True,
    metavar="HOST",
    help="Additional host name or address of the router; may be repeated.",
)


@group(example="semmap keys init keys --host robot1.local")
def keys() -> None:
    """Create, renew and revoke certificates of a secure system."""
    extras.require("semmap keys", "keys")


@keys.command(example="semmap keys init keys --host robot1.local")
@click.argument("folder", type=_path, default=Path("keys"))
@_host
@_days
@json_option
def init(folder: Path, hosts: tuple[str, ...], days: int) -> None:
    """Create a certificate authority in FOLDER.

    The certificates of the nodes and the router are created as well.
    """
    from semmap.nodes.identity import authority

    register = authority.init(folder, hosts, days)
    lines = (
        f"created a certificate authority in {folder} for a router at {', '.join(register.hosts)}",
        f"keep {folder / 'ca.key'} secret: its holder can issue any identity",
        f"create your certificate: semmap keys add NAME --role operator --dir {folder}",
        f"start the system:        semmap up --secure {folder}",
    )
    print_result(register, lambda _: lines)


@keys.command(example="semmap keys add ann --role operator")
@click.argument("name")
@click.option("--role", type=click.Choice(ROLES), required=True, help="Permissions of NAME.")
@_folder
@_days
@json_option
def add(name: str, role: Role, folder: Path, days: int) -> None:
    """Create a certificate for NAME.

    A running system accepts it within a second.
    """
    from semmap.nodes.identity import authority

    made = authority.add(folder, name, role, days)
    _print_member("created", folder, made, f"to use it: semmap status --identity {folder / name}")


@keys.command(example="semmap keys renew ann --days 365")
@click.argument("name")
@click.option("--role", type=click.Choice(ROLES), help="New permissions of NAME. Default: unchanged.")
@_host
@_folder
@_days
@json_option
def renew(name: str, role: Role | None, hosts: tuple[str, ...], folder: Path, days: int) -> None:
    """Create a new key and certificate for NAME.

    The previous certificate stays valid until it expires.
    """
    from semmap.nodes.identity import authority

    _print_member("renewed", folder, authority.renew(folder, name, hosts, days, role))


@keys.command(example="semmap keys revoke ann")
@click.argument("name")
@_folder
@json_option
def revoke(name: str, folder: Path) -> None:
    """Revoke the certificates of NAME.

    A running system closes its connections within a second.
    """
    from semmap.nodes.identity import authority

    member = authority.revoke(folder, name)
    text = f"revoked {member.name} ({member.role}); this name cannot be reused"
    print_result(member, lambda _: [text])


@keys.command("list", example="semmap keys list --dir keys")
@_folder
@json_option
def list_(folder: Path) -> None:
    """List the certificates with their roles and expiry dates."""
    members = tuple(Register.read(folder).members.values())
    if is_json():
        print_json(members)
        return
    rows = table("name", "role", "valid until", "state", fold=())
    for member in members:
        expired = member.expires < datetime.now(UTC)
        state = "revoked" if member.revoked else "expired" if expired else "admitted"
        rows.add(member.name, member.role, f"{member.expires:%Y-%m-%d}", state)
    show.console().print(rows)


@keys.command(example="semmap keys zenohd --listen tls/0.0.0.0:7447")
@_folder
@click.option(
    "--listen",
    type=ENDPOINT,
    default="tls/0.0.0.0:7447",
    show_default=True,
    metavar="EP",
    help="Zenoh endpoint that the router listens on.",
)
@click.option(
    "--connect",
    type=ENDPOINT,
    multiple=True,
    metavar="EP",
    help="Another router to connect to; may be repeated.",
)
@click.option(
    "--namespace", default="", metavar="ROBOT", help="Robot whose Zenoh keys are routed; * for all."
)
def zenohd(folder: Path, listen: str, connect: tuple[str, ...], namespace: str) -> None:
    """Print a zenohd configuration for a secure system.

    It contains the access rules for all current certificates. Print it again after each change.
    """
    from semmap.nodes import bus
    from semmap.nodes.identity import Identity
    from semmap.nodes.router.access import access_control

    register = Register.read(folder)
    for endpoint in (listen, *connect):
        bus.require_tls(endpoint)
    network = bus.Network(
        mode="router",
        listen=(listen,),
        connect=connect,
        identity=Identity.read(folder / ROUTER),
        access=access_control(register.admitted, namespace),
    )
    click.echo(network.as_file())


def _print_member(action: str, folder: Path, member: Member, *more: str) -> None:
    files = f"{folder / member.name}.crt and .key"
    line = f"{action} {files}: {member.name}, {member.role}, until {member.expires:%Y-%m-%d}"
    print_result(member, lambda _: [line, *more])
