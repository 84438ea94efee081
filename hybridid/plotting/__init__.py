"""Figures for a paper: one figure a file, each a function of plain data that returns a ``Plot``.

``style.save`` writes a ``Plot`` as SVG, PDF and PNG.
"""
