#!/usr/bin/python3
"""A ROS master that dies and is started anew: the ring goes on, and a bridge that is reset is known to the new one."""
import os
import random
import signal
import socket
import subprocess
import tempfile
import unittest

import rosgraph
import rospkg
import rostest

from ring_testing import wait_for

CONFIG = os.path.join(rospkg.RosPack().get_path('limb_ring'), 'config', 'two_bridges.yaml')


class NewMaster(unittest.TestCase):
    def setUp(self):
        with socket.socket() as free:
            free.bind(('localhost', 0))
            self.port = free.getsockname()[1]
        self.environment = dict(os.environ, ROS_MASTER_URI='http://localhost:%d' % self.port)
        self.master = rosgraph.Master('/test', self.environment['ROS_MASTER_URI'])
        self.ring = 'new_master%d' % random.randrange(10 ** 9)

    def start(self, *command):
        output = tempfile.TemporaryFile('w+')
        process = subprocess.Popen(command, env=self.environment, stdout=output, stderr=subprocess.STDOUT)
        process.said = lambda: os.pread(output.fileno(), 10 ** 6, 0).decode()
        self.addCleanup(output.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.send_signal, signal.SIGINT)
        return process

    def start_master(self):
        master = self.start('rosmaster', '--core', '-p', str(self.port))
        wait_for(self.master.is_online, 'the master')
        return master

    def bridge_is_known(self):
        published = self.master.getSystemState()[0]
        return any(topic.endswith('/ring_status') and nodes for topic, nodes in published)

    def test_a_bridge_that_is_reset_is_known_to_a_new_master_as_it_was_to_the_one_before(self):
        master = self.start_master()
        launch = self.start('roslaunch', 'limb_ring', 'ring.launch', 'config:=' + CONFIG, 'ring:=' + self.ring,
                            'bridge_node:=head', 'rate:=7')
        wait_for(lambda: 'is closed: 4 nodes up' in launch.said(), 'the ring')
        wait_for(self.bridge_is_known, 'the bridge')
        master.kill()
        master.wait()
        self.start_master()
        self.assertFalse(self.bridge_is_known())
        reset = subprocess.run(['rosrun', 'limb_ring', 'ringctl', '--ring', self.ring, 'reset', 'head', '--timeout', '60'],
                               universal_newlines=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100)
        self.assertEqual(reset.returncode, 0, reset.stdout + launch.said())
        wait_for(self.bridge_is_known, 'the new master to know it')
        self.assertEqual(self.master.getParam('/ring_bridge/node'), 'head')
        self.assertEqual(self.master.getParam('/ring_bridge/rate'), 7)
        self.assertIn('they have been set again', launch.said())
        self.assertIsNone(launch.poll())


if __name__ == '__main__':
    rostest.rosrun('limb_ring', 'new_master', NewMaster)
