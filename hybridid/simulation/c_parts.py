"""A step or the outputs with their sensitivities as C, from the two functions of ``sensitivities.Part``."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.simulation.c_code import c_of
from hybridid.simulation.sensitivities import Part

FORWARD, COLUMN = ("x", "t", "h", "u", "p"), ("x", "s", "t", "h")
"""What the arguments of the functions are called in C. A column takes s as x, d as s and its v_p as t."""
PARTS = "\nconst Part *parts[] = {%s};\n"
"""The parts that are called, where ``ctypes`` finds them."""
WITH_COLUMNS = """\
static void {name}_prepare(double h, const double *p, double *c) {{
  {forward}.prepare(h, p, c);
  {column}.prepare(h, p, c + {forward}_constants);
}}
static void {name}_run(const Lanes *x, const Lanes *s, const Lanes *t, double h, const Lanes *u,
                       const double *p, const double *c, Lanes *value, Lanes *slope) {{
  static const Lanes none[{width}];
  Lanes d[{derivatives}];
  {forward}.run(x, s, t, h, u, p, c, value, d);
  for (int j = 0; j < {columns}; ++j) {{
    const Lanes *own = j < {n_x} ? none : d + {entries} + (j - {n_x}) * {width};
    {column}.run(s + j * {n_x}, d, own, h, u, p, c + {forward}_constants, slope + j * {n}, slope);
  }}
}}
static const Part {name} = {{{forward}_constants + {column}_constants, {name}_prepare, {name}_run}};
"""


def c_of_parts(parts: Sequence[Part]) -> str:
    """C that defines ``parts``, in this order.

    Raises:
        Unwritten: if one has an operation that has no C here.
    """
    return "".join(map(c_of_part, parts)) + PARTS % ", ".join(f"&{part.name}" for part in parts)


def c_of_part(part: Part) -> str:
    """C that defines one ``Part``.

    Raises:
        Unwritten: if it has an operation that has no C here.
    """
    forward = c_of(part.forward, FORWARD)
    if part.column is None:
        return forward
    column = c_of(part.column, COLUMN)
    return (
        forward
        + column
        + WITH_COLUMNS.format(
            name=part.name,
            forward=part.forward.name(),
            column=part.column.name(),
            n_x=part.forward.size1_in(0),
            n=part.column.size1_out(0),
            width=part.width,
            columns=part.columns,
            entries=part.column.size1_in(1),
            derivatives=part.forward.size1_out(1),
        )
    )
