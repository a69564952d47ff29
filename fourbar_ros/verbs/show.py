"""``fourbar show``."""


def add(verbs):
    """Add the verb."""
    show = verbs.add_parser(
        'show', help='class, modes, limits, extremes and loads of a scene, as tables',
        description='Show what a scene is: Grashof class, input range, transmission angle, all extremes of '
                    'motion and (with masses) of loads at constant input speed, and the state at one angle.')
    show.add_argument('scene', metavar='SCENE', help='parameter file of the scene (YAML)')
    show.add_argument('--mode', type=int, choices=(1, 2), help='assembly mode; default: that of the scene')
    show.add_argument('--speed', type=float, metavar='SPEED',
                      help='constant input speed [rad/s], of a slide [m/s]; default: drive.speed of the scene')
    show.add_argument('--at', type=float, metavar='INPUT',
                      help='also state and loads at this input angle [degrees], or slide [m]')
    show.set_defaults(run=_show)


def _show(arguments):
    from ..show import show
    show(arguments.scene, arguments.mode, arguments.speed, arguments.at)
