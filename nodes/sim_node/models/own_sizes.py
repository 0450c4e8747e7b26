"""The size of every library model, for code that runs without the library.

`python -m nodes.sim_node.models.own_sizes` writes `ontology/model_sizes.json`; a test holds it to the models.
"""

from __future__ import annotations

import json

from nodes.sim_node.models.library import build
from nodes.sim_node.models.model_table import MODELS
from ontology import MODEL_SIZES_JSON

_BOX = ""
"""The model of a class without one."""
_DIGITS = 4


def own_sizes_m() -> dict[str, list[float]]:
    """Model name to the extent along its own axes [m], as the simulator builds it when no size is ordered."""
    names = (_BOX, *sorted(MODELS))
    return {name: [round(extent, _DIGITS) for extent in build(name, None).size_m] for name in names}


def main() -> None:
    """Write the table into the ontology's folder."""
    rows = (f"  {json.dumps(name)}: {json.dumps(size)}" for name, size in own_sizes_m().items())
    MODEL_SIZES_JSON.write_text("{\n" + ",\n".join(rows) + "\n}\n")


if __name__ == "__main__":
    main()
