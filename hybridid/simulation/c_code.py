"""A CasADi function as C, for the horizons that run side by side in lanes (``lanes.h``).

CasADi's own generator writes C for one number at a time. Here each operation of the function becomes one line
on four. What depends on the parameters and on the step alone is computed once a simulation (``prepare``).
What depends on the inputs beside these can be computed apart, once for all stages that have the same inputs
(``given``): a power of an input takes longer than all the rest of a stage.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

import casadi as ca

VARYING = ("x", "s", "t", "u")
"""Arguments with a number for each lane; ``h`` and ``p`` are the same in all."""
ARITHMETIC: Mapping[int, str] = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_ASSIGN: "{0}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "{0} + {0}",
    ca.OP_INV: "1.0 / {0}",
}
"""The same for one number and for lanes."""
OF_LANES: Mapping[int, str] = {
    ca.OP_LT: "TRUTH({0} < {1})",
    ca.OP_LE: "TRUTH({0} <= {1})",
    ca.OP_EQ: "TRUTH({0} == {1})",
    ca.OP_NE: "TRUTH({0} != {1})",
    ca.OP_NOT: "TRUTH({0} == 0.0)",
    ca.OP_AND: "TRUTH(({0} != 0.0) & ({1} != 0.0))",
    ca.OP_OR: "TRUTH(({0} != 0.0) | ({1} != 0.0))",
    ca.OP_IF_ELSE_ZERO: "ONLY_IF({0}, {1})",
    ca.OP_FABS: "ABSOLUTE({0})",
    ca.OP_SIGN: "SIGN({0})",
    ca.OP_COPYSIGN: "SIGNED_AS({0}, {1})",
    ca.OP_FMIN: "SMALLER({0}, {1})",
    ca.OP_FMAX: "LARGER({0}, {1})",
    ca.OP_EXP: "EXPONENTIAL({0})",
    ca.OP_TANH: "HYPERBOLIC_TANGENT({0})",
    ca.OP_LOG: "LOGARITHM({0})",
    ca.OP_SIN: "SINE({0})",
    ca.OP_COS: "COSINE({0})",
    ca.OP_SQRT: "ROOT({0})",
    ca.OP_POW: "POWER({0}, {1})",
    ca.OP_CONSTPOW: "POWER({0}, {1})",
}
"""The macros of lanes.h."""
OF_ONE: Mapping[int, str] = {
    ca.OP_LT: "{0} < {1}",
    ca.OP_LE: "{0} <= {1}",
    ca.OP_EQ: "{0} == {1}",
    ca.OP_NE: "{0} != {1}",
    ca.OP_NOT: "!{0}",
    ca.OP_AND: "{0} && {1}",
    ca.OP_OR: "{0} || {1}",
    ca.OP_IF_ELSE_ZERO: "{0} ? {1} : 0.0",
    ca.OP_FABS: "fabs({0})",
    ca.OP_SIGN: "({0} > 0) - ({0} < 0)",
    ca.OP_COPYSIGN: "copysign({0}, {1})",
    ca.OP_FMIN: "fmin({0}, {1})",
    ca.OP_FMAX: "fmax({0}, {1})",
    ca.OP_EXP: "exp({0})",
    ca.OP_TANH: "tanh({0})",
    ca.OP_LOG: "log({0})",
    ca.OP_SIN: "sin({0})",
    ca.OP_COS: "cos({0})",
    ca.OP_SQRT: "sqrt({0})",
    ca.OP_POW: "pow({0}, {1})",
    ca.OP_CONSTPOW: "pow({0}, {1})",
}
LIBRARY: Mapping[int, str] = {
    getattr(ca, f"OP_{name.upper()}"): name
    for name in (
        "log1p", "expm1", "tan", "asin", "acos", "atan", "sinh", "cosh", "asinh",
        "acosh", "atanh", "floor", "ceil", "erf",
    )
}  # fmt: skip
LIBRARY_OF_TWO: Mapping[int, str] = {
    ca.OP_ATAN2: "atan2",
    ca.OP_FMOD: "fmod",
    ca.OP_HYPOT: "hypot",
    ca.OP_REMAINDER: "remainder",
}
"""Functions of the C library: one lane after another."""


class Unwritten(ValueError):
    """A function has an operation that has no C here."""


@dataclass
class _Writer:
    """Writes a function instruction by instruction; holds the lines written so far.

    ``now`` names what each place of CasADi's work vector holds. ``shared`` are the names of what is the same
    in all lanes: some stand for a ``literal``, others are ``known`` from ``prepare``, each at its own place.
    ``slopes`` are the arguments that hold sensitivities, then also the names of what is made of them.
    ``places`` say where in an argument, or in ``slope``, a number lies.

    If ``apart``, what depends on the inputs u and on nothing else that varies is written to ``given``: its
    names are ``of_inputs``, those that ``run`` needs are ``kept``, each at its own place.
    """

    function: ca.Function
    arguments: tuple[str, ...]
    slopes: set[str]
    places: Mapping[str, Callable[[int], int]]
    apart: bool
    now: dict[int, str] = field(default_factory=dict)
    shared: set[str] = field(default_factory=set)
    literal: dict[str, str] = field(default_factory=dict)
    known: dict[str, int] = field(default_factory=dict)
    inverses: set[str] = field(default_factory=set)
    prepare: list[str] = field(default_factory=list)
    run: list[str] = field(default_factory=list)
    of_inputs: dict[str, str] = field(default_factory=dict)
    kept: dict[str, int] = field(default_factory=dict)
    given: list[str] = field(default_factory=list)

    def write(self, k: int) -> None:
        """Write instruction ``k``."""
        code, given = self.function.instruction_id(k), self.function.instruction_input(k)
        made = self.function.instruction_output(k)
        if code == ca.OP_OUTPUT:
            array, what = ("value", "slope")[made[0]], self.now[given[0]]
            spread = array in self.slopes and what not in self.slopes
            written = f"SPREAD({self.lanes(what)})" if spread else self.lanes(what)
            self.run.append(f"{array}[{self._place(array, made[1])}] = {written};")
            return
        name = f"v{k}"
        if code == ca.OP_CONST:
            self._alike(name, _number(self.function.instruction_constant(k)))
        elif code == ca.OP_INPUT:
            argument = self.arguments[given[0]]
            if argument == "u" and self.apart:
                self.of_inputs[name] = f"u[{given[1]}]"
            elif argument in VARYING:
                self._line(name, f"{argument}[{self._place(argument, given[1])}]", argument in self.slopes)
            else:
                self._alike(name, "h" if argument == "h" else f"p[{given[1]}]")
        else:
            self._operation(name, code, [self.now[place] for place in given])
        self.now[made[0]] = name

    def _alike(self, name: str, literal: str) -> None:
        self.shared.add(name)
        self.literal[name] = literal

    def _operation(self, name: str, code: int, given: list[str]) -> None:
        if self.shared.issuperset(given):
            values = [self.literal.get(one, one) for one in given]
            self.prepare.append(f"const double {name} = {_of_one(code).format(*values)};")
            self.shared.add(name)
        elif code == ca.OP_DIV and not self.of_inputs.keys() & given:
            self._operation(name, ca.OP_MUL, [given[0], self._inverse(given[1])])
        else:
            slope = not self.slopes.isdisjoint(given)
            if slope and code not in ARITHMETIC:
                raise Unwritten(f"operation {code} of CasADi has no C for sensitivities")
            if all(one in self.shared or one in self.of_inputs for one in given):
                values = [self.of_inputs.get(one) or self.lanes(one) for one in given]
                self.given.append(f"const Lanes {name} = {_of_lanes(code).format(*values)};")
                self.of_inputs[name] = name
            else:
                self._line(name, _of_lanes(code).format(*map(self.lanes, given)), slope)

    def _line(self, name: str, value: str, slope: bool) -> None:
        self.run.append(f"const {'Slope' if slope else 'Lanes'} {name} = {value};")
        if slope:
            self.slopes.add(name)

    def _place(self, array: str, index: int) -> int:
        return self.places[array](index) if array in self.places else index

    def _inverse(self, name: str) -> str:
        """1 over ``name``, computed once: a division takes as long as ten products."""
        inverse = f"{name}_inverse"
        if inverse not in self.inverses:
            self.inverses.add(inverse)
            self._operation(inverse, ca.OP_INV, [name])
        return inverse

    def lanes(self, name: str) -> str:
        """What stands for ``name`` in a line on lanes of ``run``."""
        if name in self.of_inputs:
            computed = self.of_inputs[name] == name
            return f"e[{self.kept.setdefault(name, len(self.kept))}]" if computed else self.of_inputs[name]
        if name not in self.shared:
            return name
        if name in self.literal:
            return f"FILL({self.literal[name]})"
        return f"FILL(c[{self.known.setdefault(name, len(self.known))}])"


def c_of(
    function: ca.Function,
    arguments: tuple[str, ...],
    slopes: Collection[str] = (),
    places: Mapping[str, Callable[[int], int]] | None = None,
    apart: bool = False,
) -> str:
    """C that defines ``NAME_constants``, ``NAME_prepare`` and ``NAME_run``, NAME the name of ``function``.

    ``arguments`` say which of x, s, t, h, u, p each argument of the function is. Its results, one or two, are
    written to ``value`` and ``slope``. ``slopes`` and ``places`` as in ``_Writer``. If ``apart``, also
    ``NAME_givens`` and ``NAME_given``: it computes so many numbers of the inputs, which ``NAME_run`` takes as
    ``e``.

    Raises:
        Unwritten: if the function has an operation that has no C here.
    """
    writer = _Writer(function, arguments, set(slopes), places or {}, apart)
    x, s, t, value, slope = (
        f"{'Slope' if one in slopes else 'Lanes'} *{one}" for one in ("x", "s", "t", "value", "slope")
    )
    for k in range(function.n_instructions()):
        writer.write(k)
    name = function.name()
    kept = [f"c[{place}] = {one};" for one, place in writer.known.items()]
    given = (
        f"enum {{ {name}_givens = {len(writer.kept)} }};",
        f"static void {name}_given(const Lanes *u, const double *p, const double *c, Lanes *e) {{",
        *writer.given,
        *(f"e[{place}] = {one};" for one, place in writer.kept.items()),
        "}",
    )
    return "\n".join(
        (
            *(given if apart else ()),
            f"enum {{ {name}_constants = {len(kept)} }};",
            f"static void {name}_prepare(double h, const double *p, double *c) {{",
            *writer.prepare,
            *kept,
            "}",
            f"static void {name}_run(const {x}, const {s}, const {t}, double h,",
            f"const Lanes *u, const double *p, const double *c, {'const Lanes *e,' * apart}",
            f"{value}, {slope}) {{",
            *writer.run,
            "}\n",
        )
    )


def _of_one(code: int) -> str:
    if code in LIBRARY:
        return LIBRARY[code] + "({0})"
    if code in LIBRARY_OF_TWO:
        return LIBRARY_OF_TWO[code] + "({0}, {1})"
    return _found({**ARITHMETIC, **OF_ONE}, code)


def _of_lanes(code: int) -> str:
    if code in LIBRARY:
        return f"EACH({LIBRARY[code]}, {{0}})"
    if code in LIBRARY_OF_TWO:
        return f"EACH_OF_TWO({LIBRARY_OF_TWO[code]}, {{0}}, {{1}})"
    return _found({**ARITHMETIC, **OF_LANES}, code)


def _found(table: Mapping[int, str], code: int) -> str:
    if code not in table:
        raise Unwritten(f"operation {code} of CasADi has no C in hybridid.simulation.c_code")
    return table[code]


def _number(value: float) -> str:
    """A number as C reads it back to the last bit."""
    written = repr(float(value))
    return {"inf": "INFINITY", "-inf": "(-INFINITY)", "nan": "NAN"}.get(
        written, f"({written})" if value < 0 else written
    )
