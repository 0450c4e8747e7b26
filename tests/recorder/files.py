"""Reads recordings without the code under test."""

import warnings

from rerun.chunk import RrdReader


def column(path, entity_path, component, *, whole=False):
    """Return the values of one component of one entity as logged, also from a growing file.

    By default the first value of each time, with `whole` all values.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        batches = [
            chunk.to_record_batch() for chunk in RrdReader(path).stream() if chunk.entity_path == entity_path
        ]
    rows = []
    for batch in batches:
        if component in batch.schema.names:
            ids = batch.column("rerun.controls.RowId").to_pylist()
            rows += zip(ids, batch.column(component).to_pylist(), strict=True)
    return [value if whole else value[0] for _, value in sorted(rows, key=lambda row: row[0]) if value]


def timelines(path, entity_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        chunks = [c for c in RrdReader(path).stream() if c.entity_path == entity_path]
    return {name for chunk in chunks for name in chunk.timeline_names}


def log(path):
    return column(path, "/commits/log", "TextLog:text")


def positions(path, name):
    return column(path, f"/map/bodies/{name}", "Transform3D:translation")
