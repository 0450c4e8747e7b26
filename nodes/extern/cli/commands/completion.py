"""The command `completion`."""

from __future__ import annotations

import click

from semmap.nodes.extern.cli import shell_completion
from semmap.nodes.extern.cli.command import command


@command(example="semmap completion bash")
@click.argument("shell", type=click.Choice(shell_completion.SHELLS))
def completion(shell: str) -> None:
    r"""Print the completion script for a shell.

    It completes commands, options, files, and the names of entities and classes.

    \b
    bash:  eval "$(semmap completion bash)"      (in ~/.bashrc)
    zsh:   eval "$(semmap completion zsh)"       (in ~/.zshrc)
    fish:  semmap completion fish | source       (in ~/.config/fish/config.fish)
    """
    click.echo(shell_completion.script(click.get_current_context().find_root().command, shell))
