"""The ``fourbar`` command, one module a verb."""
