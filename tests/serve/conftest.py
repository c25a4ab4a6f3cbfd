"""A service on a port of this machine, and a client of it that needs nothing but the standard library."""

from __future__ import annotations

import http.client
import json as json_
import socket
import threading
from dataclasses import dataclass

import pytest


@dataclass
class Answer:
    status_code: int
    headers: dict[str, str]
    content: bytes

    @property
    def text(self):
        return self.content.decode()

    def json(self):
        return json_.loads(self.content)


class Client:
    """What asks a service, from an address of its own."""

    def __init__(self, app, port, address="127.0.0.1", server=None):
        self.app, self.port, self.address, self.server = app, port, address, server

    def request(self, method, path, *, json=None, content=None, headers=()):
        said = dict(headers)
        if json is not None:
            content, said = json_.dumps(json).encode(), {"Content-Type": "application/json", **said}
        connection = http.client.HTTPConnection("127.0.0.1", self.port, source_address=(self.address, 0))
        try:
            connection.request(method, path, content, said, encode_chunked=True)
            got = connection.getresponse()
            return Answer(got.status, {name.lower(): value for name, value in got.getheaders()}, got.read())
        finally:
            connection.close()

    def get(self, path, **said):
        return self.request("GET", path, **said)

    def post(self, path, **said):
        return self.request("POST", path, **said)

    def from_address(self, address):
        return Client(self.app, self.port, address)


class Served:
    """An application that runs in a thread of this process."""

    def __init__(self, app):
        import uvicorn

        from canon.serve import Limits
        from canon.serve.http_server import configured

        self.app = app
        self.server = uvicorn.Server(configured(app, Limits()))
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.thread = threading.Thread(target=self.server.run, args=([self.listening],))

    def __enter__(self):
        self.thread.start()
        while not self.server.started:
            assert self.thread.is_alive()
            self.thread.join(0.02)
        return Client(self.app, self.listening.getsockname()[1], server=self.server)

    def __exit__(self, *_):
        self.server.should_exit = True
        self.thread.join()
        self.listening.close()


@pytest.fixture(scope="session")
def running():
    """Return what runs an application while a ``with`` lasts and gives a client of it."""
    return Served
