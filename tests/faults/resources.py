"""Exhausted resources: disk, memory, network; and disks that return wrong data."""

from __future__ import annotations

import contextlib
import json
import random
import resource
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import psutil

from tests.faults.flipped_bits import flip_checkpoint, flip_closure, try_flips
from tests.faults.ground import Ground, wait_for
from tests.faults.processes import all_pids_of
from tests.faults.table import Fault

_BIN = Path(sys.executable).parent
_GIVEN_OUT_S = 3.0
_CUT_S = 15.0
_SPARE_BYTES = 4 << 20
_FLIPS = 100


def disk_full(ground: Ground) -> None:
    """Commits are rejected, `status` reports it, and they continue when there is space."""
    ground.may_be_refused = "could not be written"
    pid = all_pids_of(ground.data)["kb_node"]
    largest = max(path.stat().st_size for path in ground.data.glob("journal.sqlite*"))
    refused = len(ground.load.refused)
    with _limited(pid, resource.RLIMIT_FSIZE, largest):
        wait_for(lambda: len(ground.load.refused) > refused, "commits are refused")
        wait_for(
            lambda: "accepts no commits" in ground.nodes()["kb_node"].detail,
            "the status says that it is full",
        )
        ground.observe(_GIVEN_OUT_S)
    assert all_pids_of(ground.data)["kb_node"] == pid


def no_memory(ground: Ground) -> None:
    """A request that needs too much memory gets an error, or the node is restarted."""
    ground.may_be_refused = ""
    pid = all_pids_of(ground.data)["kb_node"]
    with (
        contextlib.suppress(ProcessLookupError),
        _limited(pid, resource.RLIMIT_AS, psutil.Process(pid).memory_info().vms + _SPARE_BYTES),
    ):
        with contextlib.suppress(Exception), ground.client() as client:
            client.export("turtle")
        ground.observe(_GIVEN_OUT_S)


def read_only(ground: Ground) -> None:
    """A system with a read-only folder does not start and reports the reason; nothing is changed."""
    ground.system.stop()
    data = ground.data
    mounts = f"mount --bind {data} {data} && mount -o remount,ro,bind {data}"
    up = f"{_BIN}/semmap up --data {data} --listen {ground.endpoint}"
    words = ["unshare", "-rm", "sh", "-c", f"{mounts} && exec {up}"]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert ended.returncode in (1, 2), ended
    assert "Read-only file system" in ended.stderr, ended.stderr
    assert len(ended.stderr.splitlines()) == 1, ended.stderr
    ground.start()


def damaged_journal(ground: Ground) -> None:
    """A damaged commit: the start is rejected, and `repair` keeps all others and its effect."""
    ground.system.stop()
    with contextlib.closing(sqlite3.connect(ground.data / "journal.sqlite")) as db, db:
        (seq,) = db.execute("SELECT max(seq) / 2 FROM commits").fetchone()
        db.execute("UPDATE commits SET body = zeroblob(length(body)) WHERE seq = ?", (seq,))
    up: list[str | Path] = [_BIN / "semmap", "up", "--data", ground.data, "--listen", ground.endpoint]
    refused = subprocess.run([*up, "--no-sim", "--no-record"], capture_output=True, text=True, timeout=90)
    assert refused.returncode == 1, refused
    assert f"commit {seq} is damaged" in refused.stdout + refused.stderr, refused
    repair: list[str | Path] = [_BIN / "semmap", "repair", "--data", ground.data]
    told = subprocess.run(repair, capture_output=True, text=True, timeout=90)
    assert told.returncode == 0, told
    assert f"(commit {seq} is damaged; its changes were restored from the checkpoint" in told.stdout, told
    ground.start()


def restored_backup(ground: Ground) -> None:
    """A backup under load contains all earlier acknowledged changes, and can be restored."""
    file, other = ground.data.parent / "backup", ground.data.parent / "restored"
    before = set(ground.load.added)
    with ground.client() as client:
        client.backup(file, overwrite=True)
    restore: list[str | Path] = [_BIN / "semmap", "restore", file, "--data", other, "--replace"]
    subprocess.run(restore, check=True, capture_output=True, timeout=120)
    with contextlib.closing(sqlite3.connect(other / "journal.sqlite")) as db:
        there = {name for (name,) in db.execute("SELECT name FROM touches")}
    assert before <= there


def flipped_bits(ground: Ground) -> None:
    """A flipped bit in a checkpoint or in the cached closure has no effect on a start."""
    ground.system.stop()
    began_s, chance = time.monotonic(), random.Random(ground.data.stat().st_mtime_ns)
    with tempfile.TemporaryDirectory(dir=ground.data.parent) as folder:
        try_flips(ground.data, Path(folder), _FLIPS, chance)
    ground.observed_s += time.monotonic() - began_s
    flip_checkpoint(ground.data, chance)
    flip_closure(ground.data, chance)
    ground.start()


def no_space(ground: Ground) -> None:
    """Compaction and backup without space lose nothing; they are tried on file systems of their own."""
    began_s = time.monotonic()
    words = ["unshare", "-rm", sys.executable, "-m", "tests.faults.no_space"]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=900)
    assert ended.returncode == 0, ended.stderr[-2000:]
    ground.observed_s += time.monotonic() - began_s


def links_cut(ground: Ground) -> None:
    """In its own network, a whole system survives an interruption of all links."""
    words = ["unshare", "-rn", sys.executable, "-m", "tests.faults.cut_links", str(_CUT_S)]
    began_s = time.monotonic()
    ended = subprocess.run(words, capture_output=True, text=True, timeout=300)
    assert ended.returncode == 0, ended.stderr[-2000:]
    found = json.loads(ended.stdout.splitlines()[-1])
    assert (found["lost"], found["doubled"]) == (0, 0), found
    ground.observed_s += time.monotonic() - began_s - found["whole_s"]  # it was started, and cut


@contextlib.contextmanager
def _limited(pid: int, kind: int, value: int) -> Iterator[None]:
    """Limit a resource of a process."""
    limits = resource.prlimit(pid, kind)
    resource.prlimit(pid, kind, (value, limits[1]))
    try:
        yield
    finally:
        with contextlib.suppress(ProcessLookupError):
            resource.prlimit(pid, kind, limits)


def _no_namespace(kind: str) -> str:
    """Return why a namespace cannot be created here; "" if it can."""
    try:
        ended = subprocess.run(["unshare", f"-r{kind}", "true"], capture_output=True, text=True)
    except OSError as error:
        return f"unshare: {error.strerror}"
    return ended.stderr.strip()


RESOURCES = (
    Fault("disk full for 3 s", disk_full, often=2),
    Fault("no memory for kb_node for 3 s", no_memory, often=2),
    Fault("read-only data folder", read_only, often=1, missing=lambda: _no_namespace("m")),
    Fault("a damaged commit, repair", damaged_journal, often=2),
    Fault("backup under load, restored", restored_backup, often=2),
    Fault(f"{_FLIPS} flipped bits in checkpoints and closures", flipped_bits, often=1),
    Fault("compaction and backup without space", no_space, often=1, missing=lambda: _no_namespace("m")),
    Fault(f"links cut for {_CUT_S:g} s", links_cut, often=1, missing=lambda: _no_namespace("n")),
)
