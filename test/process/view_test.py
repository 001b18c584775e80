"""The server of `ringctl view` under attack: nothing is given without its token, nothing is done that it was not told to
allow, nothing grows without a limit, and the ring does not notice."""

import json
import os
import random
import socket
import struct
import sys

import ring_process
from ring_process import plain_nodes
from view_process import ViewTest


def memory_of(process):
    """Bytes in memory."""
    with open('/proc/%d/statm' % process.pid) as file:
        return int(file.read().split()[1]) * os.sysconf('SC_PAGE_SIZE')


class View(ViewTest):
    def setUp(self):
        super().setUp()
        self.start_ring(plain_nodes(4))
        self.send_delivered(0, 2)
        self.before = self.losses()  # a ring that is being closed tries some packets twice

    def losses(self):
        names = ('crc_errors', 'timeouts', 'input_losses', 'ended_lost', 'stalled_packets')
        return [{name: self.counters(node)[name] for name in names} for node in range(4)]

    def assert_unaffected(self):
        """All nodes are up, and nothing was lost on a line meanwhile."""
        self.assertTrue(self.is_closed(range(4)))
        self.send_delivered(0, 2)
        self.assertEqual(self.losses(), self.before)

    def assert_serves(self):
        self.assertEqual(self.get('')[0], 200)

    def test_the_page_and_its_files_are_served_and_say_that_nothing_else_may_be_loaded(self):
        self.view()
        for path in ('', 'index.html', 'style.css', 'view.mjs', 'ring.mjs', 'model.mjs', 'graphs.mjs', 'source.mjs'):
            self.assertEqual(self.get(path)[0], 200, path)
        with self.connected() as client:
            client.sendall(self.request('/%s/' % self.token))
            head = client.recv(65536)
        self.assertIn(b"default-src 'self'", head)
        self.assertIn(b'Referrer-Policy: no-referrer', head)

    def test_without_the_token_nothing_is_given(self):
        self.view('--control')
        wrong = ['/', '/events', '/' + self.token[:-1] + '/', '/' + self.token + 'a/', '/' + self.token.upper() + 'A/events',
                 '/%s/' % ('0' * len(self.token)), '//' + self.token + '/', '/?' + self.token, '*', self.token]
        for path in wrong:
            self.assertIn(self.answer(self.request(path))[0], (400, 403), path)
            self.assertIn(self.answer(self.request(path, 'POST', b'["stop"]'))[0], (400, 403), path)
        self.assert_unaffected()

    def test_other_hosts_and_origins_are_refused(self):
        self.view('--control')
        for host in ('evil.example:%d' % self.port_of_view, '127.0.0.1', '127.0.0.1:1', 'localhost', None, '',
                     '127.0.0.1.evil.example:%d' % self.port_of_view):
            self.assertEqual(self.get('', Host=host)[0], 403, host)
        for origin in ('http://evil.example', 'null', '', 'https://127.0.0.1:%d' % self.port_of_view, 'http://127.0.0.1:1'):
            self.assertEqual(self.get('', Origin=origin)[0], 403, origin)
            self.assertEqual(self.order('fault', 'cut', 'node0:node1', Origin=origin)[0], 403, origin)
        self.assertEqual(self.get('', Origin='http://127.0.0.1:%d' % self.port_of_view)[0], 200)
        self.assertEqual(self.get('', Host='localhost:%d' % self.port_of_view)[0], 200)
        self.assert_unaffected()

    def test_no_path_leads_to_another_file(self):
        self.view()
        for path in ('../config/leg8.yaml', '..%2fconfig%2fleg8.yaml', '%2e%2e/%2e%2e/etc/passwd', '/etc/passwd',
                     './index.html', 'index.html/', 'index.html%00', 'node/../index.html', 'node/', 'node/0x0',
                     'node/999', '....//....//etc/passwd', 'view.mjs?x=../../etc/passwd'):
            self.assertEqual(self.get(path)[0], 404, path)

    def test_what_nodes_have_heard_of_others_is_asked_for_only_while_one_does_not_answer(self):
        self.view()
        page = self.stream()

        def row():
            self.events_until(page, lambda kind, message: kind == 'status')
            return json.loads(self.get('node/1')[1])
        self.assertNotIn('heard', row())
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'kill', 'node3').returncode, 0)
        self.wait('it is asked for', lambda: 'heard' in row())
        self.assertEqual(self.ctl('--ring', self.ring, 'fault', 'start', 'node3').returncode, 0)
        self.wait('it is not asked for any more', lambda: 'heard' not in row())

    def test_the_ring_is_told_with_what_is_wired_to_each_node(self):
        self.view()
        ring = self.events_until(self.stream(), lambda kind, message: kind == 'ring')
        self.assertEqual(ring['nodes'][1]['pins'], ['INT0: reset', 'INT1: stop', 'INT2: sync'])
        self.assertEqual(ring['nodes'][1]['inputs'], [])

    def test_a_page_that_may_only_read_changes_nothing(self):
        self.view()
        for words in (['fault', 'cut', 'node0:node1'], ['stop'], ['fault', 'kill', 'node1']):
            self.assertEqual(self.order(*words)[0], 403)
        for method in ('PUT', 'DELETE', 'HEAD', 'OPTIONS', 'BREW'):
            self.assertIn(self.answer(self.request('/%s/' % self.token, method))[0], (400, 405), method)
        self.assert_unaffected()

    def test_with_control_it_may_order_what_the_page_has_buttons_for_and_no_more(self):
        self.view('--control')
        for words in (['down'], ['up', 'x.yaml'], ['fault'], ['fault', 'babble', 'node1'], ['fault', 'cut', 'node0:node1', '--for=1s'],
                      ['stop', '--from', 'node1'], ['reset', 'n1; rm -rf /'], ['reset', '$(id)'], ['reset', 'n1\x00'], [''],
                      ['clock', 'sync'], ['stop'] * 7, ['reset', 'x' * 65], ['reset', 'n\xe4']):
            self.assertEqual(self.order(*words)[0], 400, words)
        for body in (b'{"a": 1}', b'[1]', b'[', b'[[["stop"]]]', b'[' * 4000, b'"stop"', b'\xff\xfe', b'null'):
            self.assertEqual(self.answer(self.request('/%s/order' % self.token, 'POST', body))[0], 400, body)
        self.assertEqual(self.order('stop', Content_Type='text/plain')[0], 415)
        self.assert_unaffected()

    def test_a_wire_is_cut_and_mended_by_orders_and_each_page_sees_it(self):
        self.view('--control')
        page = self.stream()
        status, answer = self.order('fault', 'cut', 'node1:node2')
        self.assertEqual((status, answer['code']), (200, 0), answer)
        broken = self.events_until(page, lambda kind, message: kind == 'status' and message['broken_line'])
        self.assertEqual((broken['broken_line']['before'], broken['broken_line']['behind']), (1, 2))
        self.assertEqual(self.order('fault', 'heal', 'node1:node2')[1]['code'], 0)
        self.events_until(page, lambda kind, message: kind == 'status' and not message['broken_line'] and
                          all(row['state'] == 'up' for row in message['rows']))
        self.assertEqual(self.order('fault', 'cut', 'node1:nobody')[1]['code'], 2)

    def test_huge_and_broken_requests_end_and_the_next_one_is_served(self):
        self.view('--control')
        start = ('GET /%s/ HTTP/1.1\r\nHost: ' % self.token).encode()
        broken = [start + b'x' * 10 ** 6, start + b'x\r\n' * 10 ** 5, b'\x00' * 100 + b'\r\n\r\n', b'\x16\x03\x01\x02\x00' * 50,
                  b'GET\r\n\r\n', b'GET / HTTP/9.9\r\n\r\n', self.request('/%s/order' % self.token, 'POST', b'[' + b' ' * 10 ** 6 + b']'),
                  self.request('/%s/order' % self.token, 'POST', b'["stop"]', Content_Length=2 ** 63),
                  self.request('/%s/order' % self.token, 'POST', b'["stop"]', Content_Length=-1),
                  self.request('/' + 'a' * 20000), start + b'x\r\nTransfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\nx']
        for request in broken:
            self.assertIn(self.answer(request)[0], (0, 400, 403, 405, 413, 431), request[:80])
            self.assert_serves()
        self.assert_unaffected()

    def test_a_request_that_never_ends_is_ended(self):
        self.view()
        with self.connected() as silent, self.connected() as half:
            half.sendall(b'GET /')
            self.assertEqual(self.read_answer(silent)[1], b'')
            self.assertEqual(self.read_answer(half)[1], b'')
        self.assert_serves()

    def test_connections_and_pages_have_a_limit_and_are_taken_again_below_it(self):
        server = self.view()
        crowd = [self.connected() for _ in range(200)]
        self.wait('those that are too many are closed', lambda: self.sockets_of(server) < 80)
        for client in crowd:
            client.close()
        self.wait('it serves again', lambda: self.get('')[0] == 200)
        pages = [self.stream() for _ in range(16)]
        for page in pages:
            self.events_until(page, lambda kind, message: kind == 'view')
        self.assertEqual(self.get('events')[0], 503)
        pages.pop().close()
        again = self.wait('a place', self.stream_with_room)
        self.events_until(again, lambda kind, message: kind == 'status')
        self.assert_unaffected()

    def stream_with_room(self):
        page = self.stream()
        if b' 200 ' in page.recv(15):
            return page
        page.close()
        return None

    def test_it_asks_the_ring_only_while_a_page_looks(self):
        server = self.view()
        idle = self.sockets_of(server)
        self.assert_serves()
        self.wait('what asked for the page is gone', lambda: self.sockets_of(server) == idle)
        page = self.stream()
        self.events_until(page, lambda kind, message: kind == 'status')
        self.wait('it asks the four daemons', lambda: self.sockets_of(server) == idle + 1 + 4)
        page.close()
        self.wait('its connections to the daemons end', lambda: self.sockets_of(server) <= idle)

    def test_a_page_that_reads_too_slowly_is_dropped_and_the_others_go_on(self):
        server = self.view()
        good = self.stream()
        self.events_until(good, lambda kind, message: kind == 'status')
        with_good = self.sockets_of(server)
        slow = self.stream(receive_buffer=2048)
        self.wait('it is there', lambda: self.sockets_of(server) == with_good + 1)
        self.start('ping', [ring_process.program('ringctl'), '--ring', self.ring, 'ping', '--from', 'node1', '--to', 'node2',
                            '-c', '1000000', '-i', '0.001'])
        while self.sockets_of(server) > with_good:
            self.events_until(good, lambda kind, message: kind == 'packets')
        self.events_until(good, lambda kind, message: kind == 'status')
        slow.close()

    def test_random_requests_get_nothing_and_the_ring_does_not_notice(self):
        """ATTACKS=300000 sends so many (they took three minutes), ATTACK_SEED repeats some."""
        seed, count = int(os.environ.get('ATTACK_SEED', random.randrange(10 ** 9))), int(os.environ.get('ATTACKS', 400))
        print('ATTACK_SEED=%d' % seed, file=sys.stderr, flush=True)
        chance = random.Random(seed)
        for control in (True, False):  # without the token; with it, where nothing may be changed
            server = self.view(*(['--control'] if control else []))
            idle, open_ones, given = self.sockets_of(server), [], 0
            page = self.stream()
            self.events_until(page, lambda kind, message: kind == 'status')
            for number in range(count // 2):
                with self.subTest(seed=seed, number=number, control=control):
                    request = self.attack(chance, 'x' * 32 if control else self.token)
                    self.assertNotIn(self.token.encode(), request if control else b'')
                    given += self.attack_once(chance, request, open_ones, nothing=control)
            self.assertIsNone(server.poll())
            for client in open_ones + [page]:
                client.close()
            self.assertTrue(not control or given == 0)
            self.wait('all that was open is closed', lambda: self.sockets_of(server) <= idle)
            with self.stream() as again:
                self.events_until(again, lambda kind, message: kind == 'status')
            self.assertLess(memory_of(server), 64 << 20)
        self.assert_unaffected()

    def attack(self, chance, token):
        """A request that is nearly right, then changed somewhere."""
        path = chance.choice(['', 'events', 'order', 'node/1', 'log/1', 'index.html', '../' * chance.randrange(9) + 'etc/passwd', 'a' * chance.randrange(9000)])
        words = chance.sample(['fault', 'cut', 'kill', 'node0:node1', 'node1', 'stop', 'reset', 'clock', '--from', ';', '\x00', 'clear'], chance.randrange(1, 5))
        headers = chance.choice([{}, {'Host': None}, {'Origin': 'http://evil.example'}, {'Transfer-Encoding': 'chunked'}, {'Content-Length': 2 ** 40},
                                 {'Expect': '100-continue'}, {'Connection': 'Upgrade', 'Upgrade': 'websocket'}, {'Cookie': 'x' * 9000}])
        method = chance.choice(['GET'] * 5 + ['POST'] * 3 + ['PUT', 'HEAD', 'TRACE', 'CONNECT', 'get', ''])
        body = json.dumps(words).encode() * chance.choice([1, 1, 1, 900]) if method == 'POST' else b''
        request = bytearray(self.request('/%s/%s' % (token, path), method, body, **headers))
        for _ in range(chance.choice([0, 0, 1, 3, 50])):
            at = chance.randrange(len(request))
            request[at:at + chance.randrange(3)] = bytes(chance.choice(b'\x00\r\n :/%{}[]"\xff' + b'azAZ09') for _ in range(chance.randrange(3)))
        return bytes(request[:chance.choice([None, None, None, chance.randrange(len(request) + 1)])]) * chance.choice([1, 1, 1, 3])

    def attack_once(self, chance, request, open_ones, nothing):
        """@param nothing may be given @return 1 where something was"""
        client = self.connect(receive_buffer=chance.choice([None, 2048]))
        try:
            client.sendall(request)
            end = chance.randrange(4)
            if end == 0:  # leaves at once, without a word
                client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
            elif end == 1:  # stays, and reads nothing
                open_ones.append(client)
                if len(open_ones) > 40:
                    open_ones.pop(0).close()
                return 0
            else:
                client.shutdown(socket.SHUT_WR)
                head = client.recv(65536)
                given = head.startswith(b'HTTP/1.1 200 ')
                self.assertFalse(given and nothing, request[:200])
                self.assertRegex(head[:16], rb'^(HTTP/1.1 (200|400|403|404|405|413|415|431|503) |$)', request[:200])
                client.close()
                return int(given)
        except OSError:
            pass  # answered, and closed, before all of it came
        client.close()
        return 0

    def test_an_address_that_is_invalid_or_taken_is_reported(self):
        taken = socket.socket()
        self.addCleanup(taken.close)
        taken.bind(('127.0.0.1', 0))
        taken.listen(1)
        for more, why in ((('--address', 'nowhere'), 'not an address'), (('--port', str(taken.getsockname()[1])), 'in use')):
            done = self.ctl('--ring', self.ring, 'view', *more)
            self.assertEqual(done.returncode, 2)
            self.assertIn(why, done.stderr)


class ViewOfADetachedRing(ViewTest):
    def test_the_log_of_a_node_is_given_and_nothing_else_of_that_folder(self):
        config = self.write_ring(plain_nodes(2))
        done = self.ctl('up', config, '--detach')
        self.addCleanup(self.ctl, 'down', '--ring', self.ring)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.view()
        status, body = self.get('log/1')
        self.assertEqual(status, 200)
        with open(os.path.join(self.ring_folder(), '1.log'), 'rb') as file:
            written = file.read()
        self.assertIn(b'node1', body)
        self.assertTrue(written.endswith(body) or body.endswith(written[-200:]), body)
        self.assertIn(b'No log is kept', self.get('log/2')[1])
        for path in ('log/', 'log/255', 'log/1.log', 'log/ring', 'log/-1', 'log/0x1', 'log/../1.lock', 'log/%31', 'log/1/', 'log/9999999999'):
            self.assertEqual(self.get(path)[0], 404, path)
        with open(os.path.join(self.ring_folder(), '1.log'), 'ab') as file:
            file.write(b''.join(b'line %d\n' % i for i in range(10 ** 5)))
        status, body = self.get('log/1')
        self.assertTrue(body.endswith(b'line 99999\n') and len(body) <= 16384 and body.startswith(b'line '), body[:40])


if __name__ == '__main__':
    ring_process.main()
