"""The wheel: its contents, and a system that runs from it without a checkout."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from benchmarks.install import built_wheel, environment
from tests.conftest import free_endpoint

ROOT = Path(__file__).parents[1]
DATA = {
    "semmap/nodes/perception_node/recognition/recognition.npz",
    "semmap/nodes/perception_node/segmentation/segmentation.npz",
    "semmap/nodes/py.typed",
    "semmap/ontology/empty_world.xml",
    "semmap/ontology/flat.ttl",
    "semmap/ontology/flat_world.xml",
    "semmap/ontology/household.ttl",
    "semmap/ontology/py.typed",
    "semmap/schemas/py.typed",
    "semmap/schemas/scene.schema.json",
    "semmap/py.typed",
}
CLIENT = """
import sys, semmap
assert "site-packages" in semmap.__file__, semmap.__file__
with semmap.connect(sys.argv[1]) as client:
    print(client.add("Cup", "cup77", at=(8.0, 2.2, 0.76), wait="--no-sim" not in sys.argv).text)
    print(sorted(client.get("cup77").types))
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return built_wheel(tmp_path_factory.mktemp("wheel"))


def lay_traps(folder: Path) -> None:
    """Give a folder modules called like the folders of this repository, which must never be imported."""
    for name in ("nodes/__init__", "schemas", "ontology"):
        path = folder / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(f'raise ImportError("{path} was imported by semmap")\n')


@pytest.fixture(scope="module")
def files(wheel):
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_it_owns_one_name_only(files):
    assert {name.split("/")[0] for name in files if ".dist-info/" not in name} == {"semmap"}


def test_it_has_their_data(files):
    assert set(files) >= DATA


def test_it_has_every_module_but_the_trainers(files):
    for package in ("semmap", "semmap/nodes", "semmap/ontology", "semmap/schemas"):
        for path in (ROOT / package).rglob("*"):
            name = str(path.relative_to(ROOT))
            if path.is_file() and "__pycache__" not in name and not name.startswith("semmap/nodes/training/"):
                assert name in files, name
    assert not [name for name in files if name.startswith(("semmap/nodes/training", "benchmarks", "tests"))]


def test_nothing_in_it_needs_what_is_not_in_it(files):
    for name, content in files.items():
        if name.endswith(".py"):
            for missing in (b"semmap.nodes.training", b"from benchmarks", b"from tests", b"from demo"):
                assert missing not in content, name


def test_it_names_its_commands_and_codecs(files):
    (name,) = (name for name in files if name.endswith("entry_points.txt"))
    said = files[name].decode()
    assert "semmap = semmap.nodes.extern.cli.app:main" in said
    assert said.count("msgpack = semmap.nodes.extern.zenoh_codec:") == 2


def test_modules_of_a_user_with_the_names_of_our_folders_do_not_disturb_it(wheel, tmp_path):
    lay_traps(tmp_path)
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "site")
    (tmp_path / "test_ours.py").write_text("import semmap\n\ndef test_it():\n    assert semmap.Client\n")
    script = "import semmap; print(semmap.__file__, *[getattr(semmap, name) for name in semmap.__all__])"
    for words in (
        ("-c", script),
        ("-m", "semmap", "classes", "--help"),
        ("-m", "pytest", "-q", "test_ours.py"),
    ):
        said = subprocess.check_output(
            [sys.executable, *words],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
            text=True,
        )
        assert words[0] != "-c" or str(tmp_path / "site" / "semmap" / "__init__.py") in said


def test_a_client_and_a_kb_need_only_their_extras(files):
    (name,) = (name for name in files if name.endswith("METADATA"))
    required = [line for line in files[name].decode().splitlines() if line.startswith("Requires-Dist:")]
    base = {line.split()[1].split(">")[0] for line in required if "extra ==" not in line}
    assert base == {"click", "eclipse-zenoh", "msgpack", "msgspec", "platformdirs", "rich"}


def run_a_system(python: Path, folder: Path, *words: str) -> str:
    """What a client prints before `semmap up WORDS`, both from the environment of `python`."""
    lay_traps(folder)
    endpoint = free_endpoint()
    away = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    up: list[str | Path] = [
        python.with_name("semmap"),
        "up",
        "--data",
        folder / "map",
        "--listen",
        endpoint,
        *words,
    ]
    with subprocess.Popen(up, cwd=folder, env=away, stdout=subprocess.PIPE, text=True) as system:
        try:
            assert any(line.startswith("stop ") for line in system.stdout), "it did not start"
            command: list[str | Path] = [python, "-c", CLIENT, endpoint, *words]
            return subprocess.check_output(command, cwd=folder, env=away, text=True)
        finally:
            system.send_signal(signal.SIGINT)
            system.communicate(timeout=30)


@pytest.mark.long
def test_the_knowledge_base_runs_from_it_with_its_extra_alone(wheel, tmp_path):
    python = environment(tmp_path / "env", f"semmap[kb] @ {wheel.as_uri()}")
    said = run_a_system(python, tmp_path, "--no-sim", "--no-record")
    assert "added Cup cup77" in said
    assert "Dishware" in said
    refused = subprocess.run([python.with_name("semmap"), "up"], cwd=tmp_path, capture_output=True, text=True)
    assert refused.returncode == 2
    assert (
        "pip install 'semmap[sim,record]', or start without: semmap up --no-sim --no-record" in refused.stderr
    )


@pytest.mark.long
def test_all_of_it_runs_from_it_and_so_does_the_tour(wheel, tmp_path):
    python = environment(tmp_path / "env", f"semmap[all] @ {wheel.as_uri()}", "zenoh-cli")
    assert "body: present" in run_a_system(python, tmp_path)
    environ = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    tour = subprocess.run([python, "-m", "demo.tour"], cwd=ROOT, env=environ, capture_output=True, text=True)
    assert tour.returncode == 0, tour.stdout[-3000:] + tour.stderr[-1000:]
