"""All faults."""

from __future__ import annotations

from tests.faults.forgeries import FORGERIES
from tests.faults.mirrors import MIRRORS
from tests.faults.overload import OVERLOADS
from tests.faults.processes import PROCESSES
from tests.faults.resources import RESOURCES
from tests.faults.table import Fault

FAULTS: tuple[Fault, ...] = PROCESSES + RESOURCES + FORGERIES + OVERLOADS + MIRRORS
