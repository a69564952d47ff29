# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The server of the page: for browsers of this machine, and for no other page or machine."""
from contextlib import suppress
import json
import os
from pathlib import Path
import socket

from fourbar_lab.live.answers import Answer, answered, ANSWERS, scene_of
from fourbar_lab.live.page import as_json, page
from fourbar_ros.errors import FourBarError
from fourbar_ros.scene import files
from fourbar_ros.scene.scene import load, Scene
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.middleware.base import BaseHTTPMiddleware, RequestResponseEndpoint
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route
import uvicorn

HOST = '127.0.0.1'
NAMES = (HOST, 'localhost')
PORT = 8420
LARGEST = 1_000_000         # [bytes] of a question
# No page of others may show this one in a frame, transparent above buttons of its own.
HEADERS = {'content-security-policy': "frame-ancestors 'none'", 'x-frame-options': 'DENY',
           'cross-origin-resource-policy': 'same-origin', 'cache-control': 'no-store',
           'x-content-type-options': 'nosniff'}


class PortTaken(FourBarError, OSError):
    """The port of the page is in use, or no port."""


def app_of(path: str | Path | None, scene: Scene | None, port: int, second: Scene | None = None
           ) -> Starlette:
    """Return the application that serves the page of a scene, None: an empty one."""
    # neither a shipped scene nor one of several nodes in a file is written over
    file, node = files.located(path) if path else (Path(), None)
    can_save = bool(path) and not node and file not in files.shipped().values()

    def html(request: Request) -> Response:
        name = request.query_params.get('scene', '')
        is_other = name not in ('', str(path), _title(path))
        try:
            shown = load(files.shipped()[name]) if is_other else scene
        except KeyError:
            return PlainTextResponse(f'this page shows {_title(path)}, and scenes that come with '
                                     f'fourbar: start fourbar live {name}\n', 404)
        return Response(page(name if is_other else _title(path), shown, True,
                             can_save and not is_other, second), media_type='text/html')

    def answer(question: str, asked: Answer) -> Answer:
        if question != 'save':
            return answered(question, asked)
        if not can_save:
            why = 'is one of several in its file' if node else 'comes with fourbar'
            return {'problem': f'{_title(path)} {why} and is not written over'}
        try:
            file.write_text(scene_of(asked.get('scene', {})).as_text, encoding='utf-8')
        except (FourBarError, OSError) as error:
            return {'problem': str(error)}
        return {'saved': str(file)}

    async def asked(request: Request) -> Response:
        question = request.path_params['question']
        if question not in (*ANSWERS, 'save'):
            return PlainTextResponse('no such question\n', 404)
        body = b''
        async for part in request.stream():
            body += part
            if len(body) > LARGEST:
                return PlainTextResponse(f'at most {LARGEST} bytes\n', 413)
        try:
            tree = json.loads(body)
        except (ValueError, RecursionError):
            tree = None
        if not isinstance(tree, dict):
            return PlainTextResponse('must be an object of JSON\n', 400)
        return Response(as_json(await run_in_threadpool(answer, question, tree)),
                        media_type='application/json')

    async def only_here(request: Request, answer: RequestResponseEndpoint) -> Response:
        # a page elsewhere could reach this one by a script in the browser: its Origin shows it
        response = (await answer(request) if request.headers.get('origin') in (
            None, *(f'http://{name}:{port}' for name in NAMES))
            else PlainTextResponse('only for this machine\n', 403))
        response.headers.update(HEADERS)
        return response

    return Starlette(routes=[Route('/', html), Route('/{question}', asked, methods=['POST'])],
                     middleware=[Middleware(BaseHTTPMiddleware, dispatch=only_here), Middleware(
                         TrustedHostMiddleware, allowed_hosts=list(NAMES), www_redirect=False)])


def _title(path: str | Path | None) -> str:
    return files.name_of(path) if path else 'drawing'


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


def serve(path: str | Path | None, scene: Scene | None, port: int, is_opened: bool,
          second: Scene | None = None) -> None:
    """Serve the page of a scene until the process is interrupted."""
    server = uvicorn.Server(uvicorn.Config(app_of(path, scene, port, second),
                                           log_level='warning'))
    # listens before its address is said: a browser may be quicker than uvicorn; Ctrl-C ends it
    with socket.create_server((HOST, port)) as listening, suppress(KeyboardInterrupt):
        print(f'http://{HOST}:{port}  (Ctrl-C ends it)', flush=True)
        if is_opened:
            import webbrowser
            webbrowser.open(f'http://{HOST}:{port}')
        server.run(sockets=[listening])
