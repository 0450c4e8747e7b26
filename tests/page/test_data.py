"""Panels in a browser: SPARQL, standing queries, files, plan, graph and nodes; markup is text."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
import uuid
import xml.etree.ElementTree as ET
from collections.abc import Iterator

from semmap.commands import Add, Remove
from semmap.nodes import bus
from semmap.schemas import codec, keys
from semmap.schemas.health import Health
from tests.conftest import until

DM = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_domain_model#"
ABOX = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping_1#"


def fresh(stem: str) -> str:
    return f"{stem}_{uuid.uuid4().hex[:8]}"


def turn_to(tab, name):
    tab.get_by_role("tab", name=name, exact=True).click()


def write_query(tab, text):
    tab.locator(".cm-content").click()
    tab.keyboard.press("Control+a")
    tab.keyboard.insert_text(text)


def test_sparql_queries_run_select_and_become_standing_queries(tab, system):
    name = fresh("cup")
    turn_to(tab, "SPARQL")
    write_query(tab, "SELECT ?thing { ?thing a dm:Bed }")
    tab.get_by_role("button", name="Run").click()
    tab.get_by_role("cell", name=":bed1").click()
    tab.locator(".semmap-heading").get_by_text("bed").first.wait_for()

    write_query(tab, "INSERT DATA { :x a dm:Cup }")
    tab.keyboard.press("Control+Enter")
    tab.get_by_role("alert").get_by_text("the panels Add and Details").wait_for()

    write_query(tab, f"SELECT ?thing {{ ?thing a dm:Cup FILTER(STRENDS(STR(?thing), '{name}')) }}")
    tab.get_by_role("button", name="Watch").click()
    tab.get_by_text("0 rows, commit").wait_for()
    with system.client() as client:
        client.send(Add(class_="Cup", name=name, at=(2.0, 3.0, 1.0)))
        tab.get_by_text("1 row, commit").wait_for()
        tab.get_by_role("cell", name=f":{name}").wait_for()
        client.send(Remove(names=(name,)))
        tab.get_by_text("0 rows, commit").wait_for()


def test_files_have_a_dry_run_and_are_loaded_or_rejected(tab, system, tmp_path):
    name = fresh("cup")
    files = ("more.ttl", "film.bin", "prose.txt", "strange.ttl")
    more, large, prose, strange = (tmp_path / file for file in files)
    more.write_text(f"<{ABOX}{name}> a <{DM}Cup> .\n")
    prose.write_text("Once upon a time <there> was no ontology.")
    strange.write_text("".join(f"<{ABOX}{name}> a <{DM}Kind{n}Of{name}> .\n" for n in range(9)))
    with large.open("wb") as file:
        file.write(b"abc\0def")
        file.truncate(50 << 20)
    turn_to(tab, "Files")
    chooser = tab.locator("input[type=file]")
    chooser.set_input_files(large)
    tab.get_by_role("alert").get_by_text("film.bin: unsupported binary format").wait_for()
    chooser.set_input_files(prose)
    tab.get_by_role("alert").get_by_text("prose.txt").wait_for()
    chooser.set_input_files(strange)
    tab.get_by_role("alert").get_by_text("unknown classes:").wait_for()
    assert tab.get_by_role("alert").get_by_text(f"(of {name}").locator("visible=true").count() == 3
    tab.get_by_role("alert").get_by_text("6 more").wait_for()
    chooser.set_input_files(more)
    tab.get_by_text("Changes by more.ttl:").wait_for()
    with system.client() as client:
        assert name not in {entity.name for entity in client.list("Cup")}
        tab.get_by_role("button", name="Load more.ttl").click()
        until(lambda: name in {entity.name for entity in client.list("Cup")}, "it is loaded")
        with tab.expect_download() as download:
            tab.get_by_role("button", name="Export").click()
        client.send(Remove(names=(name,)))
    assert download.value.suggested_filename.endswith(".ttl")
    assert name in download.value.path().read_text()


@contextlib.contextmanager
def _slowed(pid: int) -> Iterator[None]:
    """Let a process run a twentieth of the time. One that is suspended is restarted after a few seconds."""
    is_over = threading.Event()

    def slow() -> None:
        while not is_over.wait(0.01):
            os.kill(pid, signal.SIGSTOP)
            is_over.wait(0.19)
            os.kill(pid, signal.SIGCONT)

    thread = threading.Thread(target=slow)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()


def test_uploads_and_dry_runs_can_be_stopped(tab, system, tmp_path):
    name, many = fresh("cup"), tmp_path / "many.ttl"
    many.write_text("".join(f"<{ABOX}{name}_{n}> a <{DM}Cup> .\n" for n in range(30_000)))
    turn_to(tab, "Files")
    chooser, stop = tab.locator("input[type=file]"), tab.get_by_role("button", name="Stop", exact=True)
    network = tab.context.new_cdp_session(tab)
    slow = {"offline": False, "latency": 0, "downloadThroughput": -1, "uploadThroughput": 100_000}
    network.send("Network.enable")
    network.send("Network.emulateNetworkConditions", slow)
    chooser.set_input_files(many)
    tab.get_by_text("Uploading ...").wait_for()
    stop.click()
    tab.get_by_text("Stopped; no changes.").wait_for()
    network.send("Network.emulateNetworkConditions", slow | {"uploadThroughput": -1})

    with _slowed(system.pid("kb_node")):  # otherwise the check takes less than a second
        chooser.set_input_files(many)
        tab.get_by_text("Checking many.ttl").wait_for()
        stop.click()
        tab.get_by_text("Stopped; no changes.").wait_for()
        assert not stop.is_visible()
    with system.client() as client:  # whose answer comes after that to what was tried
        assert not {entity.name for entity in client.list("Cup") if entity.name.startswith(name)}
    assert tab.get_by_text("Changes by").count() == 0
    assert tab.get_by_role("alert").get_by_text("upload incomplete").count() == 0


def test_plan_graph_check_and_nodes_are_shown(tab):
    turn_to(tab, "Plan")
    image = tab.get_by_role("img", name="Plan of the rooms").locator("img")
    until(lambda: image.evaluate("image => image.naturalWidth") > 1000, "the plan is drawn")
    width = image.bounding_box()["width"]
    tab.get_by_role("button", name="Zoom in").click()
    until(lambda: image.bounding_box()["width"] > 1.4 * width, "the plan is larger")
    with tab.expect_download() as download:
        tab.get_by_role("button", name="SVG").click()
    svg = ET.fromstring(download.value.path().read_text())
    words = [text.text for text in svg.iter("{http://www.w3.org/2000/svg}text")]
    assert {"kitchen", "bed1"} <= set(words)

    turn_to(tab, "Graph")
    tab.get_by_text("No selection: the graph shows all places").wait_for()
    tab.get_by_role("button", name="Table").click()
    tab.get_by_role("row", name="kitchen").get_by_text("isLocatedIn").first.wait_for()

    turn_to(tab, "Ontology")
    view = tab.get_by_role("tabpanel", name="Ontology")
    view.get_by_role("combobox", name="Class").fill("Cup ·")
    tab.get_by_role("option", name="Cup ·").first.wait_for()
    tab.keyboard.press("Enter")  # takes the best match
    view.get_by_text("every cup has material").wait_for()
    view.get_by_text("Dishware", exact=True).click()  # a superclass
    view.get_by_role("heading", name="dishware").wait_for()
    assert view.get_by_role("alert").count() == 0

    turn_to(tab, "System")
    tab.get_by_role("row", name="kb_node").get_by_text("ready").first.wait_for()
    tab.get_by_label("Filter log").fill("begun from")
    tab.get_by_role("row", name="begun from flat.ttl").first.wait_for()

    turn_to(tab, "Check")
    tab.get_by_text("consistent (").wait_for()


def test_markup_is_text_everywhere(tab, system):
    """In labels, properties, reasons, names of clients and forged heartbeats."""
    name, room = fresh("cup"), fresh("room")
    markup = "<img src=x onerror=\"document.title='run'\"><script>document.title='run'</script>"
    with system.client() as client:
        by = {"agent": markup, "reason": markup}
        size = (3.0, 3.0, 2.5)
        client.send(Add(class_="Kitchen", name=room, at=(20.0, 3.0, 0.0), size=size, ref=markup, **by))
        client.send(Add(class_="Cup", name=name, at=(20.0, 3.0, 0.0), ref=markup, alt=(markup,), **by))
        _forge_heartbeat(system, markup)
        for panel in ("Graph", "Plan", "Check", "Files", "History", "System"):
            turn_to(tab, panel)
        tab.get_by_role("row", name=markup).first.wait_for()
        turn_to(tab, "SPARQL")
        written = "?thing dm:hasPreferredReference ?r . ?r dm:lexicalReference ?text"
        write_query(tab, f"SELECT ?thing ?text {{ {written} FILTER(CONTAINS(?text, 'onerror')) }}")
        tab.get_by_role("button", name="Run").click()
        tab.get_by_role("cell", name="<img src=x").first.click()
        tab.locator(".semmap-heading").get_by_text("<img src=x").wait_for()
        client.send(Remove(names=(name, room)))
    assert tab.title() == "semmap"
    assert tab.locator("img[src=x]").count() == 0


def _forge_heartbeat(system, text):
    """Publish a heartbeat of the recorder, which this system does not have, with a text in each field."""
    beat = Health(
        node="recorder",
        host=text,
        pid=1,
        started_ns=1,
        stamp_ns=time.time_ns(),
        state="ready",
        detail=text,
        last_error=text,
        notes=(text,),
    )
    with bus.open_session(bus.Network(connect=(system.endpoint,))) as session:
        session.put(keys.health_key("recorder"), codec.encode(beat))
