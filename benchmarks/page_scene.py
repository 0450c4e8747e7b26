"""The cost of the page's scene: 500 moving bodies, and 5 000 entities.

    python -m benchmarks.page_scene [--bodies 500] [--entities 5000] [--seconds 15] [--json]

It simulates the knowledge base and the simulator, and measures what `semmap web` takes with one tab open,
of 640 x 480. With software rendering, the browser processes fewer updates than it receives, so the
cost of ten per second is also calculated. Its frame rate is compared with that of viser alone, with the same
triangles.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import shutil
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import psutil
import viser
from numpy.typing import NDArray
from playwright.sync_api import Browser, Frame, Page, ViewportSize, WebSocket, sync_playwright

from benchmarks.page import page_of
from benchmarks.table import Row, as_json, lines
from semmap.nodes import bus
from semmap.nodes.extern.web.scene.bodies import Bodies
from semmap.nodes.extern.web.scene.camera import first_view
from semmap.nodes.extern.web.scene.drawables import Drawable
from semmap.nodes.extern.web.scene.meshes import glb
from semmap.nodes.runtime.loop import Node
from semmap.nodes.sim_node.models.facets import surface_of
from semmap.nodes.sim_node.models.library import Model, build
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import codec, keys
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commands import Classes
from semmap.schemas.commits import Snapshot
from semmap.schemas.entities import Entity, Pose, Provenance
from semmap.schemas.health import Health
from semmap.schemas.scenes import Body, Poses, Scene, SceneQuery, Surface, SurfaceQuery, Surfaces, WorldQuery

_HZ = 20.0
_BYTES_OF_A_POSE = 28
"""The size of a pose [bytes]: three numbers of a position and four of a quaternion."""
_MESHES_BYTES = 20_000
_VIEWPORT: ViewportSize = {"width": 640, "height": 480}
_ASPECT = 640 / 480
_GL = (
    *("--no-sandbox", "--no-first-run", "--disable-background-networking"),
    *("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
)
_TWO_FRAMES = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
_COUNT_FRAMES = """() => {
  window.semmapFrames = 0;
  const tick = () => { window.semmapFrames += 1; requestAnimationFrame(tick); };
  tick();
}"""
_SAID = Provenance(commit=1, stamp_ns=1, source="operator")
_MODELS = ("chair", "table", "cup", "book", "bowl", "lamp", "fridge", "couch", "desk", "door")


def _grid(entities: int) -> NDArray[np.float64]:
    """Return the positions (N, 3) [m]."""
    side = math.ceil(math.sqrt(entities))
    return np.array([(i % side, i // side, 0.0) for i in range(entities)]) * 1.5


class System:
    """Simulates the knowledge base and the simulator: things on a grid, of which the first `moving` move."""

    def __init__(self, session: bus.Session, entities: int, moving: int) -> None:
        self._node = Node("kb_node", session)
        self._poses = bus.publisher(session, keys.POSES)
        self._health = bus.publisher(session, keys.HEALTH, keys.health_key("kb_node"))
        self._at = _grid(entities)
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
        """Close the session."""
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


def of_moving(bodies: int, seconds: float) -> list[Row]:
    """Measure the cost of moving bodies for the page's process, with one tab."""
    with _page(bodies, bodies) as (page, process, _, sizes):
        page.wait_for_timeout(5000)
        before, began_s, sent = process.cpu_times(), time.monotonic(), sum(sizes)
        page.wait_for_timeout(1000.0 * seconds)
        after, took_s = process.cpu_times(), time.monotonic() - began_s
        cores = (after.user + after.system - before.user - before.system) / took_s
        hertz = (sum(sizes) - sent) / took_s / (_BYTES_OF_A_POSE * bodies)
        return [
            Row(f"{bodies} bodies that all move: updates that the browser took", hertz, "Hz"),
            Row("the page's process", cores, "cores", reach=0.5),
            Row(
                "the same at ten updates a second, at most",
                cores * max(1.0, 10.0 / hertz),
                "cores",
                reach=0.5,
            ),
            Row("its memory", process.memory_info().rss / 1e6, "MB"),
        ]


def of_many(entities: int, seconds: float) -> list[Row]:
    """Measure a static scene, compared with viser alone with the same triangles, in software rendering."""
    with _page(entities, 0) as (page, process, there_s, _):
        (frame,) = (frame for frame in page.frames if "/scene/" in frame.url)
        page.wait_for_timeout(3000)
        before, began_s = process.cpu_times(), time.monotonic()
        hertz = _turned(page, frame, seconds)
        after, took_s = process.cpu_times(), time.monotonic() - began_s
        cores = (after.user + after.system - before.user - before.system) / took_s
        memory_mb = process.memory_info().rss / 1e6
    bare_there_s, bare_hertz = _bare(entities, seconds)
    return [
        Row(f"{entities:,} entities: scene there after", there_s, "s"),
        Row("viser alone with the same triangles: there after", bare_there_s, "s"),
        Row("pictures a second while the view turns", hertz, "Hz"),
        Row("viser alone: pictures a second", bare_hertz, "Hz"),
        Row("the page's process while the view turns", cores, "cores", reach=0.5),
        Row("its memory", memory_mb, "MB"),
    ]


@contextlib.contextmanager
def _page(entities: int, moving: int) -> Iterator[tuple[Page, psutil.Process, float, list[int]]]:
    """Open a tab; yield it, the page's process, the time until the scene is shown [s], and sizes [bytes]."""
    endpoint = free_endpoint()
    network = bus.Network(connect=(), listen=(endpoint,), mode="peer")
    with contextlib.ExitStack() as stack:
        session = stack.enter_context(bus.open_session(network))
        stack.callback(System(session, entities, moving).close)
        address, process, _ = stack.enter_context(page_of(endpoint))
        tab = stack.enter_context(_browser()).new_page(viewport=_VIEWPORT)
        sizes: list[int] = []
        tab.on("websocket", lambda socket: _count(socket, sizes))
        begun_s = time.monotonic()
        tab.goto(address)
        there_s = _there(tab, sizes, begun_s)
        yield tab, process, there_s, sizes


def _bare(entities: int, seconds: float) -> tuple[float, float]:
    """Measure viser with the same batches: time until shown [s], and frames per second."""
    with contextlib.ExitStack() as stack:
        server = viser.ViserServer(
            host="127.0.0.1", port=int(free_endpoint().rpartition(":")[2]), verbose=False
        )
        stack.callback(server.stop)
        models = {name: build(name, None) for name in _MODELS}
        looks = {name: surface_of(model) for name, model in models.items()}
        at = _grid(entities)
        things = {
            f"thing{i}": Drawable(
                "solid", model, models[model].size_m, (128, 128, 128), Pose(position_m=tuple(at[i].tolist()))
            )
            for i, model in ((i, _MODELS[i % len(_MODELS)]) for i in range(entities))
        }
        Bodies(server.scene, lambda key: glb(looks[key[1]])).show(things)
        eye, target = first_view(np.array([at.min(axis=0), at.max(axis=0)]), _ASPECT)
        server.initial_camera.position, server.initial_camera.look_at = eye, target
        tab = stack.enter_context(_browser()).new_page(viewport=_VIEWPORT)
        sizes: list[int] = []
        tab.on("websocket", lambda socket: _count(socket, sizes, of=""))
        begun_s = time.monotonic()
        tab.goto(f"http://127.0.0.1:{server.get_port()}/")
        there_s = _there(tab, sizes, begun_s)
        tab.wait_for_timeout(3000)
        return there_s, _turned(tab, tab.main_frame, seconds)


def _there(tab: Page, sizes: list[int], begun_s: float) -> float:
    """Return the time until the meshes have arrived and been drawn [s]."""
    while sum(sizes) < _MESHES_BYTES and time.monotonic() - begun_s < 120.0:
        tab.wait_for_timeout(100)
    tab.evaluate(_TWO_FRAMES)
    return time.monotonic() - begun_s


def _turned(tab: Page, frame: Frame, seconds: float) -> float:
    """Return the browser's frames per second while the view is dragged."""
    x, y = _VIEWPORT["width"] / 2, _VIEWPORT["height"] / 2
    frame.evaluate(_COUNT_FRAMES)
    tab.mouse.move(x, y)
    tab.mouse.down()
    counted, began_s = frame.evaluate("() => semmapFrames"), time.monotonic()
    while (now_s := time.monotonic() - began_s) < seconds:
        tab.mouse.move(x + 80 * math.sin(2 * now_s), y + 10 * math.sin(3 * now_s))
        tab.wait_for_timeout(30)
    pictures = frame.evaluate("() => semmapFrames") - counted
    took_s = time.monotonic() - began_s
    tab.mouse.up()
    return float(pictures) / took_s


@contextlib.contextmanager
def _browser() -> Iterator[Browser]:
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        sys.exit("there is no Chromium: sudo apt-get install chromium")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=[*_GL])
        try:
            yield browser
        finally:
            browser.close()


def _count(socket: WebSocket, sizes: list[int], of: str = "/scene/") -> None:
    if of in socket.url:
        socket.on("framereceived", lambda said: sizes.append(len(said)))


def main() -> None:
    """Measure and print the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--bodies", type=int, default=500, help="number of moving bodies; 0 skips this part")
    parser.add_argument(
        "--entities", type=int, default=5000, help="entities of a static map; 0 skips this part"
    )
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--json", action="store_true")
    said = parser.parse_args()
    rows = of_moving(said.bodies, said.seconds) if said.bodies else []
    rows += of_many(said.entities, said.seconds) if said.entities else []
    print(json.dumps([as_json(row) for row in rows], indent=2) if said.json else lines(rows))


if __name__ == "__main__":
    main()
