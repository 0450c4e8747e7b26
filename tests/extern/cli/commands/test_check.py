"""The exit status of `check`."""

from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from semmap.nodes.extern.cli.commands.query import check
from semmap.schemas.replies import Checked


@pytest.mark.parametrize(
    ("consistent", "conforms", "status"),
    [(True, True, 0), (True, False, 1), (True, None, 1), (False, None, 1)],
)
def test_only_a_map_that_conforms_has_exit_status_0(consistent, conforms, status):
    checked = Checked(
        consistent=consistent, conforms=conforms, engine="semmap", triples=1, elapsed_s=0.1, text="checked"
    )
    client = SimpleNamespace(check=lambda engine, **_: checked)
    found = CliRunner().invoke(check, [], obj=client)
    assert found.output == "checked (semmap, 1 triples, 0.100 s)\n"
    assert found.exit_code == status
