"""A ring with ROS: a roslaunch with a master of its own, and the ring as its topics show it. For scripts/demo."""
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

from live_ring.sessions import send_signal, session_members

GUARD = 60.0     # s that each step may take; a busy machine is slow
SETUP = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'build', 'devel', 'setup.bash')


class DemoFailed(Exception):
    """What was to be seen was not."""


def enter_build():
    """Runs this script again inside the build's ROS environment, unless it is in one that has limb_ring already."""
    try:
        import limb_ring.msg  # noqa: F401
        return
    except ImportError:
        pass
    script = os.path.realpath(sys.argv[0])
    if os.environ.get('LIMB_RING_DEMO_ENTERED') or not os.path.exists(SETUP):
        sys.exit('%s: the ROS messages of limb_ring are not built; run `make build` first' % os.path.basename(script))
    os.environ['LIMB_RING_DEMO_ENTERED'] = '1'
    # In a function, or catkin's setup.bash would take our arguments for its own, and --help for a question to it.
    os.execvp('bash', ['bash', '-c', 'enter() { . "$0"; }; enter && exec /usr/bin/python3 "$@"', SETUP, script,
                       *sys.argv[1:]])


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def wait_for(condition, what, *watched):
    """Until condition() is true. What is watched has check(), which raises where it has ended by itself."""
    deadline = time.monotonic() + GUARD
    while not condition():
        for each in watched:
            each.check()
        if time.monotonic() > deadline:
            raise DemoFailed('waited %g s in vain for %s' % (GUARD, what))
        time.sleep(0.02)


class Launch:
    """roslaunch with a master of its own, ended with all it started."""

    def __init__(self, port, ring, file='demo.launch', *arguments):
        self.port, self.ring = port, ring
        self.log = tempfile.NamedTemporaryFile('w', prefix='limb_ring_demo_', suffix='.log',
                                               delete=False)
        self.process = subprocess.Popen(
            ['roslaunch', '-p', str(port), 'limb_ring', file, 'ring:=' + ring, *arguments],
            stdout=self.log, stderr=subprocess.STDOUT, start_new_session=True)

    def wait_for_master(self):
        deadline = time.monotonic() + GUARD
        while True:
            self.check()
            try:
                socket.create_connection(('127.0.0.1', self.port), 1).close()
                return
            except OSError:
                if time.monotonic() > deadline:
                    raise DemoFailed('the ROS master did not start; see ' + self.log.name)
                time.sleep(0.05)

    def check(self):
        if self.process.poll() is not None:
            raise DemoFailed('roslaunch ended by itself; its output is in ' + self.log.name)

    def stop(self):
        for sign, wait in ((signal.SIGINT, 30), (signal.SIGTERM, 10), (signal.SIGKILL, 5)):
            if self.process.poll() is not None:
                break
            self.process.send_signal(sign)
            try:
                self.process.wait(wait)
            except subprocess.TimeoutExpired:
                pass
        # Interrupted while it starts, roslaunch leaves processes behind, the master among them.
        for sign in (signal.SIGTERM, signal.SIGKILL):
            deadline = time.monotonic() + 5
            for pid in session_members(self.process.pid):
                send_signal(pid, sign)
            while session_members(self.process.pid) and time.monotonic() < deadline:
                time.sleep(0.05)

    def remove_log(self):
        """It has ended well, and nobody will look for what it said."""
        os.unlink(self.log.name)


class RosRing:
    """What the ROS side of the ring shows."""

    def __init__(self):
        import rospy
        from limb_ring.msg import RingStatus
        from sensor_msgs.msg import JointState
        self._lock = threading.Lock()
        self._status, self._state, self._states, self._commands = None, None, 0, 0
        rospy.init_node('demo', disable_signals=True)
        self._subscribers = [
            rospy.Subscriber('ring_status', RingStatus, self._on_status, tcp_nodelay=True),
            rospy.Subscriber('joint_states', JointState, self._on_state, tcp_nodelay=True),
            rospy.Subscriber('joint_commands', JointState, self._on_command, tcp_nodelay=True)]

    def _on_status(self, status):
        with self._lock:
            self._status = status

    def _on_state(self, state):
        with self._lock:
            self._state, self._states = state, self._states + 1

    def _on_command(self, _):
        with self._lock:
            self._commands += 1

    def status(self):
        with self._lock:
            return self._status

    def joints(self):
        with self._lock:
            return dict(zip(self._state.name, self._state.position)) if self._state else {}

    def counts(self):
        with self._lock:
            return self._states, self._commands

    def positions_until_it_moves(self, joint, *watched):
        """Three positions of it that differ by 0.1 rad."""
        seen = set()

        def moves():
            if joint in self.joints():
                seen.add(round(self.joints()[joint], 1))
            return len(seen) >= 3
        wait_for(moves, joint + ' to move', *watched)
        return seen

    def node(self, name):
        return {node.name: node for node in self.status().nodes}[name]

    def is_up(self):
        status = self.status()
        return (status is not None and status.connected and not status.silent_joints and
                all(node.state == 'up' and node.cpu_state == 'running' for node in status.nodes))
