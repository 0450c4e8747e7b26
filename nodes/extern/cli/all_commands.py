"""All commands of the command line, in groups. Each command sends a request; only `watch` subscribes.

The module of a command is imported when it is needed: importing all modules takes longer than most replies.
"""

from __future__ import annotations

import importlib
from typing import Final

import click

from semmap.nodes.extern.cli.command import CommandGroup
from semmap.nodes.extern.cli.common import CONNECTION, before_any_command
from semmap.schemas import errors

_GROUPS: Final = {
    "Map": {
        "edit": ("add", "update", "set", "unset", "rename", "remove", "clear", "load"),
        "batch": ("batch",),
        "history": ("undo",),
        "run": ("run",),
        "approve": ("approve",),
    },
    "Query": {
        "query": (
            *("list", "get", "check", "infer", "explain", "could", "relations", "export"),
            *("classes", "properties", "rules", "sparql", "watch"),
        ),
        "language": ("find", "tell", "understand"),
        "history": ("history", "diff", "when", "trail", "last-seen"),
        "navigation": ("floorplan", "route"),
        "tbox": ("tbox",),
    },
    "Scene and simulated time": {
        "scene": ("move", "open", "close", "pause", "step", "reset", "picture"),
        "movie": ("movie",),
        "replay": ("replay",),
    },
    "Robots": {
        "scene": ("drive", "attach", "detach"),
        "edit": ("track",),
        "frames": ("frames",),
        "ros": ("ros", "mcap"),
        "fleet": ("fleet",),
    },
    "Perception": {"perceive": ("perceive",), "learn": ("learn", "learned", "forget")},
    "System": {
        "lifecycle": ("up", "down", "node", "repair"),
        "query": ("status",),
        "web": ("web",),
        "mcp": ("mcp",),
        "storage": ("backup", "restore", "compact"),
        "keys": ("keys",),
        "completion": ("completion",),
    },
}
"""The groups of `semmap --help`: the modules of `commands/` with their commands."""
_MODULE_OF: Final = {
    name: module for modules in _GROUPS.values() for module, names in modules.items() for name in names
}
_SYNONYMS: Final = {
    "delete": "remove", "rm": "remove", "del": "remove", "show": "get", "describe": "get", "ls": "list",
    "mv": "move", "stop": "down", "start": "up", "screenshot": "picture", "query": "sparql", "log": "history",
}  # fmt: skip
"""Command names of other tools, and the commands that correspond to them."""


class _Group(CommandGroup):
    """Imports commands when they are needed, lists them by group, and suggests one for an unknown command."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(_MODULE_OF)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.commands and cmd_name in _MODULE_OF:
            module = importlib.import_module(f"semmap.nodes.extern.cli.commands.{_MODULE_OF[cmd_name]}")
            made = [c for c in vars(module).values() if isinstance(c, click.Command) and c.name == cmd_name]
            self.add_command(made[0])
        return super().get_command(ctx, cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write a section for each group of commands."""
        width = max(map(len, _MODULE_OF))
        for title, modules in _GROUPS.items():
            rows = []
            for name in sorted(name for names in modules.values() for name in names):
                if (command := self.get_command(ctx, name)) is not None:
                    summary = command.get_short_help_str(formatter.width - width - 6)
                    rows.append((name.ljust(width), summary))
            with formatter.section(title):
                formatter.write_dl(rows)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and self.get_command(ctx, args[0]) is None:
            synonym = _SYNONYMS.get(args[0])
            hint = f"; did you mean {synonym}?" if synonym else errors.did_you_mean(args[0], _MODULE_OF)
            raise click.UsageError(f"unknown command '{args[0]}'{hint or '; see: semmap --help'}")
        name, command, rest = super().resolve_command(ctx, args)
        return name, command, [*_forwarded_options(ctx, command), *rest]


def _forwarded_options(ctx: click.Context, command: click.Command | None) -> list[str]:
    """Return the connection options before the command as arguments of the command.

    Raises UsageError if the command does not have such an option.
    """
    passed = {option: ctx.params[option] for option in CONNECTION if ctx.params.get(option) is not None}
    known = {parameter.name for parameter in command.params} if command is not None else set()
    words = []
    for name, value in passed.items():
        if command is not None and name not in known:
            raise click.UsageError(
                f"{CONNECTION[name]} is not an option of semmap {command.name}; see: --help"
            )
        words += [CONNECTION[name], value]
    return words


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="semmap")
@before_any_command
def app(**_: str | None) -> None:
    """Use a robot's semantic map: objects, their classes and poses, and inferred facts."""


@app.command(name="help", example="semmap help add")
@click.argument("names", nargs=-1, metavar="[COMMAND]")
@click.pass_context
def help_(ctx: click.Context, names: tuple[str, ...]) -> None:
    """Show the help page of a command, or list all commands."""
    above = ctx.find_root()
    command: click.Command = above.command
    for name in names:
        found = command.get_command(above, name) if isinstance(command, click.Group) else None
        if found is None:
            hint = errors.did_you_mean(
                name, command.list_commands(above) if isinstance(command, click.Group) else ()
            )
            raise click.UsageError(f"unknown command '{name}'{hint or '; see: semmap --help'}")
        command, above = found, click.Context(found, parent=above, info_name=name, **found.context_settings)
    click.echo(command.get_help(above))
