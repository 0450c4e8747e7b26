import os
import socket

from semmap.nodes.extern.web.loads import measure_loads
from semmap.schemas.health import Health


def beat(pid, host):
    return Health(node="kb_node", host=host, pid=pid, started_ns=0, stamp_ns=0, state="ready")


def test_nodes_of_this_machine_have_a_load():
    load = measure_loads([beat(os.getpid(), socket.gethostname())])[os.getpid()]
    assert load.memory > 1 << 20
    assert load.cpu_s > 0.0


def test_dead_nodes_and_nodes_of_other_machines_have_no_load():
    assert measure_loads([beat(2**22 + 1, ""), beat(os.getpid(), "elsewhere")]) == {}
