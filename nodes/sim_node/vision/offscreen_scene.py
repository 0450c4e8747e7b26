"""A scene for rendering videos: bodies are placed exactly, without physics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from semmap.nodes.sim_node import order_validation
from semmap.nodes.sim_node.bodies import Floats, pose_of
from semmap.nodes.sim_node.models.sources import Models
from semmap.nodes.sim_node.physics import base_scene
from semmap.nodes.sim_node.physics.engine import Engine, is_at
from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.sim_node.vision.labels import draw_labels, find_tops, project_points
from semmap.nodes.sim_node.vision.view import FROM_ABOVE, View, bulk, camera_view, overview
from semmap.nodes.sim_node.world_file import is_scene
from semmap.ontology.model_shapes import is_same_size
from semmap.schemas.entities import Pose, Vector
from semmap.schemas.scenes import BodyOrder

Rgb = NDArray[np.uint8]


class OffscreenScene:
    """The world of a file, with bodies that are added, removed and moved. Bound to one thread."""

    def __init__(
        self,
        world: Path | None,
        *,
        models: Path | None = None,
        data: Path | None = None,
        graphics: bool = True,
    ) -> None:
        """Load the world. A JSON world, whose bodies are entities, provides only a floor, as no file does.

        `models` is a folder of model files, and `data` the map's data folder, which may contain some. Without
        OpenGL, or without `graphics`, rays are cast. Raises BadFile.
        """
        bare = world is None or is_scene(world)
        ground = base_scene.bare_floor() if bare or world is None else base_scene.read_mjcf(world)
        self._models = Models(models, data)
        self._engine = Engine(ground, lambda: None)
        self._eye = Eye(graphics=graphics)

    @property
    def has_graphics(self) -> bool:
        """Return whether OpenGL is used; otherwise rays are cast, with flat colours."""
        return self._eye.has_graphics

    def __contains__(self, name: object) -> bool:
        """Return whether a body of this name exists."""
        return name in self._engine.records

    def add(self, orders_: Iterable[BodyOrder]) -> Mapping[str, str]:
        """Add bodies at their ordered poses; return the reasons for rejections by name.

        A body of the world file is used for an order of its name and size. Other bodies of these names are
        replaced.
        """
        own, others = list[BodyOrder](), list[BodyOrder]()
        for order in orders_:
            (own if self._is_own(order) else others).append(order)
        self.remove(order.name for order in others)
        made, failed = order_validation.validate_spawn(others, self._models, self._engine.has)
        if made:
            self._engine.add(list(made.values()))
        for order in own:
            record = self._engine.records[order.name]
            record.joints = order_validation.place_joints(record.joints, order.properties)
        self._engine.set_joints(order.name for order in own)
        self.put({order.name: order.pose for order in own})
        return failed

    def _is_own(self, order: BodyOrder) -> bool:
        """Return whether the world file has the body that is ordered."""
        record = self._engine.records.get(order.name)
        if record is None or self._engine.shape(order.name) is not None:
            return False
        return order.size_m is None or is_same_size(order.size_m, record.size_m)

    def remove(self, names: Iterable[str]) -> None:
        """Remove bodies; unknown names are ignored."""
        there = [name for name in names if name in self._engine.records]
        if there:
            self._engine.remove(there)

    def put(self, poses: Mapping[str, Pose]) -> None:
        """Move bodies, without collision checks; unknown names are ignored.

        A body that a joint or its parent body fixes is moved by joints only.
        """
        records, here = (
            self._engine.records,
            dict(zip(self._engine.index.names, self._engine.poses(), strict=True)),
        )
        there = {
            name: pose
            for name, pose in poses.items()
            if name in records and not records[name].anchored and not is_at(pose, pose_of(here[name]))
        }
        static = {name for name in there if records[name].static}
        self._engine.hold({name: there[name] for name in static})
        self._engine.put({name: pose for name, pose in there.items() if name not in static})

    def extent(self) -> tuple[Floats, Floats]:
        """Return lowest and highest corner, each (3,) [m], of the box around all bodies but outliers."""
        obstacles = self._engine.obstacles()
        colliding = np.isfinite(obstacles.body_low).all(axis=1)
        return bulk(obstacles.body_low[colliding], obstacles.body_high[colliding])

    def view(
        self, width: int, height: int, *, camera: str = "", box: tuple[Vector, Vector] | None = None
    ) -> View:
        """Return the view of a camera, of a box (lowest and highest corner [m]) from above, or of everything.

        Raises BadRequest for an unknown camera.
        """
        if camera:
            return camera_view(self._engine.model, self._engine.data, camera, width, height)
        if box is not None:
            return overview(np.array(box[0]), np.array(box[1]), width, height, back=FROM_ABOVE)
        return overview(*self.extent(), width, height)

    def picture(self, view: View, labels: Mapping[str, str]) -> Rgb:
        """Render the view (H, W, 3); `labels` are drawn next to the bodies of these names."""
        model, data = self._engine.model, self._engine.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        scale = 2 if self.has_graphics else 1  # antialiasing, if it is cheap
        fine = View(
            scale * view.width,
            scale * view.height,
            np.diag([float(scale), float(scale), 1.0]) @ view.intrinsics,
            view.map_from_camera,
        )
        rgb, _ = self._eye.render(model, data, fine)
        image = Image.fromarray(rgb)
        if scale > 1:
            image = image.resize((view.width, view.height), Image.Resampling.BOX)
        if labels:
            tops = find_tops(model, data, self._engine.index.owners(model)[model.geom_bodyid])
            points = {labels[name]: top for name, top in tops.items() if name in labels}
            image = draw_labels(image, project_points(view, points))
        return np.asarray(image)
