"""Figures for a paper: one figure a file, each a function of plain data that returns a ``Plot``.

``style.save`` writes a ``Plot`` as SVG, PDF and PNG. Nothing is imported here, so that
``hybridid.plotting.units`` stays light.
"""
