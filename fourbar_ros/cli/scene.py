"""``fourbar scene check``: is a scene good, what will its node do, what does a step cost."""
from __future__ import annotations


def add(verbs):
    """Add the verb to the parser."""
    verb = verbs.add_parser('scene', help='check a scene file and explain what its node does and costs',
                            description='Check a scene file without starting anything.')
    actions = verb.add_subparsers(dest='action', required=True, metavar='ACTION')
    check = actions.add_parser(
        'check', help='explain a scene, or say in one line what is wrong with it',
        description='Say what a node with this scene receives, publishes, computes and what a step of it costs '
                    'on this machine. A bad scene: one line that names the parameter, exit code 1.')
    check.add_argument('scene', metavar='SCENE', help='parameter file (YAML), or name of a shipped scene, as paper')
    check.set_defaults(run=_check)


def _check(arguments):
    from fourbar_ros.cli.scene_check import explain
    explain(arguments.scene)
