"""Waits of a HostPort that a signal interrupts: Ctrl-C, and exceptions out of a signal's handler."""
import os
import select
import signal
import socket
import threading
import time

import pytest

from limb_ring import HostPort, HostPortError, HostPortTimeout, Packet

RING = {'ring': 'ports', 'nodes': [
    {'id': 0, 'name': 'body', 'cpu': 'attached'}, {'id': 1, 'name': 'knee', 'cpu': 'attached'}, {'id': 2, 'name': 'spare'}]}
needs_ring = pytest.mark.ring(RING)


@needs_ring
def test_ctrl_c_ends_a_wait(ring):
    port = ring.port('body')
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        port.receive(60)
    assert time.monotonic() - begun < 30   # long before its deadline
    assert port.ask({'do': 'status'})['state'] == 'up'


# ---- exceptions out of a signal's handler -------------------------------------------------

class Alarm(Exception):
    pass


@pytest.fixture
def alarms():
    def ring_alarm(*_):
        raise Alarm()
    before = signal.signal(signal.SIGUSR1, ring_alarm)
    yield
    signal.signal(signal.SIGUSR1, before)


def in_use(port):
    try:
        return port.id is None
    except HostPortError:
        return True


def waits_at(port):
    while not in_use(port):
        time.sleep(0.001)


def disturb(wait, ready, then=lambda: None):
    """A signal's handler raises during wait(), as soon as ready() has returned; what then() brings comes behind it."""
    def helper():
        ready()
        signal.raise_signal(signal.SIGUSR1)   # Python's handlers run in the main thread
        then()
    thread = threading.Thread(target=helper)
    with pytest.raises(Alarm):
        thread.start()
        wait()
    thread.join()


@needs_ring
def test_a_packet_that_comes_with_a_signal_stays_for_the_next_receive(ring, alarms):
    body, knee = ring.port('body', role='cpu'), ring.port('knee')
    for wait in lambda: body.receive(60), lambda: body.next_of(Packet, 60):
        disturb(wait, lambda: waits_at(body), lambda: knee.send(0, b'not lost'))
        assert wait().data == b'not lost'


@needs_ring
def test_a_result_or_an_answer_that_comes_with_a_signal_stays_for_the_next_wait(ring, alarms):
    port, pid = ring.port('spare'), ring.status('spare')['pid']
    for ask, wait in ((lambda: port.send(0, b'x'), port.wait), (lambda: port.request({'do': 'status'}), port.answer)):
        os.kill(pid, signal.SIGSTOP)
        token = ask()
        disturb(lambda: wait(token, 60), lambda: waits_at(port), lambda: os.kill(pid, signal.SIGCONT))
        assert wait(token, 60)


@needs_ring
def test_a_message_at_which_the_function_of_find_raises_stays(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee')
    knee.send(0, b'x')
    with pytest.raises(ZeroDivisionError):
        body.find(lambda message: 1 // 0, timeout=60)
    assert body.receive(0).data == b'x'


@pytest.mark.ring(RING, clock='virtual')
def test_a_signal_is_heard_while_a_virtual_ring_is_paused(ring, alarms):
    cpu, tool, knee = ring.port('body', role='cpu', lockstep=True), ring.port('body'), ring.port('knee')
    ring.ctl('clock', 'pause')
    stands = tool.now()
    disturb(lambda: tool.sleep_until(stands + 3600), lambda: waits_at(tool))
    disturb(lambda: cpu.receive(0.2), lambda: waits_at(cpu))
    disturb(lambda: cpu.sleep_until(3600), lambda: waits_at(cpu))
    disturb(lambda: cpu.send(2, b'only in its turn'), lambda: None)
    assert tool.now() == stands
    ring.ctl('clock', 'run')
    assert cpu.wait(cpu.send(2, b'x')).outcome == 'delivered'
    knee.send(0, b'hello')
    assert cpu.next_of(Packet).data == b'hello'


@pytest.fixture
def silent_daemon(tmp_path):
    """A socket where that of node 3 of ring `r` would be: nobody answers there."""
    folder = tmp_path / 'limb_ring' / 'r'
    folder.mkdir(parents=True, mode=0o700)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(folder / '3.host'))
        listening.listen(100)
        yield listening


def tries_at(listening):
    count = 0
    while select.select([listening], [], [], 0)[0]:
        listening.accept()[0].close()
        count += 1
    return count


def test_a_daemon_that_is_frozen_is_tried_once(tmp_path, silent_daemon, alarms):
    with pytest.raises(HostPortTimeout, match='is it stopped'):
        HostPort.connect(ring='r', node=3, timeout=0.5, runtime=str(tmp_path))
    assert tries_at(silent_daemon) == 1
    disturb(lambda: HostPort.connect(ring='r', node=3, timeout=600, runtime=str(tmp_path)),
            lambda: select.select([silent_daemon], [], [], 60))
    assert tries_at(silent_daemon) == 1
