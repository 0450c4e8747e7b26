"""A user's Zenoh configuration file: read, and checked for errors that Zenoh ignores."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

import zenoh

from semmap.schemas import errors

_DECIDED: Final = {
    "mode": "each process has a different mode",
    "id": "each process has a different id",
    "namespace": "use --namespace",
    "connect/endpoints": "use --connect",
    "listen/endpoints": "use --listen",
}
"""The settings that semmap makes itself, with the alternative."""
_FROM_KEYS: Final = ("access_control", "transport/link/tls")
_ACCESS: Final = "access_control"
_TLS: Final = "transport/link/tls"


def read(path: str) -> zenoh.Config:
    """Return the configuration in a file. Raises BadFile."""
    if not Path(path).is_file():
        raise errors.BadFile(f"there is no file {path}")
    try:
        return zenoh.Config.from_file(path)
    except zenoh.ZError as error:
        reason = " ".join(str(error).split(" at /", 1)[0].split())
        raise errors.BadFile(f"{path} is not a Zenoh configuration: {reason}") from None


def require_sound(path: str, *, secure: bool) -> None:
    """Raise BadFile if a file is unreadable, sets what semmap decides, or has rules without effect.

    With `secure`, TLS and access control come from the folder of keys and must not be set.
    """
    own, default = read(path), zenoh.Config()
    for key, instead in _DECIDED.items():
        if own.get_json(key) != default.get_json(key):
            raise errors.BadFile(f"{path} sets {key}, which semmap sets itself: {instead}")
    for key in _FROM_KEYS if secure else ():
        if own.get_json(key) != default.get_json(key):
            raise errors.BadFile(f"{path} sets {key}, which --secure creates from the folder of keys")
    for key, value in json.loads(own.get_json(_TLS)).items():
        if key.endswith(("_certificate", "_private_key")) and value and not Path(value).is_file():
            raise errors.BadFile(f"{path}: {key}: the file {value} does not exist")
    _require_rules_that_count(path, json.loads(own.get_json(_ACCESS)))


def is_protected(path: str) -> bool:
    """Return whether only clients with a certificate are admitted."""
    tls = json.loads(read(path).get_json(_TLS))
    return bool(tls["enable_mtls"] and tls["root_ca_certificate"])


def _require_rules_that_count(path: str, access: dict[str, Any]) -> None:
    """Raise BadFile for access rules that Zenoh accepts but ignores: disabled or undefined ones."""
    rules, subjects, policies = (access[part] or [] for part in ("rules", "subjects", "policies"))
    if (rules or policies) and not access["enabled"]:
        raise errors.BadFile(f"{path}: access_control has rules but is not enabled; set enabled: true")
    known = {"rules": {rule["id"] for rule in rules}, "subjects": {subject["id"] for subject in subjects}}
    for policy in policies:
        for part, ids in known.items():
            if missing := [i for i in policy[part] if i not in ids]:
                raise errors.BadFile(
                    f"{path}: a policy of access_control uses {', '.join(missing)},"
                    f" which is not defined in {part}"
                )
