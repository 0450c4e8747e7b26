"""A Zenoh configuration file of one's own: read, and checked for what Zenoh accepts in silence."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

import zenoh

from semmap.schemas import errors

_DECIDED: Final = {
    "mode": "it differs from process to process",
    "id": "every process has its own",
    "namespace": "use --namespace",
    "connect/endpoints": "use --connect",
    "listen/endpoints": "use --listen",
}
"""What semmap sets itself, and what to do instead."""
_FROM_KEYS: Final = ("access_control", "transport/link/tls")
_ACCESS: Final = "access_control"
_TLS: Final = "transport/link/tls"


def read(path: str) -> zenoh.Config:
    """The configuration in a file. Raises BadFile."""
    if not Path(path).is_file():
        raise errors.BadFile(f"there is no file {path}")
    try:
        return zenoh.Config.from_file(path)
    except zenoh.ZError as error:
        reason = " ".join(str(error).split(" at /", 1)[0].split())
        raise errors.BadFile(f"{path} is not a Zenoh configuration: {reason}") from None


def require_sound(path: str, *, secure: bool) -> None:
    """Raises BadFile for a file that cannot be read, sets what semmap decides, or would not do what it says.

    Under `secure`, TLS and access control are made from the folder of keys and cannot be set beside it.
    """
    own, default = read(path), zenoh.Config()
    for key, instead in _DECIDED.items():
        if own.get_json(key) != default.get_json(key):
            raise errors.BadFile(f"{path} sets {key}, which semmap decides: {instead}")
    for key in _FROM_KEYS if secure else ():
        if own.get_json(key) != default.get_json(key):
            raise errors.BadFile(f"{path} sets {key}, which --secure makes from the folder of keys")
    for key, value in json.loads(own.get_json(_TLS)).items():
        if key.endswith(("_certificate", "_private_key")) and value and not Path(value).is_file():
            raise errors.BadFile(f"{path}: {key} names {value}, and there is no such file")
    _require_rules_that_count(path, json.loads(own.get_json(_ACCESS)))


def is_protected(path: str) -> bool:
    """Does it let in only those with a certificate?"""
    tls = json.loads(read(path).get_json(_TLS))
    return bool(tls["enable_mtls"] and tls["root_ca_certificate"])


def _require_rules_that_count(path: str, access: dict[str, Any]) -> None:
    """Zenoh takes rules that are switched off, and policies of rules and subjects that are not there."""
    rules, subjects, policies = (access[part] or [] for part in ("rules", "subjects", "policies"))
    if (rules or policies) and not access["enabled"]:
        raise errors.BadFile(f"{path}: access_control has rules but is not enabled; say enabled: true")
    known = {"rules": {rule["id"] for rule in rules}, "subjects": {subject["id"] for subject in subjects}}
    for policy in policies:
        for part, ids in known.items():
            if missing := [i for i in policy[part] if i not in ids]:
                raise errors.BadFile(
                    f"{path}: a policy of access_control names {', '.join(missing)},"
                    f" which is not among the {part}"
                )
