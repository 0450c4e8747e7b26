"""All verbs of the command line. Each sends a command; only `watch` subscribes instead.

A verb's module is imported when the verb is wanted: importing them all takes longer than most answers.
"""

from __future__ import annotations

import importlib

import click

from semmap.schemas import errors

_MODULES = {
    "edit": ("add", "update", "set", "unset", "track", "remove", "clear", "load"),
    "batch": ("batch",),
    "ask": (
        *("list", "get", "check", "infer", "explain", "could", "relations", "export"),
        *("classes", "properties", "status", "sparql", "watch"),
    ),
    "frames": ("frames",),
    "words": ("find", "tell", "understand"),
    "past": ("undo", "history", "diff", "when", "last-seen"),
    "run": ("run",),
    "perceive": ("perceive",),
    "learn": ("learn", "learned", "forget"),
    "navigation": ("floorplan", "route"),
    "scene": ("move", "drive", "attach", "detach", "open", "close", "pause", "step", "reset", "picture"),
    "replay": ("replay",),
    "movie": ("movie",),
    "lifecycle": ("up", "down", "node", "repair"),
    "keep": ("backup", "restore", "compact"),
    "tbox": ("tbox",),
    "keys": ("keys",),
    "fleet": ("fleet",),
    "mcp": ("mcp",),
    "ros": ("ros", "mcap"),
    "web": ("web",),
    "approve": ("approve",),
    "completion": ("completion",),
}
"""The verbs of each module of `verbs/`."""
_MODULE_OF = {verb: module for module, verbs in _MODULES.items() for verb in verbs}


class _Group(click.Group):
    """Imports a verb when it is asked for, and names the nearest verbs when one is unknown."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(_MODULE_OF)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.commands and cmd_name in _MODULE_OF:
            module = importlib.import_module(f"semmap.nodes.extern.cli.verbs.{_MODULE_OF[cmd_name]}")
            made = [c for c in vars(module).values() if isinstance(c, click.Command) and c.name == cmd_name]
            self.add_command(made[0])
        return super().get_command(ctx, cmd_name)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and self.get_command(ctx, args[0]) is None:
            hint = errors.did_you_mean(args[0], _MODULE_OF)
            raise click.UsageError(f"unknown verb '{args[0]}'{hint or '; see: semmap --help'}")
        return super().resolve_command(ctx, args)


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="semmap")
def app() -> None:
    """A robot's semantic map: what there is, what it is called, where it stands, and what follows."""
