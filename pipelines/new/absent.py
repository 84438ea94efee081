"""The source of a plant without one of its signals: an input that nothing drives, or an output not measured.

What belongs to the signal is cut out of the text, where Python's own parser says that it stands. All else
stays as it is written, comments too.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

UNDRIVEN = "nothing drives it"


@dataclass(frozen=True)
class _Cut:
    """Bytes of a text, from ``start`` to ``stop``, and what takes their place."""

    start: int
    stop: int
    by: str = ""


class _Source:
    """A plant's text and its syntax tree."""

    def __init__(self, text: str) -> None:
        self.raw = text.encode()
        self.tree = ast.parse(text)
        lines = self.raw.splitlines(keepends=True)
        self._starts = [sum(map(len, lines[:k])) for k in range(len(lines))]

    def start(self, node: ast.expr | ast.keyword | ast.stmt) -> int:
        """The first byte of a node."""
        return self._starts[node.lineno - 1] + node.col_offset

    def stop(self, node: ast.expr | ast.keyword | ast.stmt) -> int:
        """The byte after its last one."""
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self._starts[node.end_lineno - 1] + node.end_col_offset

    def without(self, cuts: Sequence[_Cut]) -> str:
        """The text with all ``cuts`` made."""
        raw = self.raw
        for cut in sorted(cuts, key=lambda one: one.start, reverse=True):
            raw = raw[: cut.start] + cut.by.encode() + raw[cut.stop :]
        return raw.decode()

    def calls(self, name: str) -> Iterator[ast.Call]:
        """The calls of ``name``, as of ``Signal``."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name:
                yield node

    def entries(self) -> Iterator[tuple[ast.Dict, int, str]]:
        """Each entry of a dictionary with a text as its key: the dictionary, its place, the key."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Dict):
                for k, key in enumerate(node.keys):
                    if isinstance(key, ast.Constant) and isinstance(key.value, str):
                        yield node, k, key.value

    def element(self, group: ast.Tuple, gone: ast.expr) -> _Cut:
        """Cuts one of a tuple's elements; one that is left alone keeps its comma."""
        left = [one for one in group.elts if one is not gone]
        if len(left) == 1:
            kept = self.raw[self.start(left[0]) : self.stop(left[0])].decode()
            return _Cut(self.start(group), self.stop(group), f"({kept},)")
        spans = [(self.start(one), self.stop(one)) for one in group.elts]
        return self.listed(spans, group.elts.index(gone), self.stop(group) - 1)

    def entry(self, group: ast.Dict, k: int) -> _Cut:
        """Cuts the entry ``k`` of a dictionary."""
        pairs = zip(group.keys, group.values, strict=True)
        spans = [(self.start(key or value), self.stop(value)) for key, value in pairs]
        return self.listed(spans, k, self.stop(group) - 1)

    def keyword(self, call: ast.Call, gone: ast.keyword) -> _Cut:
        """Cuts one of a call's keywords."""
        words: list[ast.expr | ast.keyword] = [*call.args, *call.keywords]
        spans = [(self.start(one), self.stop(one)) for one in words]
        return self.listed(spans, len(call.args) + call.keywords.index(gone), self.stop(call) - 1)

    def method(self, name: str) -> _Cut:
        """Cuts a method, up to the next one."""
        methods = [node for node in ast.walk(self.tree) if isinstance(node, ast.FunctionDef)]
        starts = sorted(map(self.start, methods))
        start = next(self.start(one) for one in methods if one.name == name)
        return _Cut(start, starts[starts.index(start) + 1])

    @staticmethod
    def listed(spans: Sequence[tuple[int, int]], k: int, end: int) -> _Cut:
        """Cuts the ``k``-th of what stands between commas, with one of them."""
        if k + 1 < len(spans):
            return _Cut(spans[k][0], spans[k + 1][0])
        return _Cut(spans[k - 1][1], spans[k][1]) if k else _Cut(spans[k][0], end)


def without(text: str, signal: str, known: str) -> str:
    """The plant's source ``text`` without ``signal``, and with the parameter ``known`` fixed."""
    for rule in (_declared, _observing, _shown, _carried, _driven):
        source = _Source(text)
        text = source.without(list(rule(source, signal)))
    source = _Source(text)
    return source.without(list(_fixed(source, known)))


def _named(node: ast.expr, signal: str) -> bool:
    """Whether a call's first argument is the text ``signal``."""
    first = node.args[0] if isinstance(node, ast.Call) and node.args else None
    return isinstance(first, ast.Constant) and first.value == signal


def _declared(source: _Source, signal: str) -> Iterator[_Cut]:
    """Its ``Signal``, and the ``Port`` that it passes through."""
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Tuple):
            for one in node.elts:
                if _named(one, signal):
                    yield source.element(node, one)


def _observing(source: _Source, signal: str) -> Iterator[_Cut]:
    """What says that a state is the signal, or a derivative of it."""
    for state in source.calls("State"):
        words = {word.arg: word for word in state.keywords}
        by = words.get("observed_by")
        if by is not None and isinstance(by.value, ast.Constant) and by.value.value == signal:
            yield source.keyword(state, by)
            if "derivative" in words:
                yield source.keyword(state, words["derivative"])


def _shown(source: _Source, signal: str) -> Iterator[_Cut]:
    """Its entry in what ``output`` gives."""
    for group, k, key in source.entries():
        if key == signal:
            yield source.entry(group, k)


def _carried(source: _Source, signal: str) -> Iterator[_Cut]:
    """The drive of each contact that it is; where no contact has a load then, the whole method."""
    for group, k, port in source.entries():
        load = group.values[k]
        drive = _drive(load, signal)
        if drive is None or not isinstance(load, ast.Call):
            continue
        alone = len(load.keywords) == 1
        yield from _undriven(source, port, alone)
        if alone and len(group.keys) == 1:
            yield source.method("loads")
        else:
            yield source.entry(group, k) if alone else source.keyword(load, drive)


def _drive(load: ast.expr, signal: str) -> ast.keyword | None:
    """The keyword ``drive`` of a ``Load``, where it is the input."""
    if not (isinstance(load, ast.Call) and isinstance(load.func, ast.Name) and load.func.id == "Load"):
        return None
    return next((one for one in load.keywords if one.arg == "drive" and _is_input(one.value, signal)), None)


def _undriven(source: _Source, port: str, alone: bool) -> Iterator[_Cut]:
    """The words of a ``Port`` on its drive: cut, or, if it has no load either, what says so."""
    for call in source.calls("Port"):
        for word in call.keywords:
            if _named(call, port) and word.arg == "drive":
                said = _Cut(source.start(word), source.stop(word), f'no_load="{UNDRIVEN}"')
                yield said if alone else source.keyword(call, word)


def _is_input(node: ast.expr, signal: str) -> bool:
    """Whether it is ``u.signal``."""
    return (
        isinstance(node, ast.Attribute)
        and node.attr == signal
        and isinstance(node.value, ast.Name)
        and node.value.id == "u"
    )


def _driven(source: _Source, signal: str) -> Iterator[_Cut]:
    """It is zero in the equations: ``u.force - F`` becomes ``-F``, ``z - u.road`` becomes ``z``."""
    done = set()
    for node in ast.walk(source.tree):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub):
            if _is_input(node.left, signal):
                sign = source.raw.index(b"-", source.stop(node.left))
                after = sign + 1 + (source.raw[sign + 1 : sign + 2] == b" ")
                yield _Cut(source.start(node.left), after, "-")
                done.add(node.left)
            elif _is_input(node.right, signal):
                yield _Cut(source.stop(node.left), source.stop(node.right))
                done.add(node.right)
    for node in ast.walk(source.tree):
        if isinstance(node, ast.expr) and _is_input(node, signal) and node not in done:
            yield _Cut(source.start(node), source.stop(node), "0.0")


def _fixed(source: _Source, known: str) -> Iterator[_Cut]:
    """A parameter that is known now: it stays where its guess is."""
    for call in source.calls("Parameter"):
        if _named(call, known) and all(word.arg != "fixed" for word in call.keywords):
            guess = next(word for word in call.keywords if word.arg == "guess")
            yield _Cut(source.stop(guess), source.stop(guess), ", fixed=True")
