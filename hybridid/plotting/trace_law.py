"""Figure: a composed law over the learned effort that it explains."""

from __future__ import annotations

from hybridid.plotting.axes import Array, frame, name_y, scale_for
from hybridid.plotting.legends import legend_on_top
from hybridid.plotting.looks import look
from hybridid.plotting.style import SINGLE_COLUMN, Plot, new_figure, styled

HEIGHT = 70.0  # mm
LARGEST = 40.0  # area in pt² of the dot at the point with the most samples


_EXPLAINED = {
    "effort": "the learned effort that it explains, a free curve of the same variable. That is known up to "
    "what the model's own terms can take over, as a constant or a stiffness; it is shown where it comes "
    "nearest to the law.",
    "amplitude": "the amplitude that it explains: that of the law of one variable, free over the other "
    "variable, where the level of the law comes nearest to it.",
}


@styled
def law_plot(
    place: str,
    equation: str,
    law: tuple[Array, Array],
    learned: tuple[Array, Array, Array],
    units: tuple[str, str],
    over: str,
    value: str,
    factor: str,
    provenance: str,
    width: float = SINGLE_COLUMN,
) -> Plot:
    """The ``law`` (at, value) as a line, the ``learned`` effort (at, value, samples) as dots.

    ``units`` are those of the variable ``over`` and of the ``value`` over ``factor``, which are named in
    words. The value is an effort, or the amplitude of a law whose level is drawn.
    """
    figure = new_figure(width, HEIGHT, f"law proposed at {place}", provenance)
    axes = figure.subplots()
    x = scale_for(over, units[0], law[0], learned[0])
    y = scale_for(f"{value} over {factor}" if factor else value, units[1], law[1], learned[1])
    dots, line = look(0), look(1)
    samples = learned[2]
    shown = axes.scatter(
        learned[0] * x.factor, learned[1] * y.factor, LARGEST * samples / samples.max(),
        color=dots.colour, linewidths=0, label=f"learned {value}",
    )  # fmt: skip
    (drawn,) = axes.plot(
        law[0] * x.factor, law[1] * y.factor, color=line.colour, linestyle=line.dashes, label=equation
    )
    axes.set_xlim(frame([law[0] * x.factor, learned[0] * x.factor], 0.02))
    axes.set_ylim(frame([law[1] * y.factor, learned[1] * y.factor]))
    axes.set_xlabel(x.label)
    name_y(axes, y)
    legend_on_top(figure, [shown, drawn])
    caption = f"The law {equation} proposed at {place} ({provenance}) over {_EXPLAINED[value]}"
    caption += " Both were fitted in simulation, with all parameters."
    caption += " The area of a dot grows with the time spent there."
    return Plot(figure, f"law_{place}", caption, provenance)
