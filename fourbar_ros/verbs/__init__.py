"""The verbs of the ``fourbar`` command, a module each: arguments here, the work where it belongs."""
