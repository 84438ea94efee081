"""``content_digest``: a digest of the arguments of a call, the same in every process.

The bytes of a pickle depend on which parts of an object are one and the same, and that differs after a way
through a file. So the content is read: numbers, texts, arrays, and the fields of dataclasses. Of other
objects (functions, plants, CasADi expressions) the name or the type counts, and of the fields named
``seconds`` nothing: they say how long something took.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

LENGTH = 16
"""Hexadecimal digits of a digest: that two of a million calls share one has a probability of 3e-8."""


def content_digest(content: Any) -> str:
    """The digest of what ``content`` holds."""
    total = hashlib.sha256()
    for part in _parts(content):
        total.update(part)
        total.update(b"\0")
    return total.hexdigest()[:LENGTH]


def _parts(content: Any) -> Iterator[bytes]:
    yield type(content).__qualname__.encode()
    if is_dataclass(content) and not isinstance(content, type):
        content = {one.name: getattr(content, one.name) for one in fields(content) if one.name != "seconds"}
    if isinstance(content, Mapping):
        content = sorted(content.items(), key=lambda item: repr(item[0]))
    if isinstance(content, (set, frozenset)):
        content = sorted(content, key=repr)
    if isinstance(content, (list, tuple)):
        yield str(len(content)).encode()  # where it ends
        for one in content:
            yield from _parts(one)
    elif isinstance(content, np.ndarray):
        yield repr((content.shape, content.dtype.str)).encode()
        yield np.ascontiguousarray(content).tobytes()
    elif content is None or isinstance(content, (bool, int, float, str)):
        yield repr(content).encode()
    else:
        yield str(getattr(content, "__qualname__", "")).encode()
