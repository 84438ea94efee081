"""The drawn league: scenarios drawn at random by a rig's own code, which no rule was conceived beside.

All its data are simulated. What counts as right, wrong and honest is stated in ``scoring``.
"""
