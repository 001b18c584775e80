#!/usr/bin/python3
"""Own firmware shows up in joint_states and obeys joint_commands: the examples, and the program of docs/reference/host_port.md that
knows nothing of limb_ring but that page."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState

from limb_ring.ring import programs_folder
from ring_testing import Newest, Ring

ADDED_BY_ROSLAUNCH = ['__name:=knee', '__log:=/dev/null']
SOURCE = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')


class OwnFirmware(unittest.TestCase):
    def setUp(self):
        self.ring = Ring().wait_until_up(cpus=False).ring
        self.commands = rospy.Publisher('joint_commands', JointState, queue_size=1)

    def walk(self, *program, goal, added=()):
        """The knee is shown, goes where it is told, and is left out again when the program has ended."""
        cpu = subprocess.Popen([*program, self.ring, 'knee', *added])
        try:
            states = Newest('joint_states', JointState)
            states.wait(lambda state: list(state.name) == ['knee'], 'the knee in joint_states')

            def is_there(state):
                self.commands.publish(JointState(name=['knee'], position=[goal]))
                return abs(state.position[0] - goal) < 1e-6
            states.wait(is_there, 'the knee at %g rad' % goal)
            states.unregister()
        finally:
            cpu.kill()
            cpu.wait()
        Ring().status.wait(lambda status: list(status.silent_joints) == ['knee'], 'the knee silent')

    def test_in_cpp(self):
        self.walk(os.path.join(programs_folder(), 'joint_cpu'), goal=-0.5, added=ADDED_BY_ROSLAUNCH)

    def test_in_python(self):
        self.walk(sys.executable, os.path.join(SOURCE, 'examples', 'joint_cpu.py'), goal=-0.25, added=ADDED_BY_ROSLAUNCH)

    def test_from_the_page_alone(self):
        with open(os.path.join(SOURCE, 'docs', 'reference', 'host_port.md')) as page:
            text, = re.findall(r'^```python\n(.*?)^```', page.read(), re.M | re.S)
        with tempfile.NamedTemporaryFile('w', suffix='.py') as program:
            program.write(text)
            program.flush()
            self.walk(sys.executable, program.name, goal=-0.75)


if __name__ == '__main__':
    rospy.init_node('own_firmware_test')
    rostest.rosrun('limb_ring', 'own_firmware', OwnFirmware)
