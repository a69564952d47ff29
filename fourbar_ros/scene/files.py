# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Scene files: where they are, and what ROS reads in them.

They are ROS 2 parameter files, read here without ROS.
"""
from __future__ import annotations

from collections.abc import Iterator
from math import inf, isinf, nan
from pathlib import Path
import re
from typing import Any

from fourbar_ros.errors import FourBarError, nearest
from fourbar_ros.scene.parameters import ParameterValues
import yaml

NODE = '/fourbar'
BOOLS = {word: value for value, words in ((True, 'y yes true on'), (False, 'n no false off'))
         for small in words.split() for word in {small, small.capitalize(), small.upper()}}
INTEGER = re.compile(r'[-+]?(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)')       # base 0 of C's strtoll
TABLE = re.compile(r'forces\.\w+\.table')
IN_WORDS = {'<block end>': 'it is indented unlike the lines above it',
            "'<stream end>'": 'a bracket is open', 'end of stream': 'a quote is open',
            'mapping values are not allowed': 'a second colon, or indented unlike the line above'}
NO_BLANK = re.compile(r'(?:^|[\s{,])([A-Za-z][\w.]*):([^\s:/,}]+)')
DOUBLE = re.compile(r'[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?')
NAMED = {'.nan': nan, '.inf': inf, '+.inf': inf, '-.inf': -inf,
         **{sign + word: float(sign + word) for sign in ('', '+', '-')
            for word in ('nan', 'inf', 'infinity')}}


class SceneError(FourBarError, ValueError):
    """A scene file cannot be read; the message names the file and the reason."""


class NotForNode(SceneError):
    """A parameter file contains nothing for the given node."""


Tree = dict[str, Any]       # {name: value} of YAML, whose values may be trees


def folder() -> Path:
    """Return the folder of the supplied scenes: in the package, or beside it in its source."""
    package = Path(__file__).resolve().parent.parent
    inside = package / 'config'
    return inside if inside.is_dir() else package.parent / 'config'


def find(name: str | Path, among: Path | None = None) -> Path:
    """
    Return the path of a scene: a file, or the name of a supplied one, e.g. ``paper``.

    ``among``: the folder of the supplied ones, :func:`folder` by default.

    Raises
    ------
    SceneError
        Neither exists; the message lists the names.

    """
    path = Path(name)
    if path.exists() or path.parent != Path('.') or path.suffix:
        return path
    files = shipped(among)
    if str(name) in files:
        return files[str(name)]
    known = sorted(files)
    raise SceneError(f'{name}: neither a file nor the name of a scene{nearest(str(name), known)}')


def shipped(among: Path | None = None) -> dict[str, Path]:
    """Return {name: file} of the supplied scenes; ``among``: those of a folder."""
    places = [among] if among else [folder() / 'classics', folder()]
    return {file.stem: file for place in places for file in sorted(place.glob('*.yaml'))}


def read_values(path: str | Path, node: str | None = None) -> Tree:
    """
    Return the flat dict of parameters in a ROS 2 parameter file as ROS reads them, unchecked.

    Names of files with tables become paths from here.

    Parameters
    ----------
    path : str or Path
        A file, ``FILE:NODE`` for one node of several in a file, or a name for :func:`find`.
    node : str, optional
        Full name of the node that is to read it. Not given: one that is called fourbar, in any
        namespace.

    Raises
    ------
    SceneError
        The file cannot be read, is no parameter file, or none of it is for the node.

    """
    path, node = _file_and_node(path, node)
    there = sections(path)
    found = [tree for key, tree in there.items() if is_for(key, node)]
    if not found:
        raise NotForNode(f'{path}: contains nothing for the node {node or NODE}, only '
                         f'{", ".join(there)}; write "/**:" there'
                         + (f', or name one: {path}:{next(iter(there)).lstrip("/*")}'
                            if node is None else ''))
    values: Tree = {}
    for tree in found:
        values |= flatten(tree, path)
    others = [key for key in there if not is_for(key, node)]
    if node is None and others and not any(name.startswith('linkage.') for name in values):
        raise NotForNode(f'{path}: has the nodes {", ".join(others)}; name one: '
                         f'{path}:{others[0].lstrip("/*")}')
    return beside(values, path)


def table_files(values: ParameterValues) -> list[str]:
    """Return the names of the parameters of a scene that name the file of a table."""
    return [name for name, value in values.items()
            if TABLE.fullmatch(name) and isinstance(value, str) and value]


def beside(values: ParameterValues, scene: Path) -> Tree:
    """Return values with the files of tables, which stand beside a scene, as paths from here."""
    return {**values, **{name: str(scene.parent / values[name]) for name in table_files(values)}}


def _file_and_node(path: str | Path, node: str | None) -> tuple[Path, str | None]:
    """Return the file of a scene and the node in it, from FILE, FILE:NODE or a name."""
    file, colon, name = str(path).rpartition(':')
    if colon and node is None and not Path(path).exists() and Path(file).is_file():
        return Path(file), '/' + name.strip('/')
    return find(path), node


def sections(path: str | Path) -> dict[str, Tree]:
    """
    Return {key for nodes: tree of parameters} of a ROS 2 parameter file.

    Raises SceneError if the text is not a parameter file.
    """
    text = ''
    try:
        text = Path(path).read_text(encoding='utf-8')
        document = yaml.load(text, _Loader)
    except OSError as error:
        raise SceneError(f'{path}: {error.strerror}') from None
    except UnicodeDecodeError:
        raise SceneError(f'{path}: is no text in UTF-8, so not a scene') from None
    except (yaml.YAMLError, RecursionError) as error:
        raise SceneError(f'{path}{_why_no_yaml(text, error)}') from None
    found = dict(_sections(document)) if isinstance(document, dict) else {}
    if not found:
        raise SceneError(f'{path}: not a scene: expected "/**:" with "ros__parameters:" below it'
                         + _typed_like(text))
    return found


def _why_no_yaml(text: str, error: Exception) -> str:
    """Return where a text is no YAML that ROS reads and why, with what is missing there."""
    mark = getattr(error, 'problem_mark', None)
    if mark is None:
        why = getattr(error, 'problem', None) or getattr(error, 'reason', 'nested too deeply')
        return f': not YAML that ROS reads: {" ".join(str(why).split())}'
    lines, at = text.splitlines(), mark.line
    why = ' '.join(str(getattr(error, 'problem', None) or error).split())
    for line in (at, at - 1):          # YAML often sees it a line later
        found = NO_BLANK.search(lines[line]) if 0 <= line < len(lines) else None
        if found:
            at, why = line, (f'a blank is missing behind the colon: {found[1]}: {found[2]}')
            break
    else:
        if at < len(lines) and '\t' in lines[at]:
            why = 'a tab: YAML takes blanks only'
        why = next((words for part, words in IN_WORDS.items() if part in why), why)
    return f', line {at + 1}: not YAML that ROS reads: {why}'


def _typed_like(text: str) -> str:
    """Return a hint on a word that only looks like ros__parameters; empty: there is none."""
    words = re.findall(r'\w*param\w*', text)
    return f'; there is {words[0]!r}' if words and 'ros__parameters' not in words else ''


def parse(text: str) -> Any:
    """Return the value of ``-p NAME:=text`` as rcl reads it; None if rcl refuses it."""
    try:
        return yaml.load(text, _Loader)
    except yaml.YAMLError:
        return None


def is_for(key: str, node: str | None) -> bool:
    """
    Return whether the parameters under a key of a file apply to a node.

    None stands for a node named fourbar in any namespace.
    """
    parts = key.strip('/').split('/')
    if node is None:
        return parts[-1] in ('*', '**', NODE[1:])
    pattern = ''.join('(/[^/]+)*' if part == '**' else '/[^/]+' if part == '*' else '/'
                      + re.escape(part)
                      for part in parts)
    return re.fullmatch(pattern, node) is not None


def _sections(tree: dict[Any, Any], prefix: str = '') -> Iterator[tuple[str, Tree]]:
    """Yield (name of the node, its parameters) of a document; namespaces may be nested."""
    for key, below in tree.items():
        if isinstance(below, dict):
            name = f'{prefix}/{str(key).strip("/")}'
            if isinstance(below.get('ros__parameters'), dict):
                yield name if key != '/**' or prefix else '/**', below['ros__parameters']
            yield from _sections({k: v for k, v in below.items() if k != 'ros__parameters'}, name)


def flatten(tree: dict[Any, Any], path: str | Path = '', prefix: str = '') -> Tree:
    """
    Return a nested dict with its keys joined by dots, as ROS does.

    Raises SceneError for a duplicate name.
    """
    flat: Tree = {}
    for key, value in tree.items():
        part = (flatten(value, path, f'{prefix}{key}.') if isinstance(value, dict)
                else {f'{prefix}{key}': value})
        for name in part:
            if name in flat:
                raise SceneError(f'{path}: {name} is given twice')
        flat |= part
    return flat


def scalar(text: str) -> bool | int | float | str:
    """
    Return a plain scalar as rcl's parser reads it.

    ``4e-1`` is a number; ``1_000`` and ``1:30`` are texts.
    """
    if text in BOOLS:
        return BOOLS[text]
    if INTEGER.fullmatch(text):
        sign, digits = -1 if text[0] == '-' else 1, text.lstrip('+-')
        try:
            whole = sign * int(digits, 16 if digits[:2] in ('0x', '0X') else 8 if digits[0] == '0'
                               else 10)
            return whole if -2**63 <= whole < 2**63 else float(whole)
        except (OverflowError, ValueError):     # beyond doubles, or more digits than Python reads
            return text
    if DOUBLE.fullmatch(text):
        value = float(text)
        overflows = (isinf(value) or (value == 0.0 and any(c in '123456789'
                                                           for c in re.split('[eE]', text)[0])))
        return text if overflows else value
    return NAMED.get(text.lower(), text)


def as_text(values: ParameterValues) -> str:
    """
    Return a flat dict of parameters as the text of a ROS 2 parameter file for any node.

    Those that are not given (NaN) are left out; numbers have all their digits.
    """
    tree: Tree = {}
    for name, value in values.items():
        if value != value:
            continue
        *path, last = name.split('.')
        place = tree
        for step in path:
            place = place.setdefault(step, {})
        place[last] = list(value) if isinstance(value, tuple) else value
    return yaml.safe_dump({'/**': {'ros__parameters': tree}}, sort_keys=False)


class _Loader(yaml.SafeLoader):
    """YAML as rcl reads it; duplicate keys, missing values and aliases are errors."""

    yaml_implicit_resolvers = {}

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            # yaml has no types for it
            event: Any = self.peek_event()      # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(problem='ROS reads no aliases',
                                       problem_mark=event.start_mark)
        return super().compose_node(parent, index)


def _plain_or_quoted(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> bool | int | float | str:
    if node.style is not None:
        found: bool | int | float | str = node.value
        return found
    if not node.value:
        raise yaml.MarkedYAMLError(problem='a key without a value', problem_mark=node.start_mark)
    return scalar(node.value)


def _mapping(loader: yaml.SafeLoader, node: yaml.MappingNode) -> Tree:
    """Return a mapping of YAML; a key that is no text, or given twice, is an error."""
    found = {}
    for key_node, value_node in node.value:
        key = key_node.value if isinstance(key_node, yaml.ScalarNode) else None
        if key is None:
            raise yaml.MarkedYAMLError(problem='a key that is no text',
                                       problem_mark=key_node.start_mark)
        if key in found:
            raise yaml.MarkedYAMLError(problem=f'{key} is given twice',
                                       problem_mark=key_node.start_mark)
        found[key] = loader.construct_object(value_node, deep=True)
    return found


for _tag in ('str', 'int', 'float', 'bool', 'null'):
    _Loader.add_constructor(f'tag:yaml.org,2002:{_tag}', _plain_or_quoted)
_Loader.add_constructor('tag:yaml.org,2002:map', _mapping)
