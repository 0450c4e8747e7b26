"""The page of a secure system acts under its own certificate's role, and shows only what that may do."""

from __future__ import annotations

import pytest

from nodes.identity import authority
from tests.conftest import running, until
from tests.page.conftest import Web


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page-secure") / "K"
    authority.init(folder)
    authority.add(folder, "vera", "viewer")
    authority.add(folder, "bob", "operator")
    return folder


def address(system):
    (line,) = [line for line in system.said if line.startswith("page ")]
    return line.split()[1]


def test_up_starts_the_page_as_a_viewer_which_shows_no_way_to_change(chromium, open_tab, folder, tmp_path):
    words = ("--no-record", "--secure", folder, "--web", "--web-port", "0", "--web-as", "vera")
    with running(tmp_path / "d", *words) as system:
        tab = open_tab(Web(address(system), system.process))
        until(lambda: "78 entities" in tab.locator(".semmap-state").inner_text(), "the map is there")
        assert tab.get_by_role("button", name="Add an entity").count() == 0
        assert tab.get_by_role("button", name="Undo the last change (u)").count() == 0


def test_a_secure_page_is_told_whom_it_acts_for(folder, tmp_path, capsys):
    from nodes.extern.cli.app import execute

    assert execute(["up", "--data", str(tmp_path), "--secure", str(folder), "--web"]) == 2
    assert "--web-as NAME" in capsys.readouterr().err
