"""What the page's scene costs its process: 500 bodies that all move, and 5 000 entities.

    python -m benchmarks.page_scene [--bodies 500] [--seconds 20]

It plays the knowledge base and the simulator itself, and measures what `semmap web` takes with one tab open.
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import psutil  # type: ignore[import-untyped]

from nodes import bus
from nodes.runtime.loop import Node
from nodes.sim_node.models.facets import surface_of
from nodes.sim_node.models.library import Model, build
from schemas import codec, keys
from schemas.bridge import SnapshotQuery
from schemas.commands import Classes
from schemas.commits import Snapshot
from schemas.entities import Entity, Pose, Provenance
from schemas.health import Health
from schemas.scenes import Body, Poses, Scene, SceneQuery, Surface, SurfaceQuery, Surfaces, WorldQuery

_HZ = 20.0
_SAID = Provenance(commit=1, stamp_ns=1, source="operator")
_MODELS = ("chair", "table", "cup", "book", "bowl", "lamp", "fridge", "couch", "desk", "door")


class System:
    """Plays the knowledge base and the simulator: things on a grid, of which the first `moving` all move."""

    def __init__(self, session: bus.Session, entities: int, moving: int) -> None:
        self._node = Node("kb_node", session)
        self._poses = bus.publisher(session, keys.POSES)
        self._health = bus.publisher(session, keys.HEALTH, keys.health_key("kb_node"))
        side = math.ceil(math.sqrt(entities))
        self._at = np.array([(i % side, i // side, 0.0) for i in range(entities)]) * 1.5
        models = {name: build(name, None) for name in _MODELS}
        self._names = tuple(f"thing{i}" for i in range(entities))
        self._moving = moving
        self._surfaces = {name: surface_of(model) for name, model in models.items()}
        self._bodies = tuple(self._body(i, models) for i in range(entities))
        self._node.serve(
            keys.BRIDGE,
            {
                "snapshot": (SnapshotQuery, self._snapshot),
                "classes": (Classes, lambda _: ()),
            },
        )
        self._node.serve(
            keys.SIM,
            {
                "snapshot": (SceneQuery, lambda _: self._scene()),
                "surfaces": (SurfaceQuery, self._looks),
                "world": (WorldQuery, lambda _: Surface(points=b"", normals=b"", colours=b"", triangles=b"")),
            },
        )
        self._node.every(1.0 / _HZ, self._publish)
        self._node.every(1.0, self._beat)
        self._thread = threading.Thread(target=self._node.run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End it."""
        self._node.stop()
        self._thread.join()

    def _body(self, i: int, models: dict[str, Model]) -> Body:
        model = _MODELS[i % len(_MODELS)]
        return Body(
            name=self._names[i],
            class_=model.capitalize(),
            model=model,
            pose=Pose(position_m=tuple(self._at[i].tolist())),
            size_m=models[model].size_m,
            fixed=False,
            entity=True,
            ghost=False,
            resting=True,
            commit=1,
            shape_commit=1,
        )

    def _snapshot(self, query: SnapshotQuery) -> Snapshot:
        things = [
            Entity(
                name=body.name,
                class_=body.class_ or "",
                iri=f"urn:{body.name}",
                types=(body.class_ or "",),
                pose=body.pose,
                size_m=body.size_m,
                model=body.model,
                provenance=_SAID,
                pose_provenance=_SAID,
                shape_provenance=_SAID,
                reference_provenance=_SAID,
            )
            for body in self._bodies
            if body.name > (query.after or "")
        ]
        things.sort(key=lambda thing: thing.name)
        page = tuple(things[: query.limit])
        return Snapshot(seq=1, entities=page, more=len(page) < len(things))

    def _scene(self) -> Scene:
        return Scene(run="1", version=1, stamp_ns=1, sim_time_s=0.0, world="grid", bodies=self._bodies)

    def _looks(self, query: SurfaceQuery) -> Surfaces:
        models = {body.name: body.model for body in self._bodies}
        return Surfaces(surfaces={name: self._surfaces[models[name]] for name in query.names})

    def _publish(self) -> None:
        now_s = time.monotonic()
        at = self._at.copy()
        at[: self._moving, 2] += 0.3 + 0.3 * np.sin(now_s + np.arange(self._moving))
        rows = np.concatenate([at, np.tile((1.0, 0.0, 0.0, 0.0), (len(at), 1))], axis=1)
        count = len(self._names)
        poses = Poses(
            run="1",
            version=1,
            stamp_ns=time.time_ns(),
            sim_time_s=now_s,
            names=self._names,
            poses=tuple(rows.ravel().tolist()),
            resting=(False,) * count,
            commits=(1,) * count,
        )
        self._poses.put(codec.encode(poses))

    def _beat(self) -> None:
        now_ns = time.time_ns()
        health = Health(node="kb_node", pid=1, started_ns=1, stamp_ns=now_ns, state="ready", commit=1)
        self._health.put(codec.encode(health))


def measure(entities: int, moving: int, seconds: float, endpoint: str) -> tuple[float, float, float]:
    """Cores and MB that `semmap web` takes with one tab, and the seconds until its scene is there."""
    from playwright.sync_api import sync_playwright

    from tests.page.conftest import chromium_path

    network = bus.Network(connect=(), listen=(endpoint,), mode="peer")
    with bus.open_session(network) as session:
        system = System(session, entities, moving)
        command = [str(Path(sys.executable).parent / "semmap"), "web", "--connect", endpoint, "--port", "0"]
        with (
            subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process,
            sync_playwright() as driver,
        ):
            assert process.stdout is not None
            url = process.stdout.readline().strip()
            browser = driver.chromium.launch(executable_path=chromium_path(), args=list(_GL))
            tab = browser.new_page(viewport={"width": 640, "height": 480})
            sizes: list[int] = []
            tab.on("websocket", lambda socket: _count(socket, sizes))
            begun_s = time.monotonic()
            tab.goto(url)
            while sum(sizes) < 20_000 and time.monotonic() - begun_s < 120.0:
                tab.wait_for_timeout(100)
            there_s = time.monotonic() - begun_s
            tab.wait_for_timeout(5000)
            web = psutil.Process(process.pid)
            before, before_s, sent = web.cpu_times(), time.monotonic(), sum(sizes)
            tab.wait_for_timeout(1000.0 * seconds)
            after, took_s = web.cpu_times(), time.monotonic() - before_s
            cores = (after.user + after.system - before.user - before.system) / took_s
            mb = web.memory_info().rss / 1e6
            print(f"{entities} entities, {moving} moving: {cores:.3f} cores, {mb:.0f} MB,")
            print(f"  {(sum(sizes) - sent) / took_s / 1e3:.0f} kB/s to the tab, scene after {there_s:.1f} s")
            browser.close()
            process.send_signal(2)
        system.close()
    return cores, mb, there_s


def _count(socket: object, sizes: list[int]) -> None:
    if "/scene/" in socket.url:  # type: ignore[attr-defined]
        socket.on("framereceived", lambda said: sizes.append(len(said)))  # type: ignore[attr-defined]


_GL = (
    *("--no-sandbox", "--no-first-run", "--disable-background-networking"),
    *("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
)


def main() -> None:
    """Measure, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bodies", type=int, default=500, help="bodies that all move")
    parser.add_argument("--entities", type=int, default=5000, help="entities of a map at rest")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--endpoint", default="tcp/127.0.0.1:7991")
    said = parser.parse_args()
    measure(said.bodies, said.bodies, said.seconds, said.endpoint)
    measure(said.entities, 0, said.seconds, said.endpoint)


if __name__ == "__main__":
    main()
