# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The server of the page: for browsers of this machine, and for no other page or machine."""
from __future__ import annotations

from collections.abc import Awaitable, Callable
import os
import socket
from typing import Any

from fourbar_lab.live.page import Page
from fourbar_ros.errors import FourBarError
from fourbar_ros.scene.settings import ParameterValues
from nicegui import app, ui

HOST = '127.0.0.1'
NAMES = (HOST, 'localhost')
PORT = 8420
PATIENCE = 30.0         # [s] a tab that is silent for longer is forgotten
# No page of others may show this one in a frame, transparent above buttons of its own.
NOT_FRAMED = ((b'content-security-policy', b"frame-ancestors 'none'"),
              (b'x-frame-options', b'DENY'), (b'cross-origin-resource-policy', b'same-origin'))
HISTORY = 20            # messages kept for a tab that comes back; older ones: it loads again


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


def serve(title: str, values: ParameterValues, port: int, is_opened: bool) -> None:
    """Serve the page of a scene, one for each tab, until the process is interrupted."""
    async def page() -> None:
        # nothing is made for what only asks and never opens a socket, as an image tag
        await ui.context.client.connected()
        Page(title, values, dict(ui.context.client.request.query_params)).build()

    ui.page('/', title=f'{title} - fourbar live')(page)
    app.add_middleware(OnlyHere, port=port)
    app.on_startup(lambda: print(f'http://{HOST}:{port}  (Ctrl-C ends it)', flush=True))
    ui.run(host=HOST, port=port, title='fourbar live', dark=None, language='en-US', reload=False,
           show=is_opened, show_welcome_message=False, favicon='⚙️',
           reconnect_timeout=PATIENCE, message_history_length=HISTORY,
           # nothing is gained by packing what stays on this machine; Quasar's classes are enough
           gzip_middleware_factory=None, ws_per_message_deflate=False, tailwind=False)
