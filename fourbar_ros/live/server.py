# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Serves the page to browsers of this machine, and to no other page or machine."""
from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
import os
from pathlib import Path
import socket
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.live.page import Page
from nicegui import app, ui

HOST = '127.0.0.1'
NAMES = (HOST, 'localhost')
PORT = 8420
PATIENCE = 30.0         # [s] a tab that is silent for longer is forgotten
HISTORY = 100           # messages kept for a tab that comes back; older ones: it loads again


class PortTaken(FourBarError, OSError):
    """The port of the page is in use."""


Asgi = Callable[..., Awaitable[None]]


class OnlyHere:
    """
    ASGI middleware that refuses requests of other hosts' names and of other pages.

    A page elsewhere could otherwise reach this one through the browser: by its own name bound to
    this address (the Host header shows it), or by a script of its own (the Origin header does).
    """

    def __init__(self, served: Asgi, port: int):
        self.served = served
        self.hosts = {f'{name}:{port}' for name in NAMES}
        self.origins = {f'http://{host}' for host in self.hosts}

    async def __call__(self, scope: dict[str, Any], receive: Asgi, send: Asgi) -> None:
        if scope['type'] in ('http', 'websocket') and not self._is_allowed(scope):
            if scope['type'] == 'websocket':
                await send({'type': 'websocket.close', 'code': 1008})
                return
            await send({'type': 'http.response.start', 'status': 403,
                        'headers': [(b'content-type', b'text/plain')]})
            await send({'type': 'http.response.body', 'body': b'only for this machine\n'})
            return
        await self.served(scope, receive, send)

    def _is_allowed(self, scope: dict[str, Any]) -> bool:
        headers = {name.decode('latin-1').lower(): value.decode('latin-1')
                   for name, value in scope['headers']}
        return (headers.get('host', '') in self.hosts
                and headers.get('origin', f'http://{headers.get("host")}') in self.origins)


def free_port(wanted: int | None) -> int:
    """
    Return a port of this machine; PortTaken if it is in use.

    None: the usual one, so that addresses can be shared, or any free one.
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
        except OSError as error:
            raise PortTaken(f'port {wanted}: {os.strerror(error.errno or 0)}; '
                            'choose another with --port') from None
        return int(trial.getsockname()[1])


def serve_scene(title: str, values: dict[str, Any], port: int, is_opened: bool) -> None:
    """Serve the page of a scene until the process is interrupted."""
    _serve(title, lambda query: Page(title, values, query), port, is_opened)


def serve_run(paths: Sequence[str], node: str | None, port: int, is_opened: bool) -> None:
    """Serve the page of one recorded run, or of several beside each other."""
    from fourbar_ros.live.model import Shown
    from fourbar_ros.live.over_time import OverTime
    from fourbar_ros.live.recorded import read_run
    (scene, run), *others = [read_run(path, node) for path in paths]
    beside = [(_short(path, paths), Shown(other), its)
              for path, (other, its) in zip(paths[1:], others)]
    title = ' and '.join(_short(path, paths) for path in paths)
    _serve(title, lambda query: Page(title, scene.values, query,
                                     lambda shown: OverTime(shown, run, beside)),
           port, is_opened)


def _short(path: str, paths: Sequence[str]) -> str:
    """Return the name of a bag, or its path if others have that name too."""
    names = [Path(other).name for other in paths]
    return Path(path).name if names.count(Path(path).name) == 1 else str(path)


def serve_node(node: str, patience: float, port: int, is_opened: bool) -> None:
    """Serve the page of a running node: it moves as the node does, parameters are set in it."""
    from fourbar_ros.live.node_page import NodePage
    from fourbar_ros.ros.clients.watched import Watched
    watched = Watched(node, patience)
    app.on_shutdown(watched.close)
    _serve(watched.node, lambda query: NodePage(watched, query), port, is_opened)


def _serve(title: str, make: Callable[[dict[str, str]], Page], port: int,
           is_opened: bool) -> None:
    def page() -> None:
        make(dict(ui.context.client.request.query_params)).build()

    ui.page('/', title=f'{title} - fourbar live')(page)
    app.add_middleware(OnlyHere, port=port)
    app.on_startup(lambda: print(f'http://{HOST}:{port}  (Ctrl-C ends it)', flush=True))
    ui.run(host=HOST, port=port, title='fourbar live', dark=None, language='en-US', reload=False,
           show=is_opened, show_welcome_message=False, favicon='⚙️',
           reconnect_timeout=PATIENCE, message_history_length=HISTORY,
           # nothing is gained by packing what stays on this machine; Quasar's classes are enough
           gzip_middleware_factory=None, ws_per_message_deflate=False, tailwind=False)
