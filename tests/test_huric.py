"""Loads every map of the HuRIC corpus into a running system and its scene."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest

from semmap.nodes.runtime.class_names import ClassNames
from semmap.schemas import errors
from tests.conftest import running, until
from tests.data import data_folder

EVERY = 24
"""The default tests take each 24th map; `make test-long` takes all."""


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    data_folder()
    with (
        running(tmp_path_factory.mktemp("huric"), "--abox", "none", "--no-record") as system,  # without walls
        system.client() as client,
    ):
        yield client


@pytest.fixture(scope="module")
def classes(client):
    return ClassNames(client.classes())


def maps():
    return sorted((data_folder() / "huric").rglob("*.hrc"))


def spatial(classes, name):
    try:
        return classes.spatial(name)
    except errors.UnknownClass:
        return None


def require_loaded(client, classes, path):
    described = ET.parse(path).findall("./semanticMap/entities/entity")
    known = {e.get("atom"): e for e in described if spatial(classes, e.get("type")) is not None}
    unknown = [e for e in described if e.get("atom") not in known]
    if unknown:
        with pytest.raises(errors.UnknownClass) as refusal:
            client.load(path, replace=True)
        assert all(f"'{e.get('type')}'" in refusal.value.text for e in unknown)
    reply = client.load(path, replace=True, skip_unknown=True)
    assert len(reply.skipped) == len(unknown)
    until(lambda: client.status().in_agreement, f"the scene of {path.name} stands")
    entities = {e.name: e for e in client.list()}
    assert set(entities) == set(known)
    for name, entity in entities.items():
        place = known[name].find("coordinate")
        assert entity.class_ == spatial(classes, known[name].get("type")).name
        x, y, _ = entity.pose.position_m
        assert (x, y) == pytest.approx((float(place.get("x")), float(place.get("y"))), abs=0.05), name
        assert entity.body.status in (("none",) if entity.place else ("present", "ghost")), name


def test_maps_of_the_corpus(client, classes):
    for path in maps()[::EVERY]:
        require_loaded(client, classes, path)


@pytest.mark.long
def test_every_map_of_the_corpus(client, classes):
    for path in maps():
        require_loaded(client, classes, path)
