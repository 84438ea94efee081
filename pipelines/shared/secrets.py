"""Passwords and tokens: kept in the environment alone, left out of what is stored, masked in what is said.

A password may stand in the address of a tracking server, ``https://user:password@host``. It is moved to the
environment as soon as it is read, under the names by which MLflow looks for it. Processes that are started
later inherit it; no file ever holds it.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Mapping, Sequence
from typing import Any, TextIO, cast
from urllib.parse import quote, unquote

USERNAME, PASSWORD = "MLFLOW_TRACKING_USERNAME", "MLFLOW_TRACKING_PASSWORD"
"""Where MLflow finds what it shows to a server."""
DATABASE_PASSWORD = "HYBRIDID_DATABASE_PASSWORD"  # nosec B105
"""Where the password of a database stands, for an address like ``postgresql://user@host/runs``."""
HIDDEN = "***"

# Hydra prints a colon of an override as \:
_COLON = r"\\?:"
_SCHEME = rf"(?P<scheme>[A-Za-z][A-Za-z0-9+.-]*{_COLON}//)"
_WITH_PASSWORD = re.compile(rf"{_SCHEME}(?P<user>[^\s/?#:@\\\"']*){_COLON}(?P<password>[^\s/?#\"']+)@")
_LOGIN_ALONE = re.compile(rf"(?P<scheme>\bhttps?{_COLON}//)(?P<user>[^\s/?#:@\\\"']+)@")
_IN_QUERY = re.compile(
    r"([?&][\w.-]*(?:password|passwd|token|secret|signature|sig|api_?key|access_?key)=)[^&\s\"'#]+", re.I
)
_HEADER = re.compile(r"\b(Basic|Bearer) +[A-Za-z0-9+/=_.~-]{6,}")
_OF_THE_STORE = (PASSWORD, "MLFLOW_TRACKING_TOKEN", DATABASE_PASSWORD)
_NAMES = re.compile(r"(PASSWORD|PASSWD|TOKEN|SECRET|SECRET_KEY|ACCESS_KEY|API_KEY|CONNECTION_STRING)$")
_LONG = 8
"""Shorter passwords of the store are masked only where they stand alone, for they may be parts of words.
Shorter values of other variables are no secrets but switches."""


def masked(text: object) -> str:
    """``text`` without passwords in addresses, credentials in headers, and secrets of the environment."""
    said = str(text)
    if "//" in said:
        said = _WITH_PASSWORD.sub(rf"\g<scheme>{HIDDEN}@", said)
        said = _LOGIN_ALONE.sub(rf"\g<scheme>{HIDDEN}@", said)
        said = _IN_QUERY.sub(rf"\1{HIDDEN}", said)
    said = _HEADER.sub(rf"\1 {HIDDEN}", said)
    for secret in _of_environment():
        if secret in said:
            said = _alone(secret).sub(HIDDEN, said) if len(secret) < _LONG else said.replace(secret, HIDDEN)
    return said


def masked_below(value: Any) -> Any:
    """Mappings and lists with all their texts masked."""
    if isinstance(value, Mapping):
        return {key: masked_below(below) for key, below in value.items()}
    if isinstance(value, list | tuple):
        return [masked_below(below) for below in value]
    return masked(value) if isinstance(value, str) else value


def moved_to_environment(config: Mapping[str, Any]) -> dict[str, Any]:
    """``config`` with the password of ``mlflow.tracking_uri`` in the environment instead."""
    mlflow = config.get("mlflow")
    if not isinstance(mlflow, Mapping) or not isinstance(mlflow.get("tracking_uri"), str):
        return dict(config)
    return {**config, "mlflow": {**mlflow, "tracking_uri": noted(mlflow["tracking_uri"])}}


def typed(words: Sequence[str]) -> list[str]:
    """The ``words`` of a command with the password of ``mlflow.tracking_uri`` in the environment instead."""
    return [noted(word) if word.lstrip("+'\"").startswith("mlflow") else word for word in words]


def noted(uri: str) -> str:
    """``uri`` without its password, which is set in the environment."""
    found = _WITH_PASSWORD.search(uri) or _LOGIN_ALONE.search(uri)
    if found is None:
        return uri
    password = unquote(found.groupdict().get("password") or "")
    if not _is_server(found["scheme"]):
        os.environ[DATABASE_PASSWORD] = password
    else:
        os.environ[USERNAME] = unquote(found["user"])
        if password:
            os.environ[PASSWORD] = password
    return without_password(uri)


def without_password(uri: str) -> str:
    """``uri`` without its password; a server's also without the user, which MLflow takes from elsewhere."""

    def left(found: re.Match[str]) -> str:
        server = _is_server(found["scheme"])
        return found["scheme"] if server else f"{found['scheme']}{found['user']}@"

    return _LOGIN_ALONE.sub(r"\g<scheme>", _WITH_PASSWORD.sub(left, uri))


def with_password(uri: str) -> str:
    """``uri`` of a database with the password from the environment, if it has a user and no password."""
    password = os.environ.get(DATABASE_PASSWORD)
    scheme, there, rest = uri.partition("://")
    user, at, host = rest.partition("@")
    if not (password and there and at and user) or ":" in user or "/" in user or _is_server(f"{scheme}://"):
        return uri
    return f"{scheme}://{user}:{quote(password, safe='')}@{host}"


def credentials(uri: str) -> tuple[str, ...]:
    """The variables of the environment from which a store at ``uri`` now takes user and password."""
    names = (USERNAME, PASSWORD) if _is_server(uri) else (DATABASE_PASSWORD,) if "@" in uri else ()
    return tuple(name for name in names if os.environ.get(name))


class _MaskedStream:
    """A text stream on which no secret appears."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        self._stream.write(masked(text))
        return len(text)

    def writelines(self, lines: Sequence[str]) -> None:
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def mask_streams() -> None:
    """Mask all that this process prints from now on: tracebacks of libraries and their logs, too."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is not None and not isinstance(stream, _MaskedStream):
            setattr(sys, name, cast(TextIO, _MaskedStream(stream)))


def _of_environment() -> list[str]:
    """The secrets of the environment, as they stand there and as they stand in an address; the longest
    first, for one may be part of another."""
    values = {value for name, value in os.environ.items() if _NAMES.search(name) and len(value) >= _LONG}
    values |= {value for name in _OF_THE_STORE if len(value := os.environ.get(name, "")) > 3}
    return sorted(values | {quote(value, safe="") for value in values}, key=len, reverse=True)


def _alone(secret: str) -> re.Pattern[str]:
    return re.compile(rf"(?<!\w){re.escape(secret)}(?!\w)")


def _is_server(scheme: str) -> bool:
    return scheme.startswith(("http:", "https:", "http\\:", "https\\:"))
