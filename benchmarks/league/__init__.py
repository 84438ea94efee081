"""The league: effects planted in virtual rigs, undeclared, and who names them. All its data are simulated."""
