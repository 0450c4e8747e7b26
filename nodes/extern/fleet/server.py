"""A SPARQL 1.1 server, spoken to by the SPARQL 1.1 Protocol over one connection that is kept."""

from __future__ import annotations

import base64
import json
import ssl
from collections.abc import Sequence
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from typing import Any, Final, NamedTuple
from urllib.parse import unquote, urlencode, urlsplit

from semmap.schemas import errors
from semmap.schemas.explanations import Term
from semmap.schemas.sparql import Row, SparqlResult

TIMEOUT_S: Final = 30.0
_RESULTS: Final = "application/sparql-results+json"
_LONGEST: Final = 300
_CLOSED: Final = (ConnectionError, HTTPException)
"""What becomes of a kept connection that the server has closed meanwhile."""


class _Answer(NamedTuple):
    status: int
    body: bytes


class SparqlServer:
    """The update or the query endpoint of a server. Owned by one thread."""

    def __init__(self, url: str, *, timeout_s: float = TIMEOUT_S) -> None:
        """Raises BadRequest for what is no URL of HTTP; user and password may be in it."""
        try:
            parts = urlsplit(url)
            sound = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
        except ValueError:
            sound = False
        if not sound:
            raise errors.BadRequest(
                f"'{url}' is not the URL of a SPARQL server; example: http://127.0.0.1:7878/update"
            )
        self._host, self._port = str(parts.hostname), parts.port
        self._is_tls = parts.scheme == "https"
        self._path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
        at = self._host if parts.port is None else f"{self._host}:{parts.port}"
        self.url = f"{parts.scheme}://{at}{self._path}"
        """Without user and password."""
        self._headers = {"User-Agent": "semmap"}
        if parts.username is not None:
            said = f"{unquote(parts.username)}:{unquote(parts.password or '')}"
            self._headers["Authorization"] = f"Basic {base64.b64encode(said.encode()).decode()}"
        self._timeout_s = timeout_s
        self._connection: HTTPConnection | None = None

    def update(self, operations: Sequence[str]) -> None:
        """Carry out operations in one request.

        Raises BadRequest for what the server finds wrong with it, Refused when it wants to know who asks or
        does not know the URL, and NoAnswer for a server that is down, slow or in trouble.
        """
        self._send(";\n".join(operations).encode(), "application/sparql-update", "*/*")

    def query(self, query: str, *, default: Sequence[str] = (), named: Sequence[str] = ()) -> SparqlResult:
        """The rows or the verdict; of `default` graphs, or else of the server's own. Raises as `update`."""
        fields = [("query", query)]
        fields += [("default-graph-uri", graph) for graph in default]
        fields += [("named-graph-uri", graph) for graph in named]
        body = urlencode(fields).encode()
        return _result(self._send(body, "application/x-www-form-urlencoded", _RESULTS), self.url)

    def close(self) -> None:
        """Hang up."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _send(self, body: bytes, kind: str, wanted: str) -> bytes:
        headers = {**self._headers, "Content-Type": kind, "Accept": wanted}
        try:
            answer = self._exchange(body, headers)
        except TimeoutError:
            self.close()
            raise errors.NoAnswer(f"{self.url} did not answer within {self._timeout_s:g} s") from None
        except (OSError, HTTPException) as error:
            self.close()
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            raise errors.NoAnswer(f"no SPARQL server answers at {self.url}: {reason}") from None
        if 200 <= answer.status < 300:
            return answer.body
        raise self._error(answer)

    def _exchange(self, body: bytes, headers: dict[str, str]) -> _Answer:
        """Send and receive; over a new connection where the kept one turns out to be closed."""
        kept = self._connection is not None
        try:
            return self._exchange_over(self._open(), body, headers)
        except _CLOSED:
            self.close()
            if not kept:
                raise
            return self._exchange_over(self._open(), body, headers)

    def _exchange_over(self, connection: HTTPConnection, body: bytes, headers: dict[str, str]) -> _Answer:
        connection.request("POST", self._path, body, headers)
        response = connection.getresponse()
        return _Answer(response.status, response.read())

    def _open(self) -> HTTPConnection:
        if self._connection is None:
            if self._is_tls:
                context = ssl.create_default_context()
                self._connection = HTTPSConnection(
                    self._host, self._port, timeout=self._timeout_s, context=context
                )
            else:
                self._connection = HTTPConnection(self._host, self._port, timeout=self._timeout_s)
        return self._connection

    def _error(self, answer: _Answer) -> errors.SemmapError:
        said = " ".join(answer.body.decode(errors="replace").split())[:_LONGEST]
        if answer.status in (401, 403):
            return errors.Refused(
                f"{self.url} does not let this program in ({answer.status}); give a user and a password"
                " in the URL: http://USER:PASSWORD@HOST/..."
            )
        if answer.status in (404, 405):
            return errors.Refused(
                f"there is no SPARQL endpoint at {self.url} ({answer.status}); Oxigraph's are /update and"
                " /query, Virtuoso's is /sparql"
            )
        if answer.status in (400, 413, 415, 422):
            return errors.BadRequest(f"{self.url} does not take the request ({answer.status}): {said}")
        return errors.NoAnswer(f"{self.url} is in trouble ({answer.status}): {said or 'it does not say why'}")


def _result(body: bytes, url: str) -> SparqlResult:
    try:
        document = json.loads(body)
        if "boolean" in document:
            return SparqlResult(kind="ask", verdict=bool(document["boolean"]), seq=0)
        variables = tuple(document["head"]["vars"])
        if variables == (_ASKED_OF_VIRTUOSO,):
            (binding,) = document["results"]["bindings"]
            return SparqlResult(kind="ask", verdict=binding[_ASKED_OF_VIRTUOSO]["value"] == "1", seq=0)
        rows: tuple[Row, ...] = tuple(
            tuple(_term(binding.get(name)) for name in variables)
            for binding in document["results"]["bindings"]
        )
    except (ValueError, KeyError, TypeError, AttributeError):
        raise errors.NoAnswer(
            f"{url} does not answer with results of SPARQL in JSON; is it the query endpoint?"
        ) from None
    return SparqlResult(kind="select", variables=variables, rows=rows, seq=0)


def _term(value: Any) -> Term | None:
    """As N-Triples."""
    if value is None:
        return None
    content = str(value["value"])
    if value["type"] == "uri":
        return f"<{content}>"
    if value["type"] == "bnode":
        return f"_:{content}"
    escaped = content.translate(_ESCAPED)
    if language := value.get("xml:lang"):
        return f'"{escaped}"@{language}'
    datatype = value.get("datatype")
    return f'"{escaped}"' if datatype in (None, _STRING) else f'"{escaped}"^^<{datatype}>'


_ASKED_OF_VIRTUOSO: Final = "__ASK_RETVAL"
"""Virtuoso 7 answers an ASK with a row."""
_STRING: Final = "http://www.w3.org/2001/XMLSchema#string"
_ESCAPED: Final = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r"})
