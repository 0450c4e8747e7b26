"""The settings that a map was last run with."""

import click
import pytest
from click.testing import CliRunner
from msgspec import structs

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.extern.cli.system_options import settings_options
from semmap.nodes.extern.cli.system_settings import _settings_before
from semmap.nodes.sim_node.robots.robot import SHIPPED
from semmap.nodes.supervisor.settings import JOURNAL, SETTINGS, Settings
from semmap.ontology import EMPTY_WORLD, FLAT_TTL, FLAT_WORLD, HOUSEHOLD_TTL
from semmap.schemas import codec


@pytest.fixture
def data(tmp_path):
    """A folder with a map that was last run as a perceived one, in the empty world."""
    settings = Settings(data=str(tmp_path), tbox="/t", abox=None, world=str(EMPTY_WORLD), truth="perceived")
    (tmp_path / SETTINGS).write_bytes(codec.encode_json(settings))
    (tmp_path / JOURNAL).touch()
    return tmp_path


def test_a_map_goes_on_as_it_was_run(data, capsys):
    before = _settings_before(data)
    assert (before.truth, before.world) == ("perceived", str(EMPTY_WORLD))
    (data / JOURNAL).unlink()
    assert _settings_before(data) is None
    assert capsys.readouterr().err == ""


def test_settings_that_are_lost_are_reported(data, capsys):
    (data / SETTINGS).write_text("{")
    assert _settings_before(data) is None
    assert "--truth and --world are reset to their defaults" in capsys.readouterr().err


def test_a_shipped_world_of_another_installation_is_the_shipped_world_of_this_one(data, capsys):
    text = (data / SETTINGS).read_text()
    (data / SETTINGS).write_text(text.replace(str(EMPTY_WORLD), f"/old/ontology/{EMPTY_WORLD.name}"))
    assert _settings_before(data).world == str(EMPTY_WORLD)
    assert capsys.readouterr().err == ""


def test_a_world_that_is_gone_is_reported_and_the_truth_stays(data, capsys):
    text = (data / SETTINGS).read_text()
    (data / SETTINGS).write_text(text.replace(str(EMPTY_WORLD), "/nowhere/world.xml"))
    before = _settings_before(data)
    assert (before.truth, before.world) == ("perceived", str(FLAT_WORLD))
    assert "the world /nowhere/world.xml no longer exists" in capsys.readouterr().err


def test_another_abox_does_not_count_for_a_map_that_goes_on(data):
    @click.command()
    @settings_options
    def tell(settings: Settings):
        click.echo(f"{settings.truth} {settings.world}")

    goes_on = CliRunner().invoke(tell, ["--data", str(data), "--abox", "none"])
    assert goes_on.stdout == f"perceived {EMPTY_WORLD}\n"
    assert "--abox is ignored" in goes_on.stderr
    goes_on = CliRunner().invoke(tell, ["--data", str(data), "--tbox", "household"])
    assert "--tbox is ignored" in goes_on.stderr
    assert "semmap load --tbox FILE" in goes_on.stderr
    fresh = CliRunner().invoke(tell, ["--data", str(data), "--abox", "none", "--fresh"])
    assert (fresh.stdout, fresh.stderr) == (f"map {EMPTY_WORLD}\n", "")


def test_a_part_whose_map_is_elsewhere_remembers_its_world(data):
    (data / JOURNAL).unlink()
    settings = codec.decode((data / SETTINGS).read_bytes(), Settings)
    (data / SETTINGS).write_bytes(codec.encode_json(structs.replace(settings, only=("sim_node",))))
    assert _settings_before(data).world == str(EMPTY_WORLD)
    (data / SETTINGS).write_bytes(codec.encode_json(structs.replace(settings, only=("kb_node",))))
    assert _settings_before(data) is None


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["up", "--only", "brain"],
            "--only: unknown node 'brain'; use a comma-separated list of kb, coordinator, sim,",
        ),
        (["up", "--only", ","], "--only requires names of nodes: "),
        (["up", "--only", "sim", "--no-sim"], "--only and --no-sim exclude each other"),
        (["up", "--only", "sim", "--perception"], "remove --perception"),
        (["node", "sim_node", "--only", "sim"], "--only applies to semmap up"),
        (["up", "--mask-robot", "porter"], "--mask-robot requires --perception"),
        (["up", "--perception", "--mask-robot", "r1=no.urdf"], "there is no file no.urdf; included robots: "),
        (["up", "--perception", "--mask-robot", "=porter"], "--mask-robot: '' is not a name"),
    ],
)
def test_what_only_and_mask_robot_cannot_mean_is_refused(tmp_path, capsys, words, said):
    assert execute([*words, "--data", str(tmp_path / "d")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "d").exists()


@pytest.mark.parametrize(
    ("words", "abox", "world"),
    [
        (["--tbox", "household", "--tbox", "my.ttl"], FLAT_TTL, FLAT_WORLD),
        (["--tbox", "household"], FLAT_TTL, FLAT_WORLD),
        (["--tbox", "household", "--abox", "none"], None, EMPTY_WORLD),
        (["--tbox", "my.ttl"], None, EMPTY_WORLD),
    ],
)
def test_the_flat_is_the_map_of_the_household_tbox(tmp_path, monkeypatch, words, abox, world):
    @click.command()
    @settings_options
    def show(settings: Settings):
        files = [str(path) for path in settings.tboxes]
        click.echo(f"{settings.abox} {settings.world} {files}")

    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.ttl").touch()
    files = [str(HOUSEHOLD_TTL if word == "household" else tmp_path / word) for word in words[1:4:2]]
    if "--abox" in words:
        files = files[:1]
    shown = CliRunner().invoke(show, ["--data", str(tmp_path / "data"), *words])
    assert shown.stdout == f"{abox} {world} {files}\n"


@pytest.mark.parametrize(("word", "name"), [("porter", "cart"), ("arm1=porter", "arm1")])
def test_a_robot_to_mask_is_that_of_the_world_unless_it_is_named(tmp_path, word, name):
    @click.command()
    @settings_options
    def show(settings: Settings):
        click.echo(f"{settings.mask_robot_name} {settings.mask_robot}")

    words = ["--perception", "--truth", "perceived", "--robot-name", "cart", "--mask-robot", word]
    shown = CliRunner().invoke(show, ["--data", str(tmp_path), *words])
    assert shown.stdout == f"{name} {SHIPPED['porter']}\n"
