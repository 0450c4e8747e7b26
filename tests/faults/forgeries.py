"""Messages that an unauthorized client can send to a system without certificates.

Such a client cannot be blocked on an open network. The guarantee is that the nodes keep running, detect the
forgery, and trust only their own nodes.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator

import zenoh
from msgspec import structs

from semmap.nodes import bus
from semmap.schemas import codec, errors, keys
from semmap.schemas.commits import Commit, Departed, Effects
from semmap.schemas.entities import Pose
from semmap.schemas.health import Health
from semmap.schemas.replies import Changed
from semmap.schemas.scenes import BodyOrder, Poses, Spawn, Spawned
from tests.faults.ground import Ground, free_place, wait_for
from tests.faults.processes import ALL, NOTICED_S, _runs, all_pids_of
from tests.faults.table import Fault


def health_of_unknown_node(ground: Ground) -> None:
    """A heartbeat of a node that does not exist."""
    pids = all_pids_of(ground.data)
    with _stranger(ground) as session:
        session.put(keys.health_key("x"), codec.encode(_health("x", 1)))
        ground.observe(2 * NOTICED_S)
    assert ground.system.process.poll() is None
    assert all_pids_of(ground.data) == pids


def health_of_a_stopped_node(ground: Ground) -> None:
    """Forged heartbeats do not prevent the restart of a hanging node."""
    pid = all_pids_of(ground.data)["kb_node"]
    with (
        _stranger(ground) as session,
        _repeated(session, keys.health_key("kb_node"), _health("kb_node", pid)),
    ):
        time.sleep(1.0)
        os.kill(pid, signal.SIGSTOP)
        wait_for(lambda: not _runs(pid), "the hanging node is restarted", within_s=NOTICED_S)


def forged_commit(ground: Ground) -> None:
    """A forged commit with the next number does not hide an acknowledged change for long."""
    with ground.client() as client, _stranger(ground) as session:
        (name,) = client.add("Bowl", at=(4.0, 4.0, 0.0)).names
        gone = (Departed(name=name, types=("Bowl",)),)
        for _ in range(20):
            seq = client.status().commit + 1
            commit = Commit(
                seq=seq, stamp_ns=time.time_ns(), id=f"forged{seq}", source="scene", removed=gone, digest="00"
            )
            session.put(keys.COMMIT.key, codec.encode(commit))
            session.put(keys.COMMIT_EFFECTS.key, codec.encode(Effects.of(commit)))
        wait_for(lambda: name in {entity.name for entity in client.list("Bowl")}, "what was hidden is there")

        def is_removed() -> bool:
            try:
                return client.remove(name).names == (name,)
            except errors.UnknownName:  # hidden again by the last forged commit
                return False

        wait_for(is_removed, "what was hidden can be removed")


def commit_far_ahead(ground: Ground) -> None:
    """A forged commit with a number far ahead is searched for, and then forgotten."""
    with ground.client() as client, _stranger(ground) as session:
        commit = Commit(seq=10**12, stamp_ns=1, id="far", source="scene", digest="00")
        session.put(keys.COMMIT_EFFECTS.key, codec.encode(Effects.of(commit)))
        assert client.status().commit < 10**9


def pose_of_the_future(ground: Ground) -> None:
    """Poses after one with a stamp of 2**62 are still accepted."""
    with ground.client() as client, _stranger(ground) as session:
        heard: list[Poses] = []
        bus.follow(session, keys.POSES, lambda _, poses: heard.append(poses))
        client.add("Chair", "seat", at=(5.0, 5.0, 0.0), wait=True)
        poses = wait_for(lambda: heard and "seat" in heard[-1].names and heard[-1], "poses with the chair")
        session.put(keys.POSES.key, codec.encode(structs.replace(poses, stamp_ns=2**62)))
        time.sleep(0.5)
        client.move("seat", at=(7.0, 6.0, 0.0))

        def follows() -> bool:
            x, y, _ = client.get("seat").pose.position_m
            return abs(x - 7.0) < 0.2 and abs(y - 6.0) < 0.2

        wait_for(follows, "the map follows the chair")
        client.remove("seat")


def stolen_acknowledgements(ground: Ground) -> None:
    """A foreign queryable replies to `add`: its replies are ignored, and every change is made."""
    stolen = []

    def steal(query: zenoh.Query) -> None:
        stolen.append(query)
        with query:
            query.reply(query.key_expr, codec.encode(Changed(commit=1, text="added", names=("nothing",))))

    with _stranger(ground) as session:
        session.declare_queryable(f"{keys.CMD}/add", steal, complete=True)
        with ground.client() as client:
            wait_for(lambda: client.add("Plate", at=free_place()) and stolen, "it was asked")
            for _ in range(20):
                names = client.add("Plate", at=free_place()).names
                assert names != ("nothing",)
                assert set(names) <= {entity.name for entity in client.list("Plate")}
    assert "nothing" not in ground.load.added


def files_of_the_host(ground: Ground) -> None:
    """No order makes the simulator read a file that is not one of its models."""
    with _stranger(ground) as session:
        for number, model in enumerate(("/etc/passwd.xml", "../../etc/hosts.obj", "/etc/hostname.stl")):
            name = f"spy{number}"
            order = BodyOrder(
                name=name, class_="Chair", model=model, pose=Pose(position_m=(0.0, 0.0, 1.0)), commit=1
            )
            spawned = bus.ask(session, keys.SIM, Spawn.VERB, Spawn(bodies=(order,)), Spawned)
            assert "folder given by" in spawned.failed[name] or "are allowed" in spawned.failed[name], spawned


@contextlib.contextmanager
def _stranger(ground: Ground) -> Iterator[bus.Session]:
    with bus.open_session(bus.Network(connect=(ground.endpoint,))) as session:
        yield session


@contextlib.contextmanager
def _repeated(session: bus.Session, key: str, message: object) -> Iterator[None]:
    """Publish a message ten times a second while the context is open."""
    ending = threading.Event()

    def repeat() -> None:
        while not ending.wait(0.1):
            session.put(key, codec.encode(message))

    thread = threading.Thread(target=repeat)
    thread.start()
    try:
        yield
    finally:
        ending.set()
        thread.join()


def _health(node: str, pid: int) -> Health:
    return Health(node=node, pid=pid, started_ns=1, stamp_ns=time.time_ns(), state="ready", detail="forged")


FORGERIES = (
    Fault("health of a node that there is not", health_of_unknown_node, often=1),
    Fault("forged heartbeats of a stopped node", health_of_a_stopped_node, often=2, in_short=1),
    Fault("forged commit with the next number", forged_commit, often=5, in_short=1),
    Fault("forged commit with a far number", commit_far_ahead, often=2),
    Fault("forged pose with a stamp of 2**62", pose_of_the_future, often=2, words=ALL),
    Fault("foreign queryable on cmd/add", stolen_acknowledgements, often=3, in_short=1),
    Fault("orders to read files of the host", files_of_the_host, often=1, words=ALL),
)
