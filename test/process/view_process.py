"""`ringctl view` for tests: a ring, its server, and a client that speaks HTTP byte by byte; and what a browser needs."""

import json
import os
import re
import shutil
import socket
import subprocess
from urllib.parse import urlsplit

from ring_process import GUARD, RingTest, program


WEB = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'web')
NODE = shutil.which('node')
CHROMIUM = shutil.which('chromium') or shutil.which('chromium-browser') or shutil.which('google-chrome')


def has_playwright():
    return NODE and subprocess.run([NODE, '-e', 'require("playwright-core")'], cwd=WEB, stderr=subprocess.DEVNULL).returncode == 0


class ViewTest(RingTest):
    def view(self, *more):
        """A server for this test's ring; sets `address`, `port`, `token`."""
        server = self.start('view', [program('ringctl'), '--ring', self.ring, 'view', *more])
        said = self.wait('its address', lambda: re.search(r'http://\S+', self.log_of(server)))
        self.address = said.group(0)
        self.port_of_view = urlsplit(self.address).port
        self.token = urlsplit(self.address).path.strip('/')
        return server

    def connected(self, receive_buffer=None):
        client = self.connect(receive_buffer)
        self.addCleanup(client.close)
        return client

    def connect(self, receive_buffer=None):
        """For those who close it."""
        client = socket.socket()
        if receive_buffer:
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        client.settimeout(GUARD)
        client.connect(('127.0.0.1', self.port_of_view))
        return client

    def request(self, path, method='GET', body=b'', **headers):
        """Bytes of a request; a header given as None is left out."""
        usual = {'Host': '127.0.0.1:%d' % self.port_of_view}
        if body:
            usual.update({'Content-Length': len(body), 'Content-Type': 'application/json'})
        usual.update({name.replace('_', '-'): value for name, value in headers.items()})
        lines = ['%s: %s' % header for header in usual.items() if header[1] is not None]
        return '\r\n'.join(['%s %s HTTP/1.1' % (method, path)] + lines + ['', '']).encode('latin-1') + body

    def answer(self, request):
        """(status, body); (0, b'') where the connection was closed without an answer."""
        with self.connected() as client:
            try:
                client.sendall(request)
            except OSError:
                pass  # it has answered before all of it came
            return self.read_answer(client)

    @staticmethod
    def read_answer(client):
        data = b''
        try:
            while True:
                part = client.recv(65536)
                if not part:
                    break
                data += part
        except ConnectionResetError:
            pass
        head, _, body = data.partition(b'\r\n\r\n')
        return (int(head.split()[1]) if head else 0), body

    def get(self, path, **headers):
        return self.answer(self.request('/%s/%s' % (self.token, path), **headers))

    def order(self, *words, **headers):
        """(status, answer) of an order of the page."""
        status, body = self.answer(self.request('/%s/order' % self.token, 'POST', json.dumps(words).encode(), **headers))
        return status, json.loads(body) if status == 200 else body.decode()

    def stream(self, **options):
        """A page that looks: its connection, which has begun."""
        client = self.connected(**options)
        client.sendall(self.request('/%s/events' % self.token))
        return client

    def events_until(self, client, found):
        """Reads a stream until found(kind, message) is true; returns that message."""
        data = b''
        while True:
            part = client.recv(65536)
            self.assertTrue(part, 'the stream has ended')
            data += part
            *whole, data = data.split(b'\n\n')
            for event in whole:
                kind = re.search(rb'^event: (\w+)', event, re.M)
                if not kind:
                    continue
                message = json.loads(event.split(b'data: ', 1)[1])
                if found(kind.group(1).decode(), message):
                    return message

    @staticmethod
    def sockets_of(server):
        """How many sockets the server has open."""
        folder = '/proc/%d/fd' % server.pid
        links = []
        for entry in os.listdir(folder):
            try:
                links.append(os.readlink(os.path.join(folder, entry)))
            except FileNotFoundError:
                pass
        return sum(link.startswith('socket:') for link in links)
