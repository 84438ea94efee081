"""The study of declarations: is declared physics that is wrong told, and sound physics left in peace?

A trace gets a declared model, and is asked to revise it (``trace.revise=true``). In 20 draws the declaration
is wrong, in 20 it is the truth. All data are simulated. What is drawn stands in ``draw``, what counts as
told, false or silent in ``scoring``. Both were committed before any trace was run on the draws.
"""
