import os
from pathlib import Path

import pytest
import rdflib

from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from tests.ontology.graphs import read


@pytest.fixture(scope="session")
def tbox() -> rdflib.Graph:
    return read(HOUSEHOLD_TTL)


@pytest.fixture(scope="session")
def flat() -> rdflib.Graph:
    return read(FLAT_TTL)


@pytest.fixture(scope="session")
def data_dir() -> Path:
    root = Path(__file__).parents[2]
    folder = Path(os.environ.get("SEMMAP_DATA", root.parent / "shared" / "data"))
    if not folder.is_dir():
        if os.environ.get("SEMMAP_DATA_REQUIRED") == "1":
            pytest.fail(f"no test data in {folder}")
        pytest.skip(f"no test data in {folder}: set SEMMAP_DATA")
    return folder
