"""The requests for a class, with a stub of the system."""

import asyncio
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.extern.web.class_requests import ClassRequests
from semmap.schemas import errors
from semmap.schemas.commands import Add
from semmap.schemas.sparql import SparqlResult
from tests.extern.web.views.sample_maps import class_

CUP, MUG = class_("Cup"), class_("Mug")
CLASH = errors.Inconsistent("the cup is a plate")


class Live:
    """A stub with one reply to all queries, and one to all dry runs."""

    commit = 7
    roles = ("add",)

    def __init__(self):
        self.asked = []
        self.query_error = self.add_error = None

    def is_allowed(self, command):
        return command in self.roles

    async def ask(self, command, timeout_s=10.0):
        self.asked.append(type(command).__name__)
        error = self.add_error if isinstance(command, Add) else self.query_error
        if error is not None:
            raise error
        assert getattr(command, "dry_run", True)
        return SparqlResult(kind="select", rows=(("<s>", "<p>", "<o>"),), seq=7)


ALL = ["Sparql", "Sparql", "Add"]


@pytest.fixture
def live():
    return Live()


def reports(live, *steps):
    """Return the report and the requests of each step: a class and the version of the ontology."""

    async def scenario():
        knowledge = SimpleNamespace(ontology_version=0)
        requests = ClassRequests(live, knowledge)
        found = []
        for known, version in steps:
            knowledge.ontology_version = version
            live.asked = []
            found.append((await requests.fetch(known), live.asked))
        return found

    return asyncio.run(scenario())


def test_requests_are_sent_again_only_for_another_class_or_ontology(live):
    live.add_error = CLASH
    found = reports(live, (CUP, 0), (CUP, 0), (CUP, 1), (MUG, 1), (MUG, 1), (CUP, 1))
    assert [asked for _, asked in found] == [ALL, [], ALL, ALL, [], ALL]
    report = found[1][0]
    assert report.axioms == report.users == (("<s>", "<p>", "<o>"),)
    assert (report.clash, report.commit, report.problem) == (CLASH, 7, None)


@pytest.mark.parametrize("error", [errors.Refused("no free place"), errors.BadRequest("no size")])
def test_other_rejections_are_not_about_the_class(live, error):
    live.add_error = error
    (report, _), (_, asked) = reports(live, (CUP, 0), (CUP, 0))
    assert (report.clash, report.problem, asked) == (None, None, [])


@pytest.mark.parametrize(
    "error", [errors.NoAnswer("lost"), errors.Busy("full"), errors.InternalError("fault")]
)
@pytest.mark.parametrize("failing", ["query_error", "add_error"])
def test_failed_requests_are_repeated(live, failing, error):
    setattr(live, failing, error)
    (report, _), (_, asked) = reports(live, (CUP, 0), (CUP, 0))
    assert report.problem is error
    assert asked == (["Sparql"] if failing == "query_error" else ALL)


def test_a_rejected_query_is_not_repeated(live):
    live.query_error = errors.Refused("the query took longer than 20 s")
    (report, _), (_, asked) = reports(live, (CUP, 0), (CUP, 0))
    assert (report.problem, asked) == (live.query_error, [])


def test_nothing_is_tried_without_permission_or_for_a_class_of_other_things(live):
    assert reports(live, (structs.replace(CUP, spatial=False), 0))[0][1] == ["Sparql", "Sparql"]
    live.roles = ()
    assert reports(live, (CUP, 0))[0][1] == ["Sparql", "Sparql"]
