"""``python -m hybridid_cli`` is ``hybridid``."""

from hybridid_cli.main import main

main()
