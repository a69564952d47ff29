# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Find and read scene files, ROS 2 parameter files, without ROS."""
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterable, Iterator, Mapping, Sequence
import csv
from itertools import takewhile
from math import isfinite
from pathlib import Path
import re
from typing import Any

from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.scene.settings import FORCE_UNITS, IN_QUOTES, ParameterValues, POSITION_UNITS
from fourbar_ros.scene.units import spelled, without_comma
import yaml

NODE = '/fourbar'
SAVE = 'if it is a text, save it in UTF-8: in Notepad Save as, Encoding; in Excel CSV UTF-8'
# {root of an XML file: its format}
DESCRIPTIONS = {'robot': 'URDF', 'sdf': 'SDF', 'mujoco': 'MJCF'}
ROOT = re.compile(r'\ufeff?\s*(?:<[?!][^>]*>\s*)*<(\w+)')
OF_TABLE = 'places', 'place_unit', 'values', 'value_unit'     # fields of a force
TABLE = re.compile(r'forces\.\w+\.table')
HEADING = re.compile(r'\s*([^\[\],]*?)\s*\[\s*([^\[\]]*?)\s*\]\s*')
# PyYAML's problems as a user sees them
IN_WORDS = {'<block end>': 'it is indented unlike the lines above it',
            "'<stream end>'": 'a bracket is open', 'end of stream': 'a quote is open',
            'mapping values are not allowed': 'a second colon, or indented unlike the line above',
            "'\\t'": 'a tab: YAML takes blanks only'}
NO_BLANK = re.compile(r'(?:^|[\s{,])([A-Za-z][\w.]*):([^\s:/,}]+)')


class SceneError(FourBarError, ValueError):
    """A scene file cannot be read; the message names the file and the reason."""


YamlTree = dict[str, Any]       # {name: value} of YAML, whose values may be trees


def folder() -> Path:
    """Return the folder of the supplied scenes: in the package, or beside it in its source."""
    package = Path(__file__).resolve().parent.parent
    inside = package / 'config'
    return inside if inside.is_dir() else package.parent / 'config'


def find(name: str | Path) -> Path:
    """Return the path of a scene: a file, or a supplied one by name, as paper; or SceneError."""
    if not isinstance(name, str | Path):
        raise SceneError(f'{name!r:.60}: must be a path, or the name of a scene; '
                         'fourbar_ros.scene.from_values makes one of numbers')
    path = Path(name)
    is_folder = path.is_dir()       # perhaps with code that was generated from the scene
    if path.exists() and not is_folder or path.parent != Path('.') or path.suffix:
        return path
    files = shipped()
    if str(name) in files:
        return files[str(name)]
    if is_folder:
        return path
    known = sorted(files)
    raise SceneError(f'{name}: neither a file nor the name of a scene'
                     + (nearest(str(name), known) or '; fourbar list shows all'))


def located(scene: str | Path) -> tuple[Path, str | None]:
    """Return (file, full name of a node or None) of a name for :func:`find`, or FILE:NODE."""
    file, colon, node = str(scene).rpartition(':')
    if (colon and isinstance(scene, str | Path) and not Path(scene).exists()
            and Path(file).is_file()):
        return Path(file), '/' + node.strip('/')
    return find(scene), None


def name_of(scene: str | Path) -> str:
    """Return the name of a scene, for titles and files: FILE, or FILE_NODE."""
    path, node = located(scene)
    return path.stem + (node or '').replace('/', '_')


def shipped() -> dict[str, Path]:
    return {file.stem: file for directory in (folder() / 'robots', folder() / 'classics', folder())
            for file in sorted(directory.glob('*.yaml'))}


def read_values(path: str | Path) -> YamlTree:
    """
    Return the dict of parameters in a ROS 2 parameter file as ROS reads them, unchecked.

    Tables of forces are read from their files. ``path`` is a file or a name for :func:`find`, for
    any node called fourbar, or ``FILE:NODE`` for one by its full name. Raises SceneError if the
    file cannot be read, is no parameter file, or has nothing for the node.
    """
    path, node = located(path)
    return with_tables(_values_for(path, node), [path.parent])


def loadable_text(scene: str | Path) -> str:
    """
    Return a scene as text that loads wherever it lies: its file, unless that holds more or less.

    Of one node among others, and of tables in files of their own, the parameters as they stand
    there, without comments but those at the top. Errors as of :func:`read_values`.
    """
    path, node = located(scene)
    text = text_of(path)
    if node is None and not any(map(TABLE.fullmatch, _values_for(path, node))):
        return text
    return ''.join(takewhile(lambda line: line.startswith('#'), text.splitlines(True))) + as_text(
        read_values(scene))


def _values_for(path: Path, node: str | None) -> YamlTree:
    """Return the dict of parameters in a file for a node, without the numbers of tables."""
    trees = sections(path)
    values: YamlTree = {}
    for key, tree in trees.items():
        if is_for(key, node):
            values |= flatten(tree, path)
    unread = [key for key in trees if not is_for(key, node)]
    if len(unread) == len(trees):
        raise nothing_for(node or NODE, path, trees, f', or name one: {path}:'
                          f'{unread[0].lstrip("/*")}' if node is None else '')
    if node is None and unread and not any(name.startswith('linkage.') for name in values):
        raise SceneError(f'{path}: has the nodes {", ".join(unread)}; name one: '
                         f'{path}:{unread[0].lstrip("/*")}')
    return values


def nothing_for(node: str, path: str | Path, keys: Iterable[str], way_out: str = '') -> SceneError:
    return SceneError(f'{path}: contains nothing for the node {node}, only {", ".join(keys)}; '
                      f'write "/**:" there{way_out}')


def overrides(arguments: Sequence[str], node: str) -> YamlTree:
    """
    Return the dict of parameters that ROS arguments give a node by its full name.

    The last of ``--params-file FILE`` and ``-p NAME:=VALUE`` counts, also where its type differs
    from that of one before: rcl would keep both and take either. Raises SceneError for a file that
    cannot be read, or if no file has anything for this node.
    """
    values: YamlTree = {}
    keys: dict[str, list[str]] = {}         # {file: nodes for which it is}
    has_file = False
    for option, word in zip(arguments, arguments[1:]):
        if option == '--params-file':
            trees = sections(word)
            of_node = [flatten(tree, word) for key, tree in trees.items() if is_for(key, node)]
            has_file = has_file or bool(of_node)
            keys[word] = [*trees]
            for flat in of_node:
                values |= flat
        elif option in ('-p', '--param'):
            name, _, text = word.partition(':=')
            target, _, name = name.rpartition(':')
            if target.strip('/') in ('', node.strip('/'), node.rpartition('/')[2]):
                values[name] = parse(text)
    if keys and not has_file:
        raise nothing_for(node, *next(iter(keys.items())))
    return values


def with_tables(values: ParameterValues, folders: Sequence[Path]) -> YamlTree:
    """
    Return values with tables read from CSV files in place of the names of these files.

    A file is that in the last of the ``folders`` that has it. Raises SceneError naming file and
    row, InvalidParameter for a table that is given twice.
    """
    replaced = dict(values)
    for name, file in values.items():
        if not (TABLE.fullmatch(name) and isinstance(file, str) and file):
            continue
        force = name.removesuffix('.table')
        for field in OF_TABLE:
            if values.get(f'{force}.{field}'):
                raise InvalidParameter(f'{force}.{field}', values[f'{force}.{field}'],
                                       f'is in the file already: {file}')
        beside = [path for folder in folders if (path := folder / file).exists()]
        table = read_table(beside[-1] if beside else folders[-1] / file,
                           values.get(f'{force}.periodic') is True)
        del replaced[name]
        replaced.update((f'{force}.{field}', value) for field, value in table.items())
    return replaced


def read_table(path: Path, is_periodic: bool = False) -> dict[str, Any]:
    """
    Return {places, place_unit, values, value_unit} of a CSV file, parameters of a force.

    The file has a header with units, then a place and a value in each row. Raises SceneError
    naming file and row, also for a table that is no function.
    """
    from fourbar_ros.mechanisms.force_table import ForceTable  # takes numpy

    def refuse(row: int, why: str) -> SceneError:
        return SceneError(f'{path}, row {row}: {why}')

    rows = _rows(path)
    row, header = rows[0] if rows else (1, [])
    units = [spelled(match[2], known) if match else '' for match, known in zip(
        map(HEADING.fullmatch, header), (POSITION_UNITS, FORCE_UNITS))]
    if len(header) != 2 or '' in units:
        raise refuse(row, 'must be two headings with units, as "theta1 [deg], pressure [bar]"; '
                          f'units are {", ".join(POSITION_UNITS)} and {", ".join(FORCE_UNITS)}')
    columns: tuple[list[float], list[float]] = [], []
    for row, cells in rows[1:]:
        if len(cells) != 2:
            raise refuse(row, f'{len(cells)} columns, must be a place and a value'
                         + ('; write decimals with a point, or ; between columns'
                            if len(cells) == 4 else ''))
        for text, column in zip(cells, columns):
            try:
                column.append(float(text))
            except ValueError:
                raise refuse(row, f'{text.strip()!r} must be a number') from None
            if not isfinite(column[-1]):
                raise refuse(row, f'{text.strip()!r} must be a finite number')
    try:
        ForceTable(*columns, is_periodic, is_linear=True)
    except InvalidParameter as error:
        name, _, index = error.name.rstrip(']').partition('[')
        if not index:
            raise SceneError(f'{path}: {error}') from None
        raise refuse(rows[int(index)][0], f'{error.value:g} {units[name == "values"]} '
                                          f'{error.allowed}') from None
    return dict(zip(OF_TABLE, (columns[0], units[0], columns[1], units[1])))


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Return (number of its line, cells) of each row of a CSV file but comments and blanks."""
    # with ; between columns a comma may be a decimal point, and then a point is none
    text = text_of(path)
    try:
        is_german = ';' in next((line for line in text.splitlines()
                                 if line.strip() and not line.lstrip().startswith('#')), '')
        reader = csv.reader(text.splitlines(), delimiter=';' if is_german else ',')
        rows = [(reader.line_num, row) for row in reader
                if any(map(str.strip, row)) and not row[0].lstrip().startswith('#')]
    except csv.Error as error:
        raise SceneError(f'{path}: not a table as text in UTF-8: {error}') from None
    if not is_german:
        return rows
    has_comma = any(',' in cell for _, row in rows[1:] for cell in row)
    for number, row in rows[1:]:
        for cell in row if has_comma else ():
            if '.' in cell:
                raise SceneError(f'{path}, row {number}: {cell.strip()!r} has a point, others a '
                                 'comma: write decimals in one way, and thousands without')
    return [(number, [cell.replace(',', '.') for cell in row]) for number, row in rows]


def text_of(path: str | Path) -> str:
    """Return the text of a file in UTF-8, or in UTF-16 with a byte order mark; or SceneError."""
    try:
        data = Path(path).read_bytes()      # once: it may be a pipe
        # UTF-16 is what > writes in PowerShell 5 of Windows
        encoding = 'utf-16' if data[:2] in (BOM_UTF16_LE, BOM_UTF16_BE) else 'utf-8-sig'
        return data.decode(encoding).replace('\r\n', '\n')
    except OSError as error:
        raise SceneError(f'{path}: {error.strerror}') from None
    except UnicodeDecodeError:
        raise SceneError(f'{path}: is no text in UTF-8; {SAVE}') from None


def document_of(path: str | Path, loader: type[yaml.SafeLoader]) -> tuple[str, Any]:
    """Return (text, its YAML document) of a file; SceneError if the loader refuses it."""
    text = text_of(path)
    root = ROOT.match(text)
    if root and root[1] in DESCRIPTIONS:         # which users take for a scene
        raise SceneError(f'{path}: is no scene but a robot description, {DESCRIPTIONS[root[1]]}; '
                         'fourbar import makes scenes of the loops in URDF and MJCF')
    try:
        return text, yaml.load(text, loader)
    except (yaml.YAMLError, RecursionError) as error:
        raise SceneError(f'{path}{_why_no_yaml(text, error)}') from None


def sections(path: str | Path) -> dict[str, YamlTree]:
    """Return {node or pattern of nodes: tree of parameters} of a parameter file, or SceneError."""
    text, document = document_of(path, RosYaml)
    trees = dict(_sections(document)) if isinstance(document, dict) else {}
    if not trees:
        words = re.findall(r'\w*param\w*', text)         # ros_parameters, perhaps
        hint = f'; there is {words[0]!r}' if words and 'ros__parameters' not in words else ''
        raise SceneError(f'{path}: not a scene: expected "/**:" with "ros__parameters:" below it'
                         + hint)
    return trees


def _why_no_yaml(text: str, error: Exception) -> str:
    """Return ``, line N: not YAML that ROS reads: REASON``."""
    mark, lines = getattr(error, 'problem_mark', None), text.splitlines()
    why = str(getattr(error, 'problem', None) or getattr(error, 'reason', 'nested too deeply'))
    where = f', line {mark.line + 1}' if mark else ''
    for line in (mark.line, mark.line - 1) if mark else ():     # YAML often sees it a line later
        match = NO_BLANK.search(lines[line]) if 0 <= line < len(lines) else None
        if match:
            where = f', line {line + 1}'
            why = f'a blank is missing behind the colon: {match[1]}: {match[2]}'
            break
    else:
        why = next((words for text_of_yaml, words in IN_WORDS.items() if text_of_yaml in why), why)
    return f'{where}: not YAML that ROS reads: {" ".join(why.split())}'


def parse(text: str) -> Any:
    """Return the value of a text, as of ``-p NAME:=text``, as rcl reads it; None if it refuses."""
    try:
        return yaml.load(text, RosYaml)
    except yaml.YAMLError:
        return None


def is_for(key: str, node: str | None) -> bool:
    """Return whether a key of a file is for a node: /** is any namespaces and names, /* one."""
    names = key.strip('/').split('/')
    if node is None:            # one named fourbar in any namespace
        return names[-1] in ('*', '**', NODE[1:])
    pattern = ''.join({'**': '(/[^/]+)*', '*': '/[^/]+'}.get(name, '/' + re.escape(name))
                      for name in names)
    return re.fullmatch(pattern, node) is not None


def _sections(tree: dict[Any, Any], prefix: str = '') -> Iterator[tuple[str, YamlTree]]:
    """Yield (full name of a node, its parameters) of a document; namespaces may be nested."""
    for key, below in tree.items():
        if isinstance(below, dict):
            name = f'{prefix}/{str(key).strip("/")}'
            if isinstance(below.get('ros__parameters'), dict):
                yield name if key != '/**' or prefix else '/**', below['ros__parameters']
            yield from _sections({k: v for k, v in below.items() if k != 'ros__parameters'}, name)


def flatten(tree: dict[Any, Any], path: str | Path = '', prefix: str = '') -> YamlTree:
    """Return {'a.b': 1} of {'a': {'b': 1}}; SceneError for a name twice in the file ``path``."""
    flat: YamlTree = {}
    for key, value in tree.items():
        below = (flatten(value, path, f'{prefix}{key}.') if isinstance(value, dict)
                 else {f'{prefix}{key}': value})
        for name in below:
            if name in flat:
                raise SceneError(f'{path}: {name} is given twice')
        flat |= below
    return flat


def nested(flat: Mapping[str, Any]) -> YamlTree:
    """Return {'a': {'b': 1}} of {'a.b': 1}."""
    tree: YamlTree = {}
    for name, value in flat.items():
        *path, last = name.split('.')
        below = tree
        for group in path:
            below = below.setdefault(group, {})
        below[last] = list(value) if isinstance(value, tuple) else value
    return tree


def as_text(values: ParameterValues) -> str:
    """Return a flat dict as the text of a ROS 2 parameter file for any node, without NaN."""
    tree = nested({name: value for name, value in values.items() if value == value})
    return text_of_tree(tree)


def text_of_tree(tree: YamlTree, **options: Any) -> str:
    """Return a tree of parameters as the text of a file for any node; ``options`` of yaml.dump."""
    text: str = yaml.dump({'/**': {'ros__parameters': tree}}, Dumper=RosDumper, sort_keys=False,
                          **options)
    return text


class PlainYaml(yaml.SafeLoader):
    """YAML with the numbers and truth values of rcl; every key is a text and has one value."""

    yaml_implicit_resolvers = {}
    bool_values = {**yaml.SafeLoader.bool_values, 'y': True, 'n': False}

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Return a mapping; {a1: 0,4} is refused, in which a1 is 0 and 4 has no value."""
        keys, whole = [key.value for key, _ in node.value], ''
        for key, _ in node.value:           # a point may be called no, which is False as a value
            if isinstance(key, yaml.ScalarNode):
                key.tag = 'tag:yaml.org,2002:str'
        for index, (key, value) in enumerate(node.value):
            is_plain = isinstance(value, yaml.ScalarNode) and not value.style
            why = ''
            if key.value in keys[:index]:
                why = f'{key.value} is given twice'
            elif is_plain and not value.value:
                typed = f'{whole},{key.value}'
                why = (f'{typed} {without_comma(typed)}'
                       if whole and key.value[:1].isdecimal() else f'{key.value} has no value')
            if why:
                raise yaml.MarkedYAMLError(problem=why, problem_mark=key.start_mark)
            whole = value.value if is_plain else ''
        values: dict[Any, Any] = super().construct_mapping(node, deep)
        return values

    def construct_yaml_int(self, node: yaml.ScalarNode) -> int:
        """Return a whole number; refuse 045, which is octal for ROS: 37."""
        text = node.value
        if text.lstrip('+-')[1:2] in ('x', 'X'):
            return int(text, 16)
        value = int(text)
        if text.lstrip('+-').startswith('0') and int(text, 8) != value:
            raise yaml.MarkedYAMLError(
                problem=f'{text} is octal for ROS, {int(text, 8)}: write {value}, without a zero '
                        'before it', problem_mark=node.start_mark)
        return value


PlainYaml.add_constructor('tag:yaml.org,2002:int', PlainYaml.construct_yaml_int)
# 4e-1 is a number, unlike in YAML 1.1, and so are digits too many for an integer; 1_000 and 1:30
# are texts, as every other scalar
for _tag, _pattern in (
        ('bool', 'y|Y|yes|Yes|YES|n|N|no|No|NO|true|True|TRUE|false|False|FALSE'
                 '|on|On|ON|off|Off|OFF'),
        ('int', '[-+]?(0[xX][0-9a-fA-F]{1,16}|0[0-7]{0,21}|[1-9][0-9]{0,18})'),
        ('float', r'[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?'
                  r'|[-+]?(\.?(?i:inf|nan)|(?i:infinity))')):
    PlainYaml.add_implicit_resolver(f'tag:yaml.org,2002:{_tag}', re.compile(f'({_pattern})$'),
                                    None)


class RosDumper(yaml.SafeDumper):
    """Writes what rcl reads: texts that it would take for other values in quotes, no aliases."""

    yaml_implicit_resolvers = {**PlainYaml.yaml_implicit_resolvers,
                               '': [('tag:yaml.org,2002:null', re.compile('$'))]}

    def ignore_aliases(self, data: Any) -> bool:
        """Return whether to write data out where they stand a second time."""
        return True


class RosYaml(PlainYaml):
    """YAML of parameter files: ROS takes no list of different types, and no alias."""

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Return the next node; refuse *a, which stands for what &a marks."""
        if self.check_event(yaml.AliasEvent):
            event: Any = self.peek_event()      # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(problem=f'ROS takes no alias: write out *{event.anchor}',
                                       problem_mark=event.start_mark)
        return super().compose_node(parent, index)

    def construct_sequence(self, node: yaml.SequenceNode, deep: bool = False) -> list[Any]:
        """Return a list; refuse items of several types with a hint what may have been meant."""
        items: list[Any] = super().construct_sequence(node, deep=True)
        are_numbers = all(type(item) in (int, float) for item in items)
        for item, item_node in zip(items, node.value):
            if are_numbers and type(item) is int and float in map(type, items):
                raise yaml.MarkedYAMLError(
                    problem=f'a list must be of one type: write {float(item)} for {item}',
                    problem_mark=item_node.start_mark)
            if isinstance(item, (list, dict)):
                raise yaml.MarkedYAMLError(problem='a list holds numbers or texts, no lists',
                                           problem_mark=item_node.start_mark)
            if type(item) is not type(items[0]):
                types = {*map(type, items)}
                hint = (f'; {IN_QUOTES}' if types == {bool, str} else
                        '' if bool in types else '; give all its numbers a unit, or none')
                for a, b in zip(node.value, node.value[1:]):       # [-1,8kN] is -1 and 8kN
                    if (a.end_mark.column + 1 == b.start_mark.column and b.value[:1].isdecimal()
                            and a.value.lstrip('+-').isdecimal()):
                        typed = f'{a.value},{b.value}'
                        hint = f'; {typed} {without_comma(typed)}'
                raise yaml.MarkedYAMLError(
                    problem=f'a list must be of one type, and {item!r} is not of that of '
                            f'{items[0]!r}{hint}', problem_mark=item_node.start_mark)
        return items
