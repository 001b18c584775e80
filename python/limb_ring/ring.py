"""A whole ring: started, asked, broken and ended through ringctl, its packets through host ports."""
import json
import math
import numbers
import os
import shutil
import subprocess
import time

from . import _client
from .host_port import HostPort, HostPortError, seconds
from .launcher import Launcher

_TIMES = {'duration', 'after', 'delay', 'jitter', 'every'}   # options of a fault
_LONGEST = 1e6   # s that the system can wait for a program; which of them may be given is for that to say
_PREFIX = os.path.abspath(os.path.join(os.path.dirname(__file__), *['..'] * 4))   # PREFIX/lib/python3/dist-packages/limb_ring


class RingError(RuntimeError):
    """It did not happen; the words are ringctl's."""


class RingTimeout(RingError, TimeoutError):
    """It did not happen in time."""


class _NoNode(RingError):
    """The ring has no such node."""


def programs_folder():
    """Where ringd and ringctl are: LIMB_RING_PROGRAMS, beside this package, or on PATH."""
    found = shutil.which('ringctl')
    beside = os.path.join(_PREFIX, 'lib', 'limb_ring')
    for folder in (os.environ.get('LIMB_RING_PROGRAMS'), beside, found and os.path.dirname(found)):
        if folder and os.access(os.path.join(folder, 'ringctl'), os.X_OK):
            return os.path.realpath(folder)
    raise RingError('ringctl is neither beside this package nor on PATH; set LIMB_RING_PROGRAMS to its folder')


def _nanoseconds(time_s):
    return '%dns' % round(time_s * 1e9)


def _time(what, value):
    """The time itself, where it is one that ringctl can wait for; how long that may be is for ringctl to say."""
    if not 0 <= seconds(what, value) < math.inf:   # nor is it one where it is NaN
        raise ValueError('%s: 0 s or more is needed, and an end, not %r' % (what, value))
    return value


def _place(what, value):
    """A node's name or id, or a line, as a word for ringctl."""
    if isinstance(value, bool) or not isinstance(value, (str, numbers.Integral)):
        raise TypeError("%s: a text is needed, such as 'knee' or 'hip:knee', or a node's id, not %r" % (what, value))
    return str(value)


def _no_node(node, rows):
    names = ', '.join('%d (%s)' % (row['id'], row['name']) if 'name' in row else str(row['id']) for row in rows)
    return _NoNode('no node %s in this ring; it has: %s' % (node, names))


def _users_folder():
    """As ringctl has it; empty where nobody says."""
    config = os.environ.get('XDG_CONFIG_HOME', '')
    if not config.startswith('/'):
        home = os.environ.get('HOME', '')
        config = home and os.path.join(home, '.config')
    return config and os.path.join(config, 'limb_ring')


def _rings_in(folder):
    """Names of the rings whose files are there."""
    try:
        files = os.listdir(folder)
    except OSError:
        return []
    return [file[:-len('.yaml')] for file in files if file.endswith('.yaml') and file != 'analyzers.yaml']


def find_config(name, beside=''):
    """Path of a ring's file: in the folder `beside`, in the working folder, or one that comes with limb_ring. A name alone,
    'leg8', is that of a ring, as `ringctl up` takes it: the user's own, one of /etc/limb_ring, or one that comes with
    limb_ring."""
    name = os.fspath(name)
    ours = os.path.join(_PREFIX, 'share', 'limb_ring', 'config')
    by_name = [folder for folder in (_users_folder(), '/etc/limb_ring', ours) if folder]
    tried = [os.path.join(folder, name) for folder in (beside or '.', '.', ours)]
    if '/' not in name and '.' not in name:
        tried += [os.path.join(folder, name + '.yaml') for folder in by_name]
    for path in tried:
        if os.path.isfile(path):
            return os.path.abspath(path)
    known = sorted({ring for folder in by_name for ring in _rings_in(folder)})
    raise RingError('no file %s; looked for %s; rings that have a name: %s (Ring.attach(NAME): one that runs already)'
                    % (name, ', '.join(dict.fromkeys(tried)), ', '.join(known) or 'none'))


class Ring:
    """`with Ring('leg8.yaml') as ring:` has a ring of its own, in a folder of its own, which meets no other and ends with
    the block, with all that was started in it; its daemons also where this process is killed. Nodes go by name or id,
    times are in seconds, every call has a deadline."""

    def __init__(self, config, clock='machine', pace=None, programs=None, timeout=30.0):
        """
        @param config YAML file or name (see find_config), or a dict of the same; 2 to 255: so many plain nodes
        @param clock 'machine', or 'virtual': the whole ring in one process, as `ringctl up --clock`
        @param pace with 'virtual': how fast its time goes beside real time
        @param timeout until the ring has to be closed, and the CPUs that ringd starts have to run"""
        self._config, self._clock, self._pace, self._timeout = config, clock, pace, _time('timeout', timeout)
        self._programs = programs
        self._launcher, self._ports, self._ids = None, [], {}
        self._attached = None   # (name, runtime) of a ring that somebody else has started
        self._name = None       # of our own

    @classmethod
    def attach(cls, name='', runtime=''):
        """A ring that is running already, such as that of ring.launch; it is left running.
        @param runtime folder in the place of XDG_RUNTIME_DIR"""
        ring = cls(None)
        # `environment` is for programs in other folders, too.
        ring._attached = name, os.path.abspath(runtime) if runtime else ''
        return ring

    # ---- up and down ----------------------------------------------------------------------

    def up(self):
        """@raise RingError with the words of ringctl, such as what is wrong in the file"""
        if self._attached or self._launcher:
            return self
        folder = self._programs or programs_folder()
        if not os.access(os.path.join(folder, 'ringctl'), os.X_OK):
            raise RingError('Ring(programs=%r): there is no ringctl' % (folder,))
        self._launcher = Launcher(folder)
        try:
            self.ctl('up', *self._what(), '--detach', '--timeout', self._timeout,
                     *(self._clock_options() or ('--host', 'all')),
                     timeout=self._timeout + 30)
            self._name, = os.listdir(self._launcher.ring_folder(''))
        except BaseException:
            self._end()
            raise
        return self

    def _what(self):
        if isinstance(self._config, int):
            return '--nodes', self._config
        if isinstance(self._config, dict):
            return self._launcher.write('ring.yaml', json.dumps(self._config)),   # which is YAML too
        if not isinstance(self._config, (str, os.PathLike)) or not os.fspath(self._config):
            raise RingError('Ring(%r): needs the YAML file of a ring, a dict of the same, or a number of nodes' % (self._config,))
        return find_config(self._config),

    def _clock_options(self):
        options = [] if self._clock == 'machine' else ['--clock', self._clock]
        return options if self._pace is None else options + ['--pace', self._pace]

    def down(self):
        """Ends the ring, all that was started in it, and its ports. One that was attached to goes on."""
        for port in self._ports:
            try:
                port.close()
            except HostPortError:
                pass   # another thread waits there, until the ring's end
        self._ports.clear()
        if self._launcher:
            try:
                self.ctl('down')
            except RingError:
                pass   # nobody is left to be asked; what is left of it ends here
            finally:
                self._end()

    def _end(self):
        self._launcher.end()
        self._launcher.remove()
        self._launcher = self._name = None
        self._ids.clear()

    def __enter__(self):
        return self.up()

    def __exit__(self, *_):
        self.down()

    @property
    def environment(self):
        """For programs that shall see this ring: XDG_RUNTIME_DIR."""
        if self._launcher:
            return self._launcher.environment
        return dict(os.environ, XDG_RUNTIME_DIR=self._runtime()) if self._runtime() else dict(os.environ)

    def _runtime(self):
        if self._launcher:
            return self._launcher.runtime
        if not self._attached:
            raise RingError('this ring is down')
        return self._attached[1]

    def start(self, command, name='program'):
        """Starts a program in this ring's environment, such as own firmware; it ends with the ring. A Popen; its output
        is in the file `.log`.
        @param command a list: program and arguments @raise RingError where there is no such program"""
        if not self._launcher:
            raise RingError('programs are started in a ring that is up and our own')
        if isinstance(command, (str, bytes, os.PathLike)) or not command:
            raise RingError("start(%r): a list is needed, such as ['./knee', '--gain', 2]" % (command,))
        try:
            return self._launcher.start(name, [str(word) for word in command])
        except OSError as problem:
            raise RingError('start(%r): %s' % (command, problem.strerror)) from None

    # ---- ringctl --------------------------------------------------------------------------

    def ctl(self, *words, timeout=30.0):
        """`ringctl WORDS`: what it printed. @raise RingError where it ended with another exit code than 0, RingTimeout"""
        environment = self.environment
        folder = self._launcher.programs if self._launcher else programs_folder()
        name = ['--ring', self._attached[0]] if self._attached and self._attached[0] else []
        command = [os.path.join(folder, 'ringctl'), *name, *(str(word) for word in words)]
        _time('timeout', timeout)
        try:
            done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, universal_newlines=True, check=False,
                                  timeout=min(timeout, _LONGEST))
        except subprocess.TimeoutExpired:
            raise RingTimeout('ringctl %s: no answer within %g s' % (' '.join(command[1:]), timeout)) from None
        if done.returncode != 0:
            said = done.stderr.strip() or done.stdout.strip()
            raise RingError('ringctl %s: exit code %d: %s' % (' '.join(command[1:]), done.returncode, said))
        return done.stdout

    def status(self, node=None):
        """What `ringctl status --json --all` says; with a node its row alone: 'state', 'ring_size', 'cpu', 'counters' ...
        @raise RingError where the ring has no such node"""
        status = json.loads(self.ctl('status', '--json', '--all'))
        if node is None:
            return status
        rows = status['nodes']
        for row in rows:
            if node in (row['id'], str(row['id']), row.get('name')):
                return row
        raise _no_node(node, rows)

    def cpu(self, node):
        """'state', 'boots', 'pid' of a node's CPU; the state is a word of `ringctl status`: 'running', 'hung', 'stopped' ..."""
        return self.status(node)['cpu']

    def wait(self, what, state=None, timeout=10.0):
        """As `ringctl wait`: wait('up') until all nodes are up and the CPUs that ringd starts run; wait('knee', 'hung')
        until a node or its CPU is in that state, in the words of `ringctl status`: 'up', 'down', 'running', 'hung' ...
        @raise RingError that says what it is instead"""
        words = [what] if state is None else [what, state]
        self.ctl('wait', *words, '--timeout', timeout, timeout=_time('timeout', timeout) + 10)

    def fault(self, kind, place, /, **options):
        """As `ringctl fault`: fault('cut', 'hip:knee'), fault('hang', 'knee', duration=2), fault('drop', 'hip:knee',
        once_in=10, seed=4), fault('cut', 'hip:knee', after_packets=100, of='hip'). Times are in seconds, or texts such
        as '200us'. Returns when it has taken effect."""
        words = []
        for name, value in options.items():
            if name in _TIMES and not isinstance(value, str):
                value = _nanoseconds(_time(name, value))
            words += ['--' + {'duration': 'for'}.get(name, name.replace('_', '-')), value]
        self.ctl('fault', kind, _place('place', place), *words)

    def clear_faults(self, timeout=30.0):
        """Heals, wakes and starts all; returns when the ring is whole again."""
        self.ctl('fault', 'clear', '--timeout', timeout, timeout=_time('timeout', timeout) + 10)

    def reset(self, node, timeout=10.0):
        """Resets a node's CPU by an interrupt; returns when it has booted again. @raise RingError where it has not"""
        self.ctl('reset', node, '--timeout', timeout, timeout=_time('timeout', timeout) + 10)

    def stop(self):
        """Emergency stop of every node, until resume(). @raise RingError if it did not reach all"""
        self.ctl('stop')

    def resume(self):
        """Ends a stop: the joints obey the next command again."""
        self.ctl('resume')

    # ---- packets --------------------------------------------------------------------------

    def port(self, node, role='tool', **options):
        """A HostPort at a node, closed when the ring goes down; options as HostPort.connect(). On a virtual ring a
        CPU here is not in lockstep unless told `lockstep=True`: what a test does elsewhere would hold the ring up.
        @raise RingError where the ring has no such node, HostPortError"""
        try:
            self._known(str(node))
        except _NoNode:
            raise
        except RingError:
            pass   # no daemon answers (yet): connect() waits for it
        port = self._connect(node, role=role, **options)
        self._ports.append(port)
        return port

    def _connect(self, node, **options):
        options.setdefault('lockstep', False)
        name = self._attached[0] if self._attached else self._name
        return HostPort.connect(ring=name, node=node, runtime=self._runtime(), **options)

    def id_of(self, node):
        """A node's id, by its name or id; 'all': BROADCAST. @raise RingError where no node has that name"""
        node = str(node)
        if node.isascii() and node.isdigit():   # no name begins with a digit
            return int(node)
        if node == 'all':
            return _client.BROADCAST
        return self._known(node)

    def _known(self, node):
        if node not in self._ids:
            rows = self.status()['nodes']
            self._ids = {str(name): row['id'] for row in rows for name in (row['id'], row.get('name', row['id']))}
            if node not in self._ids:
                raise _no_node(node, rows)
        return self._ids[node]

    def send(self, source, to, data, priority=2, channel=None, timeout=10.0):
        """Sends from one node to another, or to 'all': the Result. @param data bytes, or a JointCommand and the like"""
        return self._result(source, timeout, lambda port: port.send(self.id_of(to), data, priority, channel))

    def interrupt(self, source, to, factor, force=False, timeout=10.0):
        """Sends an interrupt packet from one node to another: the Result."""
        return self._result(source, timeout, lambda port: port.interrupt(self.id_of(to), factor, force))

    def _result(self, source, timeout, call):
        """Of a call at a node's port, which is connected to in the same time."""
        deadline = time.monotonic() + seconds('timeout', timeout)
        with self._connect(self._known(str(source)), timeout=timeout) as port:
            token = call(port)
            return port.wait(token, max(0.0, deadline - time.monotonic()))
