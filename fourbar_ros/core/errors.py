"""Errors of the core: one base class, one class per reason, the values kept as attributes."""


class FourBarError(Exception):
    """Base of every error this package raises on purpose."""


class InvalidParameter(FourBarError, ValueError):
    """A parameter has a value that is not allowed; ``name``, ``value``, ``allowed`` are kept."""

    def __init__(self, name, value, allowed):
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f'{name}: {allowed}' if value is None else f'{name} = {value!r}: {allowed}')


class OutOfRange(FourBarError, ValueError):
    """The linkage cannot be assembled at the given input angle; ``theta1`` and ``ranges`` are kept."""

    def __init__(self, theta1, ranges):
        self.theta1, self.ranges = theta1, ranges
        allowed = ' or '.join(f'[{low:.9g}, {high:.9g}]' for low, high in ranges)
        super().__init__(f'theta1 = {theta1!r} rad is outside the input range {allowed} rad')


class Toggle(FourBarError, ArithmeticError):
    """Coupler and output link are in line: rates and loads are unbounded; ``theta1`` is kept."""

    def __init__(self, theta1):
        self.theta1 = theta1
        super().__init__(f'theta1 = {theta1!r} rad is a toggle position: rates and loads are unbounded')


class MissingBodies(FourBarError, ValueError):
    """Loads were asked of a linkage whose masses are not known."""

    def __init__(self):
        super().__init__('loads need the masses of the links: give bodies to the linkage')
