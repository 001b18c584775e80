#!/usr/bin/python3
"""Wrong arguments of ring.launch end the launch with what is wrong; 255 nodes fit."""
import os
import subprocess
import unittest

import rospkg
import rostest

HERE = rospkg.RosPack().get_path('limb_ring')
HUMANOID = os.path.join(HERE, 'config', 'humanoid16.yaml')


def roslaunch(*arguments):
    """Output and exit of a launch that must end by itself."""
    done = subprocess.run(['roslaunch', 'limb_ring', 'ring.launch', *arguments], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100)
    return done.stdout


def launched_nodes(*arguments):
    return subprocess.run(['roslaunch', '--nodes', 'limb_ring', 'ring.launch', *arguments],
                          text=True, check=True, stdout=subprocess.PIPE,
                          timeout=100).stdout.split()


class LaunchArguments(unittest.TestCase):
    def test_another_number_of_nodes_than_the_file_has_is_an_error_naming_both(self):
        output = roslaunch('config:=' + HUMANOID, 'nodes:=5', 'ring:=mismatch%d' % os.getpid())
        self.assertIn('nodes:=5', output)
        self.assertIn('has 16 nodes; give nodes:=16', output)

    def test_a_file_without_a_number_of_nodes_says_which_to_give(self):
        output = roslaunch('config:=' + HUMANOID, 'bridge:=false')
        self.assertIn('give nodes:=16', output)

    def test_a_transport_nobody_knows_is_an_error_naming_the_choice(self):
        output = roslaunch('nodes:=2', 'transport:=pigeon', 'ring:=pigeon%d' % os.getpid())
        self.assertIn('pigeon', output)
        self.assertIn('udp', output)

    def test_every_node_is_a_process_of_its_own_up_to_the_largest_ring(self):
        names = launched_nodes('nodes:=255')
        self.assertEqual({'/ringd_%d' % i for i in range(255)} | {'/ring_check'}, set(names))
        self.assertEqual(len(names), 256)

    def test_a_bag_is_played_where_one_is_given(self):
        self.assertIn('/play', launched_nodes('bag:=any.bag'))
        self.assertNotIn('/play', launched_nodes())

    def test_a_view_is_shown_where_one_is_asked_for(self):
        self.assertTrue({'/rviz', '/ring_view', '/robot_state_publisher'} <= set(launched_nodes('view:=true')))
        self.assertFalse({'/rviz', '/ring_view'} & set(launched_nodes()))

    def test_without_arguments_it_is_the_humanoid_with_its_bridge(self):
        names = launched_nodes()
        self.assertIn('/ring_bridge', names)
        self.assertEqual(sum(name.startswith('/ringd_') for name in names), 16)


if __name__ == '__main__':
    rostest.rosrun('limb_ring', 'launch_arguments', LaunchArguments)
