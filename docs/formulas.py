# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Find where each equation is: the tables of docs/formulas.md, written by docs/tables.py.

Equations of our own are numbered in the docstring of their module, ``(M5)  y' = ...`` on a line
of its own, and the code that computes them names the number in a comment. Equations of the two
source documents are named in docstrings and comments: ``slides, Eqs. (9)-(15)``.
"""
import ast
from collections import defaultdict
from functools import cache
import io
from pathlib import Path
import re
import tokenize
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ROOT / 'fourbar_ros', ROOT / 'fourbar_lab'
# which compare with the documents, and compute none of their equations
LEFT_OUT = 'documents', 'page', 'paper', 'published', 'slides'
# with the lines that go on below it, further in
NUMBERED = re.compile(r'^( +)\(([A-Z]{1,2}\d+[a-z]?)\) +(\S.*(?:\n\1  +\S.*)*)$', re.M)
TAG = re.compile(r'\(([A-Z]{1,2}\d+[a-z]?)\)')
CITED = re.compile(r'Eqs?\. (\(\d+\)(?:(?:, | and |, and |-)\(\d+\))*)')
SPAN = re.compile(r'\((\d+)\)(?:-\((\d+)\))?')

# (first, last, subject) of every numbered equation; where none of the package's docstrings names
# it, the subject says why
SUBJECTS = {
    'slides': (
        (1, 1, 'velocity along a path; `fourbar reproduce` checks it'),
        (2, 2, 'acceleration along a path: tangential and normal; `fourbar reproduce` checks it'),
        (3, 3, 'turning of the tangent, summed up in (2)'),
        (4, 5, 'not in our copy'),
        (6, 6, 'acceleration of a point of a rigid link'),
        (7, 7, 'loop of the slider-crank'),
        (8, 8, 'not in our copy'),
        (9, 9, 'acceleration in a moving frame: the five terms, Coriolis among them'),
        (10, 10, 'the same, with the relative acceleration in its parts; '
                 '`fourbar reproduce` checks it'),
        (11, 11, 'the same from the coincident point of the link; `fourbar reproduce` checks it'),
        (12, 12, 'relative angular acceleration of two links; `fourbar reproduce` checks it'),
        (13, 15, 'rolling contact: acceleration of the contact point, rolling acceleration; '
                 '`fourbar reproduce` checks them'),
        (16, 16, 'input-output equation of θ1 and θ4'),
        (17, 21, 'the other five input-output equations'),
        (22, 27, 'their first time derivatives: ratios of angular velocities'),
        (28, 33, 'their second time derivatives: angular accelerations'),
        (34, 34, 'rate of v = tan(θ/2)'), (35, 35, 'rate of θ = 2 atan v'),
        (36, 36, 'acceleration of v'), (37, 37, 'acceleration of θ'),
        (38, 38, '(16) of Example 7.7'),
    ),
    'paper': (
        (1, 6, 'the six input-output equations of the closed Denavit-Hartenberg chain'),
        (7, 7, 'rate of θ4: (22) of the slides'),
        (8, 8, 'acceleration of θ4: (28) of the slides'),
        (9, 9, '9×9 system of Newton-Euler equations: joint reactions and driving torque'),
        (10, 10, 'its solution'),
    ),
}
ALGORITHMS = {
    'slides': ('extreme angular accelerations, steps 1 to 9',),
    'paper': ('extreme angular velocities, steps 1 to 3',
              'extreme angular accelerations, steps 1 to 5'),
}
NAMED = 'algorithms of extreme values'      # in the docstrings of what does their work


class Module(NamedTuple):
    """A module of the package, read."""

    path: str           # below the root
    doc: str            # docstring, '' without one
    # (where, text) of every docstring and comment; where: '' or a qualified name
    texts: list


def _functions(tree, outer=''):
    """Yield (first line, last line, qualified name, docstring) of classes and functions."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            name = f'{outer}.{node.name}' if outer else node.name
            yield node.lineno, node.end_lineno, name, ast.get_docstring(node) or ''
            yield from _functions(node, name)
        else:
            yield from _functions(node, outer)


def read(path):
    """Return the Module of a file."""
    source = path.read_text(encoding='utf-8')
    tree = ast.parse(source)
    found = list(_functions(tree))
    doc = ast.get_docstring(tree, clean=False) or ''
    texts = [('', doc), *((name, text) for _, _, name, text in found)]
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            row = token.start[0]
            around = [name for first, last, name, _ in found if first <= row <= last]
            texts.append((around[-1] if around else '', token.string))
    return Module(path.relative_to(ROOT).as_posix(), doc, texts)


def in_one_line(text):
    """Return an equation of several lines in one; lines that begin another one after a ';'."""
    first, *others = map(str.strip, text.split('\n'))
    for line in others:
        begins = re.match(r'[^=(]{1,12} = ', line) and not first.endswith(',')
        first += f';   {line}' if begins else f' {line}'
    return first


@cache
def modules():
    """Return the Modules of the package, but those that compute nothing."""
    return [read(path) for package in PACKAGES for path in sorted(package.rglob('*.py'))
            if path.stem not in LEFT_OUT]


def places(found):
    """Return links to files, each with the functions or classes that are named in it."""
    by_file = defaultdict(list)
    for path, name in found:
        if name:
            by_file[path].append(f'`{name}`')
        by_file[path]               # a file that names the equation in its docstring alone
    return '; '.join(f'[{path.removeprefix("fourbar_ros/")}](../{path})'
                     + (': ' + ', '.join(names) if names else '')
                     for path, names in by_file.items())


def numbered(module):
    """Return {tag: (equation, [names of the functions that compute it])} of a module."""
    equations = {tag: (in_one_line(text), []) for _, tag, text in NUMBERED.findall(module.doc)}
    for name, text in module.texts[1:]:
        for tag in TAG.findall(text):
            if tag in equations and name and name not in equations[tag][1]:
                equations[tag][1].append(name)
    return equations


def ours():
    """Return Markdown: for each module that numbers equations a heading and a table."""
    parts = []
    for module in modules():
        equations = numbered(module)
        if equations:
            name = module.path.removeprefix('fourbar_ros/')
            rows = [(f'({tag})', f'`{equation}`', ', '.join(f'`{name}`' for name in names))
                    for tag, (equation, names) in equations.items()]
            parts.append(f'### [{name}](../{module.path})\n\n'
                         + table(('number', 'equation', 'computed by'), rows))
    return '\n\n'.join(parts)


def cited(document):
    """Return {number: [(path, name), ...]} of the equations of a document that are named."""
    found = defaultdict(list)
    for module in modules():
        for name, text in module.texts:
            for sentence in re.split(r'(?<=[.;])\s(?=[A-Z])', ' '.join(text.split())):
                for match in CITED.finditer(sentence):
                    near = sentence[max(0, match.start() - 60):match.end() + 30]
                    if ('paper' in near) is not (document == 'paper'):
                        continue
                    for first, last in SPAN.findall(match[1]):
                        for number in range(int(first), int(last or first) + 1):
                            if (module.path, name) not in found[number]:
                                found[number].append((module.path, name))
    return found


def source(document):
    """Return the Markdown table of a source document; numbers with one subject share a row."""
    found = cited(document)
    rows = []
    for first, last, subject in SUBJECTS[document]:
        where = sorted({at for number in range(first, last + 1) for at in found.pop(number, [])})
        numbers = f'({first})' if first == last else f'({first})-({last})'
        rows.append((numbers, subject, places(where)))
    if found:
        raise SystemExit(f'docs/formulas.py: SUBJECTS lacks {sorted(found)} of the {document}')
    where = places((module.path, name) for module in modules() for name, text in module.texts
                   if NAMED in ' '.join(text.split()))
    rows += [('algorithm', subject, where) for subject in ALGORITHMS[document]]
    return table(('equation', 'subject', 'where'), rows)


def table(head, rows):
    """Return a Markdown table."""
    return '\n'.join('| ' + ' | '.join(str(cell).replace('|', '\\|') for cell in line) + ' |'
                     for line in (head, ['---'] * len(head), *rows))


def tables():
    """Return {name: Markdown} of the page."""
    return {'slides': source('slides'), 'paper': source('paper'), 'ours': ours()}
