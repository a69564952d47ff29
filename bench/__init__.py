"""Measurements of this project: each module has a ``main()`` that prints Markdown. See ``python -m bench -h``."""
