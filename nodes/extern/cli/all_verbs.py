"""All verbs of the command line. Each sends a command; only `watch` subscribes instead."""

from __future__ import annotations

import click

from nodes.extern.cli.verbs import ask, completion, edit, lifecycle, past, perceive, run, scene, tbox
from schemas import errors

_VERBS = (
    *(edit.add, edit.update, edit.set_, edit.unset, edit.remove, edit.clear, edit.load, past.undo, run.run),
    *(
        ask.list_,
        ask.get,
        ask.check,
        ask.infer,
        ask.explain,
        ask.could,
        ask.relations,
        ask.export,
        ask.classes,
        ask.properties,
        ask.status,
    ),
    *(ask.sparql, ask.watch, past.history, past.last_seen),
    perceive.perceive,
    *(scene.move, scene.pause, scene.step, scene.reset, scene.picture, scene.replay),
    *(lifecycle.up, lifecycle.down, lifecycle.node, lifecycle.repair, tbox.tbox, completion.completion),
)


class _Group(click.Group):
    """Names the nearest verbs when one is unknown."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and self.get_command(ctx, args[0]) is None:
            hint = errors.did_you_mean(args[0], self.commands)
            raise click.UsageError(f"unknown verb '{args[0]}'{hint or '; see: semmap --help'}")
        return super().resolve_command(ctx, args)


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="semmap")
def app() -> None:
    """A robot's semantic map: what there is, what it is called, where it stands, and what follows."""


for verb in _VERBS:
    app.add_command(verb)
