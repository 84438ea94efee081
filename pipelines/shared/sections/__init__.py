"""The sections of a config: one frozen dataclass each. Light, for help and completion."""
