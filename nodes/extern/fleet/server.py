"""A client of a SPARQL 1.1 server, which uses the SPARQL 1.1 Protocol over a persistent connection."""

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
"""The errors of a persistent connection that the server has closed."""


class _Answer(NamedTuple):
    status: int
    body: bytes


class SparqlServer:
    """The update or the query endpoint of a server. Owned by one thread."""

    def __init__(self, url: str, *, timeout_s: float = TIMEOUT_S) -> None:
        """Raise BadRequest unless `url` is an HTTP URL; it may include a user and a password."""
        try:
            parts = urlsplit(url)
            is_valid = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
        except ValueError:
            is_valid = False
        if not is_valid:
            raise errors.BadRequest(
                f"'{url}' is not the URL of a SPARQL server; example: http://127.0.0.1:7878/update"
            )
        self._host, self._port = str(parts.hostname), parts.port
        self._is_tls = parts.scheme == "https"
        self._path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
        at = self._host if parts.port is None else f"{self._host}:{parts.port}"
        self.url = f"{parts.scheme}://{at}{self._path}"
        """The URL without user and password."""
        self._headers = {"User-Agent": "semmap"}
        if parts.username is not None:
            user = f"{unquote(parts.username)}:{unquote(parts.password or '')}"
            self._headers["Authorization"] = f"Basic {base64.b64encode(user.encode()).decode()}"
        self._timeout_s = timeout_s
        self._connection: HTTPConnection | None = None

    def update(self, operations: Sequence[str]) -> None:
        """Execute operations in one request.

        Raises BadRequest if the server rejects the request, Refused for missing permissions or a wrong URL,
        and NoAnswer if the server is down, slow or reports an internal error.
        """
        self._send(";\n".join(operations).encode(), "application/sparql-update", "*/*")

    def query(self, query: str, *, default: Sequence[str] = (), named: Sequence[str] = ()) -> SparqlResult:
        """Return the result of a query on the `default` and `named` graphs. Raises as `update`."""
        fields = [("query", query)]
        fields += [("default-graph-uri", graph) for graph in default]
        fields += [("named-graph-uri", graph) for graph in named]
        body = urlencode(fields).encode()
        return _result(self._send(body, "application/x-www-form-urlencoded", _RESULTS), self.url)

    def close(self) -> None:
        """Close the connection."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _send(self, body: bytes, kind: str, wanted: str) -> bytes:
        headers = {**self._headers, "Content-Type": kind, "Accept": wanted}
        try:
            answer = self._exchange(body, headers)
        except TimeoutError:
            self.close()
            raise errors.NoAnswer(f"no response from {self.url} within {self._timeout_s:g} s") from None
        except (OSError, HTTPException) as error:
            self.close()
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            raise errors.NoAnswer(f"no response from the SPARQL server at {self.url}: {reason}") from None
        if 200 <= answer.status < 300:
            return answer.body
        raise self._error(answer)

    def _exchange(self, body: bytes, headers: dict[str, str]) -> _Answer:
        """Send a request and receive the response, over a new connection if the current one is closed."""
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
        text = " ".join(answer.body.decode(errors="replace").split())[:_LONGEST]
        if answer.status in (401, 403):
            return errors.Refused(
                f"{self.url}: access denied ({answer.status}); add user and password to the URL:"
                " http://USER:PASSWORD@HOST/..."
            )
        if answer.status in (404, 405):
            return errors.Refused(
                f"there is no SPARQL endpoint at {self.url} ({answer.status}); Oxigraph uses /update and"
                " /query, Virtuoso uses /sparql"
            )
        if answer.status in (400, 413, 415, 422):
            return errors.BadRequest(f"{self.url} rejected the request ({answer.status}): {text}")
        return errors.NoAnswer(f"{self.url}: server error ({answer.status}): {text or 'no details'}")


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
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise errors.NoAnswer(
            f"{url} does not return SPARQL results in JSON; check that it is the query endpoint"
        ) from None
    return SparqlResult(kind="select", variables=variables, rows=rows, seq=0)


def _term(value: Any) -> Term | None:
    """Return a term of a JSON result in the syntax of N-Triples."""
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
"""The variable in the reply of Virtuoso 7 to an ASK query, which is a row."""
_STRING: Final = "http://www.w3.org/2001/XMLSchema#string"
_ESCAPED: Final = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r"})
