"""HostPort on a live ring: what is sent, received and refused, deadlines, other threads."""
import pydoc
import select
import threading
import time

import pytest

import limb_ring
from limb_ring import (BROADCAST, HostPort, HostPortError, HostPortTimeout, JointCommand, JointState, Packet, Result,
                       RingError)

RING = {'ring': 'ports', 'nodes': [
    {'id': 0, 'name': 'body', 'cpu': 'attached', 'pins': {'3': 'notify'}},
    {'id': 1, 'name': 'knee', 'cpu': 'attached', 'inputs': {'0': {'to': 'body', 'factor': 3}}},
    {'id': 2, 'name': 'spare'}]}
needs_ring = pytest.mark.ring(RING)


@needs_ring
def test_packets_go_from_cpu_to_cpu(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee', role='cpu')
    assert (knee.id, knee.name, knee.ring) == (1, 'knee', 'ports')
    result = body.wait(body.send(1, b'hello', priority=1, channel=4))
    assert (result.outcome, result.why, result.tries, result.round_trip > 0) == ('delivered', '', 1, True)
    packet = knee.next_of(Packet)
    assert (packet.source, packet.destination, packet.priority, packet.channel) == (0, 1, 1, 4)
    assert (packet.data, packet.payload) == (b'hello', None)
    body.send(BROADCAST, bytes(512))
    assert knee.next_of(Packet).data == bytes(512)


@needs_ring
def test_payloads_are_sent_and_received_as_what_they_are(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee', role='cpu')
    body.send(1, JointCommand([JointCommand.Joint(position=0.25)]))
    told = knee.next_of(Packet).payload
    assert isinstance(told, JointCommand) and told.joints[0].position == 0.25
    knee.send(0, JointState([JointState.Joint(0.25, 0, 0)]))
    assert body.next_of(Packet).payload.joints[0].position == 0.25
    knee.send(0, b'\1 is the first byte of a state', channel=2)
    assert body.next_of(Packet).payload is None


@needs_ring
def test_what_next_of_passes_over_is_kept(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee', role='cpu')
    sent = knee.send(0, b'from the knee')
    first, second = body.send(2, b'one'), body.send(2, b'two')
    asked = body.request({'do': 'status'})
    assert body.next_of(Result).token == first
    assert body.next_of(Packet).data == b'from the knee'
    body.next_of(limb_ring.Reply)
    assert body.wait(second).outcome == 'delivered'
    assert knee.wait(sent).outcome == 'delivered'
    with pytest.raises(HostPortError, match='no reply is outstanding'):
        body.answer(asked, timeout=1)


@needs_ring
def test_interrupts_and_pulled_inputs(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee')
    assert knee.wait(knee.interrupt(0, 3)).outcome == 'delivered'
    pulled = body.next_of(limb_ring.Interrupt)
    assert (pulled.action, pulled.source, pulled.factor) == ('notify', 1, 3)
    assert knee.wait(knee.pull(0)).outcome == 'delivered'
    assert body.next_of(limb_ring.Interrupt).factor == 3
    refused = knee.wait(knee.interrupt(2, 7))
    assert (refused.outcome, refused.why) == ('refused', 'pin_unwired')
    assert 'INT7' in refused.reason


@needs_ring
def test_bad_arguments_are_results_that_say_so(ring):
    port = ring.port('body')
    assert port.wait(port.send(1, b'')).why == 'bad_size'
    assert port.wait(port.send(1, b'x', channel=64)).why == 'bad_channel'
    assert 'factors are 0 to 7' in port.wait(port.interrupt(1, 9)).reason
    for data in (5, 'hello'):
        with pytest.raises(TypeError, match='bytes are needed, not %r' % data):
            port.send(1, data)
    for call, said in ((lambda: port.send(256, b'x'), '0 to 254, or BROADCAST is needed, not 256'),
                       (lambda: port.send('knee', b'x'), "the id of a node, .* not 'knee'"),
                       (lambda: port.send(1, b'x', priority=-1), 'priority: 0 .highest. to 3 is needed, not -1'),
                       (lambda: port.send(1, b'x', channel=300), 'channel: 0 to 63'),
                       (lambda: port.interrupt(1, -1), 'factor: 0 to 7'), (lambda: port.pull(256), 'number: 0 to 7')):
        with pytest.raises(ValueError, match=said):
            call()


@needs_ring
def test_the_daemon_says_no_in_its_own_words(ring):
    port = ring.port('body')
    with pytest.raises(HostPortError, match="no request 'dance'"):
        port.ask({'do': 'dance'})
    cpu = ring.port('body', role='cpu')
    with pytest.raises(HostPortError, match='has a CPU already'):
        ring.port('body', role='cpu', timeout=30)   # at once: waiting would not help
    assert cpu.connected
    port.observe_text('{"kinds": ["weather"]}')
    assert 'weather' in port.next_of(limb_ring.Observed).content['error']


@needs_ring
def test_what_cannot_be_observed_is_refused_at_once(ring):
    port = ring.port('body')
    assert 'pin' in limb_ring.EVENT_KINDS
    for kind in 'weather', None, 5, '', ['pin']:
        with pytest.raises(ValueError, match='there is no kind of event .*; there are state, ring, link, .*, sent'):
            port.observe('pin', kind)
    for packets in 5, 'data', [], True:
        with pytest.raises(TypeError, match='packets: a dict is needed, .* or None, not'):
            port.observe(packets=packets)
    for promises in 1, None, 'yes':
        with pytest.raises(TypeError, match='promises: True or False is needed, not'):
            port.observe(promises=promises)
    with pytest.raises(TypeError, match='kinds'):
        port.observe(kinds=['pin'])   # which was taken for all kinds
    port.ask({'do': 'latch'})
    assert port.received(limb_ring.Observed) == []
    port.observe(packets={'kind': ['data']})
    assert "packets: 'kind' is unknown; there are at, kinds" in port.next_of(limb_ring.Observed).content['error']


@needs_ring
def test_a_node_that_is_not_there_is_answered_with_those_that_are(ring):
    for node in 'kne', 7:
        with pytest.raises(RingError, match='no node %s in this ring; it has: 0 .body., 1 .knee., 2 .spare.' % node):
            ring.port(node, timeout=60)
        with pytest.raises(HostPortTimeout, match='nodes of this ring here: body, knee, spare'):
            HostPort.connect(ring=ring.status()['ring'], node=node, runtime=ring.environment['XDG_RUNTIME_DIR'], timeout=0)


@needs_ring
def test_every_wait_ends_at_its_deadline(ring):
    port = ring.port('body')
    assert port.receive(0) is None
    assert port.receive(0.01) is None
    with pytest.raises(HostPortTimeout, match='no Packet came within 0.01 s'):
        port.next_of(Packet, timeout=0.01)
    with pytest.raises(TimeoutError):
        HostPort.connect(ring='no_such', node=3, timeout=0.05)
    with pytest.raises(ValueError, match='timeout'):
        port.receive(-1)
    with pytest.raises(ValueError, match='timeout: 0 s or more is needed, not nan'):
        port.next_of(Packet, timeout=float('nan'))
    with pytest.raises(ValueError, match="'tool' or 'cpu'"):
        HostPort.connect(ring='no_such', node=3, role='boss')
    with pytest.raises(HostPortError, match="ring 'a.b': a name has 1 to 32 letters"):
        HostPort.connect(ring='a\0b', node=3)
    for late in float('inf'), float('nan'), 1e300:
        with pytest.raises(ValueError, match=r'time_s: a time of now\(\) is needed, not'):
            port.sleep_until(late)
    for wrong in '5s', None, True:
        for call in (lambda: port.receive(wrong), lambda: port.wait(1, wrong), lambda: port.find(bool, wrong),
                     lambda: port.ask({'do': 'status'}, wrong), lambda: HostPort.connect(node=3, timeout=wrong)):
            with pytest.raises(TypeError, match='timeout: a number of seconds is needed, not'):
                call()
    for node in (None, 1.5, float('nan'), True, b'node1', ['node1']):
        with pytest.raises(TypeError, match="node: a node's name or id is needed, not "):
            HostPort.connect(ring='none', node=node, timeout=0)
    with pytest.raises(TypeError, match='ring: a text is needed, not None'):
        HostPort.connect(ring=None, node=3)


@pytest.mark.ring(RING, clock='virtual', pace='max')
def test_in_lockstep_every_wait_is_of_the_rings_time(ring):
    with ring.port('body', role='cpu', lockstep=True) as cpu, ring.port('body') as tool:
        assert cpu.in_lockstep and not tool.in_lockstep
        for wait in lambda: cpu.next_of(Packet, timeout=0.5), lambda: cpu.find(lambda _: False, timeout=0.5):
            begun = cpu.now()
            with pytest.raises(HostPortTimeout, match='within 0.5 s'):
                wait()
            assert cpu.now() - begun == pytest.approx(0.5, abs=1e-6)


@needs_ring
def test_a_daemon_that_is_frozen_is_reported_as_frozen(ring):
    port = ring.port('spare')
    ring.fault('freeze', 'spare')
    with pytest.raises(HostPortTimeout, match='did not answer within 0.1'):
        port.ask({'do': 'status'}, timeout=0.1)
    with pytest.raises(HostPortTimeout, match='is it stopped'):
        ring.port('spare', timeout=0.1)
    ring.fault('thaw', 'spare')


@needs_ring
def test_a_lost_connection_ends_every_send_and_says_so(ring):
    port = ring.port('spare')
    ring.fault('kill', 'spare')
    assert port.wait(port.send(0, b'x')).outcome == 'cancelled'
    assert port.next_of(limb_ring.Disconnected).reason
    assert port.receive(1) is None and not port.connected
    port.close()
    with pytest.raises(HostPortError, match='closed'):
        port.send(0, b'x')


@needs_ring
def test_other_threads_run_while_one_waits(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee')
    helper = threading.Thread(target=lambda: knee.send(0, b'from another thread'))
    helper.start()
    assert body.next_of(Packet, timeout=30).data == b'from another thread'
    helper.join()


@needs_ring
def test_a_second_thread_is_told_that_a_port_is_in_use(ring):
    body, knee, told = ring.port('body', role='cpu'), ring.port('knee'), []

    def disturb():
        while not told:
            try:
                body.receive(0)
            except HostPortError as refused:
                told.append(str(refused))
        knee.send(0, b'go on')
    disturber = threading.Thread(target=disturb)
    disturber.start()
    while not told:
        try:
            body.receive(0.05)
        except HostPortError as refused:
            told.append(str(refused))
    disturber.join()
    assert 'in use by another thread' in told[0]


@needs_ring
def test_it_works_in_an_event_loop(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee')
    knee.send(0, b'x')
    assert select.select([body], [], [], 30)[0] == [body]
    assert body.receive(0).data == b'x'


# ---- what next_of() has passed over -------------------------------------------------------

@needs_ring
def test_interrupts_come_first_also_before_what_was_passed_over(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee')

    def arrives(token):
        # 'delivered' says that body's controller has it: its CPU gets it a moment later.
        assert knee.wait(token).outcome == 'delivered'
        assert select.select([body], [], [], 60)[0]

    def pass_over():
        with pytest.raises(HostPortTimeout):
            body.next_of(Result, timeout=0.01)
    for data in b'a', b'b':
        arrives(knee.send(0, data))
        pass_over()
    for _ in range(2):
        arrives(knee.interrupt(0, 3))
        assert isinstance(body.receive(60), limb_ring.Interrupt)
        pass_over()
    arrives(knee.interrupt(0, 3))
    pass_over()
    assert [type(body.receive(0)) for _ in range(4)] == [limb_ring.Interrupt, Packet, Packet, type(None)]


@needs_ring
def test_what_is_passed_over_has_a_limit(ring, monkeypatch):
    monkeypatch.setattr('limb_ring.host_port.MOST_KEPT', 3)
    body, knee = ring.port('body', role='cpu'), ring.port('knee')
    for number in range(4):
        assert knee.wait(knee.send(0, bytes([number]))).outcome == 'delivered'
    for search in lambda: body.next_of(Result, timeout=60), lambda: body.received(Result):
        with pytest.raises(HostPortError, match='3 messages were left without receive'):
            search()
    assert len(body.received(Packet)) == 3
    assert body.next_of(Packet, timeout=60).data == b'\3'


@pytest.mark.ring(RING, clock='virtual')
def test_a_payload_without_a_stamp_has_the_rings_time(ring):
    body, knee = ring.port('body'), ring.port('knee', role='cpu')
    for command in JointCommand(valid_for=60), JointCommand(valid_for=60, stamp_ns=5):
        sent = body.stamp_ns()
        body.send(1, command)
        told = knee.next_of(Packet).payload
        assert told.stamp_ns == 5 if command.stamp_given else sent <= told.stamp_ns <= knee.stamp_ns()


@needs_ring
def test_messages_show_what_they_are(ring):
    body, knee = ring.port('body', role='cpu'), ring.port('knee')
    knee.interrupt(0, 3)
    assert repr(body.next_of(limb_ring.Interrupt)) == '<Interrupt INT3 from 1: notify>'
    token = knee.request({'do': 'latch'})
    assert repr(knee.next_of(limb_ring.Reply)).startswith('<Reply to token %d: {' % token)
    knee.observe_text('{"kinds": ["weather"]}')
    assert repr(knee.next_of(limb_ring.Observed)).startswith('<Observed {"error"')
    ring.ctl('down')
    end = knee.next_of(limb_ring.Disconnected)
    assert end.reason and repr(end) == '<Disconnected: %s>' % end.reason


def test_everything_has_a_docstring():
    for kind in HostPort, limb_ring.Ring:
        assert [name for name, what in vars(kind).items() if name[0] != '_' and not what.__doc__] == []


def test_every_argument_has_a_name():
    nameless = [name for name in limb_ring.__all__
                if 'arg0' in pydoc.render_doc(getattr(limb_ring, name), renderer=pydoc.plaintext)]
    assert nameless == []
