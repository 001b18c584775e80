"""Ring and the fixtures of pytest_plugin."""
import json
import os
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

import limb_ring
from limb_ring import Ring, RingError, find_config
from limb_ring.processes import is_gone
from limb_ring.ring import programs_folder

pytest_plugins = ['pytester']

BOTH_CLOCKS = pytest.mark.parametrize('clock', ['machine', 'virtual'])


def plain(name, **knee):
    return {'ring': name, 'timeouts': {'send': '1s'},
            'nodes': [{'id': 0, 'name': 'body'}, dict({'id': 1, 'name': 'knee'}, **knee)]}


@BOTH_CLOCKS
def test_a_joint_that_hangs_is_reset(make_ring, clock):
    ring = make_ring('leg8.yaml', clock=clock)
    ring.wait('left_knee', 'running')
    boots = ring.cpu('left_knee')['boots']
    ring.fault('hang', 'left_knee')
    assert ring.cpu('left_knee')['state'] == 'hung'
    ring.reset('left_knee')
    assert ring.cpu('left_knee')['boots'] == boots + 1
    assert ring.send('head', 'left_knee', b'hello').outcome == 'delivered'


@BOTH_CLOCKS
def test_a_broken_wire_is_waited_for_and_mended(make_ring, clock):
    ring = make_ring(plain('wire'), clock=clock)
    ring.fault('cut', 'body:knee')
    for node in 'body', 'knee':
        ring.wait(node, 'open_chain')
    sent = ring.send('knee', 'body', b'x')
    assert sent.outcome == 'unconfirmed', sent
    ring.clear_faults()
    ring.wait('up')
    assert ring.send('body', 'knee', b'x').outcome == 'delivered'


@BOTH_CLOCKS
def test_nodes_die_freeze_and_come_again(make_ring, clock):
    ring = make_ring({'ring': 'faulty', 'nodes': [{'id': id_} for id_ in range(4)]}, clock=clock)
    ring.fault('kill', 'node2')
    ring.wait('node2', 'down')
    with pytest.raises(limb_ring.HostPortError):
        ring.port('node2', timeout=0)
    ring.fault('freeze', 'node1')
    ring.wait('node1', 'frozen')
    with pytest.raises(RingError, match='is frozen'):
        ring.fault('cut', 'node1:node2')
    ring.fault('start', 'node2')
    ring.fault('thaw', 'node1')
    ring.wait('up')
    ring.fault('freeze', 'node3', duration='100ms')
    ring.fault('power_cycle', 'all')
    ring.wait('up')
    assert ring.send('node0', 'node2', b'x').outcome == 'delivered'


@BOTH_CLOCKS
def test_interrupts_stops_and_own_programs(make_ring, clock):
    ring = make_ring(plain('own', cpu='attached'), clock=clock)
    cpu = ring.start([sys.executable, '-c', textwrap.dedent('''
        import limb_ring
        with limb_ring.HostPort.connect(role='cpu', node='knee') as port:
            packet = port.next_of(limb_ring.Packet, timeout=60)
            port.wait(port.send(packet.source, packet.data[::-1]))
            port.next_of(limb_ring.Disconnected, timeout=60)''')])
    ring.wait('knee', 'running')
    tool = ring.port('knee')
    tool.observe('sent')
    assert ring.send('body', 'knee', b'abc').outcome == 'delivered'
    assert tool.next_of(limb_ring.Observed).content['outcome'] == 'delivered'
    assert ring.interrupt('body', 'knee', 7).why == 'pin_unwired'
    ring.ctl('down')   # the daemons alone: ring.down() kills programs that are still ending
    assert cpu.wait(60) == 0, open(cpu.log).read() if os.path.exists(cpu.log) else ''


def test_two_rings_of_one_name_meet_nowhere():
    with Ring(plain('same')) as one, Ring(plain('same')) as other:
        one.fault('kill', 'knee')
        assert other.status('knee')['state'] == 'up'
        with pytest.raises(RingError, match='down'):
            one.wait('knee', 'up', timeout=0.1)


def test_nothing_is_left_of_a_ring():
    with Ring(3) as ring:
        folder = ring.environment['XDG_RUNTIME_DIR']
        pids = [row['pid'] for row in ring.status()['nodes']]
    assert not os.path.exists(folder)
    assert all(is_gone(pid) for pid in pids)
    with pytest.raises(RingError, match='is down'):
        ring.status()


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGKILL])
def test_no_daemon_is_left_of_a_program_that_is_killed(number):
    program = subprocess.Popen([sys.executable, '-c', textwrap.dedent("""
        import limb_ring, time
        with limb_ring.Ring(2) as ring:
            print(*(row['pid'] for row in ring.status()['nodes']), flush=True)
            time.sleep(600)
        """)], stdout=subprocess.PIPE, universal_newlines=True)
    pids = [int(pid) for pid in program.stdout.readline().split()]
    assert len(pids) == 2
    program.send_signal(number)
    program.communicate()
    deadline = time.monotonic() + 60
    while not all(is_gone(pid) for pid in pids):
        assert time.monotonic() < deadline, 'daemons are left'
        time.sleep(0.02)


def test_a_ring_goes_down_while_another_thread_waits_at_a_port_of_it():
    ring = Ring(plain('busy')).up()
    pid, port = ring.status('body')['pid'], ring.port('body')
    waits = threading.Thread(target=port.receive, args=(600,), daemon=True)
    waits.start()
    while not in_use(port):
        time.sleep(0.01)
    ring.down()
    assert is_gone(pid)
    waits.join(60)
    assert not waits.is_alive()


def in_use(port):
    try:
        return port.id is None
    except limb_ring.HostPortError:
        return True


def test_a_daemon_that_ends_just_before_it_is_killed_stops_nothing(monkeypatch):
    ring = Ring(plain('late')).up()
    folder = ring.environment['XDG_RUNTIME_DIR']
    ended = subprocess.Popen(['true'])
    ended.wait()
    left = list(ring._launcher.daemons_left())
    monkeypatch.setattr(ring._launcher, 'daemons_left', lambda: [ended.pid] + left)
    ring._launcher.end()
    assert all(is_gone(pid) for pid in left)
    ring.down()
    assert not os.path.exists(folder)


def test_ports_of_single_sends_are_not_kept(make_ring):
    ring = make_ring(plain('single'))
    for _ in range(3):
        assert ring.send('body', 'knee', b'x').outcome == 'delivered'
        ring.interrupt('body', 'knee', 1)
    assert ring._ports == []


def test_nothing_is_left_if_a_variable_is_not_utf_8(monkeypatch):
    monkeypatch.setenv('SOMEBODYS', os.fsdecode(b'\xff'))
    ring = Ring(plain('left')).up()
    pid = ring.status('body')['pid']
    ring._launcher.end()   # as where ringctl cannot be asked any more
    assert is_gone(pid)
    ring.down()


def test_a_ring_that_somebody_else_has_started_goes_on(monkeypatch):
    with Ring(plain('theirs')) as theirs:
        with Ring.attach('theirs', runtime=theirs.environment['XDG_RUNTIME_DIR']) as ring:
            assert ring.send('body', 'knee', b'x').outcome == 'delivered'
        monkeypatch.chdir(theirs.environment['XDG_RUNTIME_DIR'])
        with Ring.attach('theirs', runtime='.') as ring:
            assert ring.send('body', 'knee', b'x').outcome == 'delivered'
            ring.wait('up')   # by ringctl, to which a relative XDG_RUNTIME_DIR is none
        theirs.wait('up')


def test_what_is_wrong_is_said_in_the_words_of_ringctl():
    with pytest.raises(RingError, match="nodes.1..id.*the id of another node"):
        Ring({'ring': 'x', 'nodes': [{'id': 0, 'name': 'a'}, {'id': 0, 'name': 'b'}]}).up()
    with pytest.raises(RingError, match='no file nowhere.yaml'):
        Ring('nowhere.yaml').up()
    for nothing in '', None, 2.5:
        with pytest.raises(RingError, match='needs the YAML file of a ring, a dict of the same, or a number of nodes'):
            Ring(nothing).up()
    with Ring(plain('wrong')) as ring:
        with pytest.raises(RingError, match='no node elbow'):
            ring.send('body', 'elbow', b'x')
        with pytest.raises(RingError, match='exit code 2'):
            ring.fault('melt', 'knee')


def test_nodes_go_by_name_or_id_which_may_be_a_text():
    with Ring(plain('named')) as ring:
        assert {ring.status(node)['name'] for node in ('body', 0, '0')} == {'body'}
        assert {ring.send('0', node, b'x').outcome for node in ('knee', 1, '1')} == {'delivered'}
        for node in ('hip', '\u00b2', None, -1):
            with pytest.raises(RingError, match='no node %s in this ring; it has: 0 .body., 1 .knee.' % node):
                ring.send('0', node, b'x')


def test_files_that_come_with_the_package_are_found():
    assert os.path.basename(find_config('humanoid16.yaml')) == 'humanoid16.yaml'


def test_a_ring_goes_by_its_name_alone_the_users_own_first(monkeypatch, tmp_path):
    monkeypatch.setenv('XDG_CONFIG_HOME', str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert find_config('leg8') == find_config('leg8.yaml')
    with pytest.raises(RingError, match='no file leg9; .*rings that have a name: .*leg8.*Ring.attach') as error:
        find_config('leg9')
    assert 'analyzers' not in str(error.value)
    own = tmp_path / 'limb_ring' / 'leg8.yaml'
    own.parent.mkdir()
    own.write_text(json.dumps(plain('mine')))
    assert find_config('leg8') == str(own)
    with Ring('leg8') as ring:
        assert ring.port('body').ring == 'mine'


@pytest.mark.parametrize('config, home', [('/of/user', '/home/of/user'), ('relative', '/home/of/user'),
                                          (None, '/home/of/user'), ('', ''), (None, None)])
def test_a_name_is_looked_for_where_ringctl_looks_for_it(monkeypatch, tmp_path, config, home):
    for variable, value in ('XDG_CONFIG_HOME', config), ('HOME', home):
        if value is None:
            monkeypatch.delenv(variable, raising=False)
        else:
            monkeypatch.setenv(variable, value)
    monkeypatch.chdir(tmp_path)   # where no file is called leg9
    ringctl = subprocess.run([os.path.join(programs_folder(), 'ringctl'), 'up', 'leg9'], stderr=subprocess.PIPE,
                             universal_newlines=True, check=False).stderr
    its_folders = re.search(r'no ring leg9.yaml in (.*)', ringctl).group(1).split(', ')
    with pytest.raises(RingError) as error:
        find_config('leg9')
    ours = re.search(r'looked for (.*); rings', str(error.value)).group(1).split(', ')
    by_name = [path for path in ours if path.endswith('/leg9.yaml')]
    assert [os.path.realpath(path) for path in by_name] == [os.path.realpath(folder + '/leg9.yaml') for folder in its_folders]


def test_a_time_that_is_invalid_is_refused_with_its_name():
    with pytest.raises(ValueError, match='timeout: 0 s or more is needed, and an end, not inf'):
        Ring(2, timeout=float('inf'))
    ring = Ring.attach('nobodys')
    for wrong, kind in ((float('inf'), ValueError), (float('nan'), ValueError), (-1, ValueError), ('5s', TypeError),
                        (None, TypeError)):
        for call in (lambda: ring.wait('knee', 'up', timeout=wrong), lambda: ring.wait('up', timeout=wrong),
                     lambda: ring.clear_faults(timeout=wrong), lambda: ring.reset('knee', timeout=wrong),
                     lambda: ring.ctl('status', timeout=wrong)):
            with pytest.raises(kind, match='timeout: .* is needed.*, not'):
                call()
    for long in 1e308, 2 ** 64:   # for ringctl to judge
        with pytest.raises(RingError, match='is not a time'):
            ring.reset('knee', timeout=long)
    for wrong, kind in (float('nan'), ValueError), (-1, ValueError), ([1], TypeError):
        with pytest.raises(kind, match='duration: .* is needed.*, not'):
            ring.fault('hang', 'knee', duration=wrong)


def test_the_place_of_a_fault_is_a_text_or_an_id():
    ring = Ring.attach('nobodys')
    for wrong in ['knee'], None, 2.5, True:
        with pytest.raises(TypeError, match="place: a text is needed, such as 'knee' or 'hip:knee'"):
            ring.fault('kill', wrong)


@pytest.mark.ring(plain('marked'))
def test_the_fixture_has_the_ring_of_its_mark(ring):
    with ring.port('body') as port:
        assert port.ring == 'marked'


def test_the_fixture_without_a_mark_says_what_it_needs(pytester):
    pytester.makepyfile('def test_it(ring): pass')
    pytester.runpytest_subprocess('-p', 'no:cacheprovider').stdout.fnmatch_lines(['*needs a mark that says which*'])


def test_the_environment_names_no_other_ring_to_an_own_one(monkeypatch):
    monkeypatch.setenv('LIMB_RING_RING', 'elsewhere')
    monkeypatch.setenv('LIMB_RING_NODE', 'hip')
    with Ring(plain('own')) as ring:
        assert ring.send('body', 'knee', b'x').outcome == 'delivered'
        assert ring.port('knee').ring == 'own'


def test_a_send_from_a_node_that_is_not_there_fails_at_once_with_its_name():
    with Ring(plain('few')) as ring:
        for node in 'elbow', 77, 'all', None:
            with pytest.raises(RingError, match='no node %s in this ring' % node):
                ring.send(node, 'body', b'x', timeout=600)
            with pytest.raises(RingError, match='no node %s in this ring' % node):
                ring.interrupt(node, 'body', 3, timeout=600)


def test_the_time_of_a_send_is_for_connecting_too():
    with Ring(plain('late')) as ring:
        ring.fault('kill', 'knee')
        given = []
        connect = ring._connect
        ring._connect = lambda node, **options: given.append(options['timeout']) or connect(node, **options)
        with pytest.raises(limb_ring.HostPortTimeout, match='is ringd running'):
            ring.send('knee', 'body', b'x', timeout=0.25)
        with pytest.raises(limb_ring.HostPortTimeout, match='is ringd running'):
            ring.interrupt('knee', 'body', 3, timeout=0)
        assert given == [0.25, 0]


def test_times_of_a_fault_are_in_seconds_or_texts():
    with Ring(plain('timed')) as ring:
        ring.fault('delay', 'body:knee', delay=0.0005, jitter='10us', duration=3600)
        listed = ring.ctl('fault', 'list', '--json')
        assert 'delay=500us' in listed and 'for=3600s' in listed, listed
        for number in 1, 0.000001:
            ring.fault('freeze', 'knee', duration=number)
            ring.wait('knee', 'up', timeout=60)


def test_a_fault_waits_for_packets_of_a_node():
    with Ring(plain('waiting')) as ring:
        ring.fault('cut', 'body:knee', after_packets=1000, of='knee')
        assert 'after_packets=1000 of=knee' in ring.ctl('fault', 'list')


def test_programs_that_are_not_there_are_reported():
    with pytest.raises(RingError, match='/nix.*there is no ringctl'):
        Ring(2, programs='/nix').up()
    with Ring(plain('bare')) as ring:
        for command, said in (([], 'a list is needed'), ('echo hello', 'a list is needed'),
                              (['/bin/nix'], '/bin/nix.*No such file'), ([ring.environment['XDG_RUNTIME_DIR']], 'denied')):
            with pytest.raises(RingError, match=said):
                ring.start(command)
        assert ring.start(['true']).wait(60) == 0


def test_the_file_of_a_mark_may_be_a_path_beside_the_test(pytester):
    pytester.makefile('.yaml', beside=json.dumps(plain('beside')))
    pytester.mkdir('elsewhere')
    pytester.makepyfile("""
        import pathlib, pytest
        @pytest.mark.ring(pathlib.Path('beside.yaml'))
        def test_it(ring):
            assert ring.port('body').ring == 'beside'""")
    test_file, = pytester.path.glob('test_*.py')
    os.chdir(str(pytester.path / 'elsewhere'))
    pytester.runpytest_subprocess('-p', 'no:cacheprovider', str(test_file)).assert_outcomes(passed=1)
