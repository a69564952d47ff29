# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The server of the page: for browsers of this machine, and for no other page or machine.

It serves a scene, recorded runs (read from bags), or a running node: that page follows the
node's topics and sets the node's parameters.
"""
from __future__ import annotations

from asyncio import Lock
from collections.abc import Awaitable, Callable, Sequence
import os
from pathlib import Path
import socket
from typing import Any, TYPE_CHECKING

from fourbar_lab.live.page import Page
from fourbar_lab.live.playback import NodePlayback, Run
from fourbar_ros.bag.origin import origin_of
from fourbar_ros.bag.reader import Bag
from fourbar_ros.errors import FourBarError
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.settings import ParameterValues
from fourbar_ros.scene.topics import DRIVEN
from nicegui import app, run, ui
import numpy as np

if TYPE_CHECKING:      # needs ROS 2
    from fourbar_lab.clients.watched import Watched

HOST = '127.0.0.1'
NAMES = (HOST, 'localhost')
PORT = 8420
PATIENCE = 30.0         # [s] a tab that is silent for longer is forgotten
# No page of others may show this one in a frame, transparent above buttons of its own.
NOT_FRAMED = ((b'content-security-policy', b"frame-ancestors 'none'"),
              (b'x-frame-options', b'DENY'), (b'cross-origin-resource-policy', b'same-origin'))
HISTORY = 100           # messages kept for a tab that comes back; older ones: it loads again


class PortTaken(FourBarError, OSError):
    """The port of the page is in use, or no port."""


Asgi = Callable[..., Awaitable[None]]
Scope = dict[str, Any]          # of a request, as ASGI states it


class OnlyHere:
    """
    ASGI middleware that refuses requests of other hosts' names and of other pages.

    A page elsewhere could otherwise reach this one through the browser: by its own name bound to
    this address (the Host header shows it), by a script of its own (Origin does), or by an image
    or a frame (Sec-Fetch-Site does). What it may do is what a user does: follow a link to here.
    """

    def __init__(self, served: Asgi, port: int):
        self.served = served
        self.hosts = {f'{name}:{port}' for name in NAMES}
        self.origins = {f'http://{host}' for host in self.hosts}

    async def __call__(self, scope: Scope, receive: Asgi, send: Asgi) -> None:
        """Serve a request, or refuse it with status 403; of a websocket, with code 1008."""
        async def send_for_us(message: Scope) -> None:
            """Send, with headers that forbid frames around our pages."""
            if message['type'] == 'http.response.start':
                message['headers'] = [*message['headers'], *NOT_FRAMED]
            await send(message)

        if scope['type'] in ('http', 'websocket') and not self._is_allowed(scope):
            if scope['type'] == 'websocket':
                await send({'type': 'websocket.close', 'code': 1008})
                return
            await send_for_us({'type': 'http.response.start', 'status': 403,
                               'headers': [(b'content-type', b'text/plain')]})
            await send({'type': 'http.response.body', 'body': b'only for this machine\n'})
            return
        await self.served(scope, receive, send_for_us)

    def _is_allowed(self, scope: Scope) -> bool:
        """Return whether a request comes from our own page, from no page, or from a link to us."""
        headers = {name.decode('latin-1').lower(): value.decode('latin-1')
                   for name, value in scope['headers']}
        is_link = (scope['type'] == 'http' and scope['method'] == 'GET'
                   and headers.get('sec-fetch-mode') == 'navigate'
                   and headers.get('sec-fetch-dest') == 'document')
        return (headers.get('host', '') in self.hosts
                and headers.get('origin', f'http://{headers.get("host")}') in self.origins
                and (is_link or headers.get('sec-fetch-site', 'none') in ('none', 'same-origin')))


def free_port(wanted: int | None) -> int:
    """
    Return a port of this machine that is free; PortTaken if the wanted one is not.

    None: the usual one, so that addresses can be shared, else any; 0: any.
    """
    if wanted is None:
        try:
            return free_port(PORT)
        except PortTaken:
            return free_port(0)
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, wanted))
        except OverflowError:
            raise PortTaken(f'--port {wanted}: must be an integer from 0 to 65535') from None
        except OSError as error:
            raise PortTaken(f'port {wanted}: {os.strerror(error.errno or 0)}; '
                            'choose another with --port') from None
        return int(trial.getsockname()[1])


def serve_scene(title: str, values: ParameterValues, port: int, is_opened: bool) -> None:
    """Serve the page of a scene until the process is interrupted."""
    _serve(title, lambda query: Page(title, values, query), port, is_opened)


def serve_run(paths: Sequence[str], node: str | None, port: int, is_opened: bool) -> None:
    """Serve the page of one recorded run, or of several beside each other."""
    from fourbar_lab.live.model import Shown
    from fourbar_lab.live.playback import RunPlayback
    (scene, run), *others = [read_run(path, node) for path in paths]
    beside = [(_short(path, paths), Shown(other), its)
              for path, (other, its) in zip(paths[1:], others)]
    title = ' and '.join(_short(path, paths) for path in paths)
    _serve(title, lambda query: Page(title, scene.values, query,
                                     lambda shown: RunPlayback(shown, run, beside)),
           port, is_opened)


def _short(path: str, paths: Sequence[str]) -> str:
    """Return the name of a bag, or its path if others have that name too."""
    names = [Path(other).name for other in paths]
    return Path(path).name if names.count(Path(path).name) == 1 else str(path)


def serve_node(node: str, patience: float, port: int, is_opened: bool) -> None:
    """Serve the page of a running node: it moves as the node does, parameters are set in it."""
    from fourbar_lab.clients.watched import Watched
    watched = Watched(node, patience)
    app.on_shutdown(watched.close)
    _serve(watched.node, lambda query: NodePage(watched, query), port, is_opened)


def _serve(title: str, make: Callable[[dict[str, str]], Page], port: int,
           is_opened: bool) -> None:
    """Serve what ``make`` builds of the query of each tab, until the process is interrupted."""
    async def page() -> None:
        # nothing is made for what only asks and never opens a socket, as an image tag
        await ui.context.client.connected()
        make(dict(ui.context.client.request.query_params)).build()

    ui.page('/', title=f'{title} - fourbar live')(page)
    app.add_middleware(OnlyHere, port=port)
    app.on_startup(lambda: print(f'http://{HOST}:{port}  (Ctrl-C ends it)', flush=True))
    ui.run(host=HOST, port=port, title='fourbar live', dark=None, language='en-US', reload=False,
           show=is_opened, show_welcome_message=False, favicon='⚙️',
           reconnect_timeout=PATIENCE, message_history_length=HISTORY,
           # nothing is gained by packing what stays on this machine; Quasar's classes are enough
           gzip_middleware_factory=None, ws_per_message_deflate=False, tailwind=False)


FASTER = 1.2            # pictures are scaled anew for rates this many times theirs


class NodePage(Page):
    """A page whose scene and motion are those of a node."""

    def __init__(self, watched: Watched, query: dict[str, str]):
        """Begin with the node's parameters; the query is left alone, the state is the node's."""
        super().__init__(watched.node, watched.values, {},
                         lambda shown: NodePlayback(shown, watched.latest))
        self.watched, self.version = watched, watched.version
        self._one_by_one = Lock()               # held while the node answers
        self._under_way: list[str] = []         # names of parameters without an answer yet

    def build(self) -> None:
        """Build the elements of the page; it moves at once."""
        super().build()
        self.timer.activate()
        self.elements.play.set_visibility(False)
        self.elements.slider.disable()
        self.elements.field.disable()

    async def change(self, name: str, value: float) -> None:
        """Set a parameter of the node; what it refuses goes back, with its reason."""
        self._under_way.append(name)
        async with self._one_by_one:         # the last that was typed is the last that is set
            why = await run.io_bound(self.watched.set, name, value)
        self._under_way.remove(name)
        if self.client.is_deleted:
            return
        self.refuse(why or '')
        if why:
            self._show_values(name)

    def _show_values(self, *names: str) -> None:
        """Show the node's values of parameters, but where its answer is still to come."""
        for name in set(names) & self.elements.show_value.keys() - set(self._under_way):
            self.elements.show_value[name](self.watched.values[name])

    def _advance(self) -> None:
        """Take what has changed in the node, then move on as every page."""
        if self.version != self.watched.version:
            self.version, self.values = self.watched.version, self.watched.values
            self._show_values(*self.values)
            self.rebuild(keep_problem=True)
        elif abs(self.playback.speed or 0.0) > FASTER * abs(self.shown.rate):
            self.rebuild(keep_problem=True)              # else arrows would leave the picture
        super()._advance()

    def _remember(self) -> None:
        """Leave the address alone: the state is the node's."""


class NoRun(FourBarError, ValueError):
    """A bag has no recorded motion to show."""


def read_run(path: str | Path, node: str | None = None) -> tuple[Scene, Run]:
    """
    Return the scene of a bag at its start, and the run; messages may be in any order.

    BagError if it cannot be read, or holds no scene; NoRun if no sample of the input's motion.
    """
    bag = Bag(path)
    origin = origin_of(bag, node)
    topic = origin.topics.get(DRIVEN.name)
    stamps: list[Any] = []
    states = []
    for columns in bag.columns([topic] if topic else []):
        stamps.append(columns.stamps)
        states.append(np.stack([columns.records[name]
                                for name in ('position', 'velocity', 'acceleration')]))
    if not stamps:
        raise NoRun(f'{path}: no motion of the input in it ({DRIVEN.topic})')
    times = np.concatenate(stamps)
    order = np.argsort(times, kind='stable')
    return origin.scene, Run((times[order] - times[order[0]]) * 1e-9,
                             np.concatenate(states, axis=1)[:, order])
