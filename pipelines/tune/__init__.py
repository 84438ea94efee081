"""``tune``: an adaptive search for the network, shared by processes and nodes through one journal file."""
