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
from starlette.datastructures import Headers
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.responses import PlainTextResponse

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
    ASGI middleware that refuses requests to other hosts' names and of other pages.

    A page elsewhere could otherwise reach this one through the browser: by its own name bound to
    this address (the Host header shows it), or by a script of its own (Origin does).
    """

    def __init__(self, served: Asgi, port: int):
        self.served = TrustedHostMiddleware(served, list(NAMES), www_redirect=False)
        self.origins = {f'http://{name}:{port}' for name in NAMES}

    async def __call__(self, scope: Scope, receive: Asgi, send: Asgi) -> None:
        """Serve a request, or refuse it with status 403; of a websocket, with code 1008."""
        async def send_for_us(message: Scope) -> None:
            """Send, with headers that forbid frames around our pages."""
            if message['type'] == 'http.response.start':
                message['headers'] = [*message['headers'], *NOT_FRAMED]
            await send(message)

        origin = (Headers(scope=scope).get('origin') if scope['type'] in ('http', 'websocket')
                  else None)
        if origin is None or origin in self.origins:
            await self.served(scope, receive, send_for_us)
        elif scope['type'] == 'websocket':
            await send({'type': 'websocket.close', 'code': 1008})
        else:
            await PlainTextResponse('only for this machine\n', 403)(scope, receive, send_for_us)


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
