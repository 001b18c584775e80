#!/usr/bin/python3
"""An ordinary bag, played onto a ring: what the ring takes, and nothing that the ring publishes itself."""
import os
import subprocess
import tempfile
import unittest

import rosbag
import rosgraph
import rospkg
import rospy
import rostest
from limb_ring.msg import NodeStatus, RingStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from ring_testing import Newest, wait_for

CONFIG = os.path.join(rospkg.RosPack().get_path('limb_ring'), 'config', 'two_bridges.yaml')


class PlayBag(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix='play_bag_')
        self.addCleanup(folder.cleanup)
        self.bag = os.path.join(folder.name, 'a.bag')
        with rosbag.Bag(self.bag, 'w') as bag:
            for i in range(20):
                time = rospy.Time(100 + i, 0)
                bag.write('/joint_states', JointState(name=['a']), time)
                bag.write('/joint_commands', JointState(name=['b']), time)
                bag.write('/wrench', String('from the bag'), time)

    def play(self, *arguments):
        self.name = '/' + self._testMethodName
        command = ['rosrun', 'limb_ring', 'play_bag', *arguments, '__name:=' + self._testMethodName]
        played = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

        def end():
            played.terminate()
            played.communicate()
        self.addCleanup(end)
        return played

    def played(self):
        """Topics that the player publishes."""
        publishers = rosgraph.Master('/play_bag_test').getSystemState()[0]
        return {topic for topic, nodes in publishers if self.name in nodes} - {'/clock', '/rosout'}

    def test_plays_only_what_the_ring_takes(self):
        commands, wrench = Newest('joint_commands', JointState), Newest('wrench', String)
        self.play('--config', CONFIG, self.bag, '--loop', '--rate', '10')
        self.assertEqual(commands.wait(lambda _: True, 'a command').name, ['b'])
        self.assertEqual(wrench.wait(lambda _: True, 'a wrench').data, 'from the bag')
        self.assertEqual(self.played(), {'/joint_commands', '/wrench'})

    def test_plays_the_commands_of_a_ring_with_several_controllers(self):
        config = self.bag + '.yaml'
        with open(config, 'w') as file:
            file.write('bridge: {lockstep: [arm_commands, leg/commands]}')
        with rosbag.Bag(self.bag, 'w') as bag:
            bag.write('/arm_commands', String('no command'), rospy.Time(1))
        self.assert_refused('/arm_commands is std_msgs/String, which the ring does not take as arm_commands', 2,
                            '--config', config, self.bag)
        with rosbag.Bag(self.bag, 'w') as bag:
            bag.write('/leg/commands', JointState(name=['b']), rospy.Time(1))
        commands = Newest('leg/commands', JointState)
        self.play('--config', config, self.bag, '--loop')
        self.assertEqual(commands.wait(lambda _: True, 'a command').name, ['b'])

    def test_plays_topics_of_ones_choice(self):
        states = Newest('joint_states', JointState)
        self.play(self.bag, '--loop', '--topics', '/joint_states')
        self.assertEqual(states.wait(lambda _: True, 'a state').name, ['a'])
        self.assertEqual(self.played(), {'/joint_states'})

    def test_plays_a_topic_under_the_name_that_the_ring_takes(self):
        commands = Newest('other/joint_commands', JointState)
        os.environ['ROS_NAMESPACE'] = '/other'
        self.addCleanup(os.environ.pop, 'ROS_NAMESPACE')
        self.play(self.bag, '--loop', '/joint_states:=/other/joint_commands')
        self.assertEqual(commands.wait(lambda _: True, 'a command').name, ['a'])

    def test_plays_a_topic_without_a_slash_under_another_name(self):
        commands = Newest('joint_commands', JointState)
        with rosbag.Bag(self.bag, 'w') as bag:
            bag.write('joint_states', JointState(name=['a']), rospy.Time(1))
        self.play(self.bag, '--loop', '--rename', 'joint_states', 'joint_commands')
        self.assertEqual(commands.wait(lambda _: True, 'a command').name, ['a'])

    def test_ends_when_it_has_played_unless_it_is_to_stay(self):
        with rosbag.Bag(self.bag, 'w') as bag:
            bag.write('/joint_commands', JointState(name=['b']), rospy.Time(1))
        played = self.play(self.bag)
        played.communicate(timeout=60)
        self.assertEqual(played.returncode, 0)
        commands = Newest('joint_commands', JointState)
        staying = self.play(self.bag, '--stay', '--delay', '2')
        commands.wait(lambda _: True, 'a command')
        wait_for(lambda: not self.played(), 'the end of the bag')
        self.assertIsNone(staying.poll())

    def test_waits_for_the_ring_if_it_is_told_to(self):
        commands = Newest('joint_commands', JointState)
        ring = rospy.Publisher('ring_status', RingStatus, queue_size=1, latch=True)
        self.addCleanup(ring.unregister)
        ring.publish(RingStatus(nodes=[NodeStatus(name='knee', state='joining')]))
        self.play('--await-ring', self.bag, '--loop')
        wait_for(lambda: ring.get_num_connections() > 0, 'it to wait')
        ring.publish(RingStatus(nodes=[NodeStatus(name='knee', state='up')], silent_joints=['b']))
        self.assertEqual((self.played(), commands.get()), (set(), None))
        ring.publish(RingStatus(nodes=[NodeStatus(name='knee', state='up')]))
        self.assertEqual(commands.wait(lambda _: True, 'a command').name, ['b'])

    def test_a_bag_with_nothing_for_the_ring_is_an_error_that_names_both(self):
        with rosbag.Bag(self.bag, 'w') as bag:
            bag.write('/odom', String('x'), rospy.Time(1))
        ended = self.play(self.bag)
        _, said = ended.communicate(timeout=60)
        self.assertEqual(ended.returncode, 2)
        self.assertIn('nothing that the ring takes (/joint_commands); it has /odom', said)

    def test_what_is_not_text_is_an_error_that_names_the_file(self):
        garbage = self.bag + '.garbage'
        with open(garbage, 'wb') as file:
            file.write(b'\xff\xfe')
        for arguments in ((garbage,), ('--config', garbage, self.bag)):
            _, said = self.play(*arguments).communicate(timeout=60)
            self.assertRegex(said, '^play_bag: %s: ' % garbage)

    def assert_refused(self, words, code, *arguments):
        ended = self.play(*arguments)
        _, said = ended.communicate(timeout=60)
        self.assertIn(words, said)
        self.assertNotIn('Traceback', said)
        self.assertEqual(ended.returncode, code)

    def test_topics_that_are_not_in_the_bag_are_an_error(self):
        self.assert_refused('has no topic /odom; it has /joint_commands, /joint_states, /wrench', 2,
                            self.bag, '--topics', '/wrench', '/odom', '--rate', '2')

    def test_commands_of_another_type_are_an_error(self):
        self.assert_refused('/wrench is std_msgs/String, which the ring does not take as joint_commands', 2,
                            self.bag, '--rename', '/wrench', '/joint_commands')

    def test_a_renaming_without_a_name_is_an_error(self):
        self.assert_refused("'/wrench:=' lacks a name", 2, self.bag, '--rename', '/wrench', '')
        self.assert_refused("':=x' lacks a name", 2, self.bag, ':=x')

    def test_an_input_that_is_no_name_is_an_error(self):
        config = self.bag + '.yaml'
        for wrong in ('5', '""', 'null'):
            with open(config, 'w') as file:
                file.write('bridge: {topics: [{input: %s}]}' % wrong)
            self.assert_refused(config + ': an input of bridge.topics is no name', 2, '--config', config, self.bag)

    def test_a_bag_whose_recorder_was_killed_is_an_error_that_says_what_mends_it(self):
        with open(self.bag, 'r+b') as file:
            file.truncate(os.path.getsize(self.bag) // 2)
        self.assert_refused('rosbag reindex', 1, self.bag)


if __name__ == '__main__':
    rospy.init_node('play_bag_test')
    rostest.rosrun('limb_ring', 'play_bag', PlayBag)
