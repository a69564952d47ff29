"""Planar four-bar linkages: exact motion, loads and extrema. The core needs numpy only."""
from importlib import import_module

__version__ = '0.1.0'


def __getattr__(name):
    """Import the core when something of it is first asked for: the node catches signals before that."""
    core = import_module('.core', __name__)
    if name == '__all__' or name in core.__all__:
        return getattr(core, name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')


def __dir__():
    return [*globals(), *__getattr__('__all__')]
