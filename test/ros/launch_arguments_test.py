#!/usr/bin/python3
"""Wrong arguments of ring.launch end the launch with what is wrong."""
import os
import random
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

import rosgraph
import rospkg
import rostest

from ring_testing import wait_for

HERE = rospkg.RosPack().get_path('limb_ring')
HUMANOID = os.path.join(HERE, 'config', 'humanoid16.yaml')
TWO_BRIDGES = os.path.join(HERE, 'config', 'two_bridges.yaml')


def roslaunch(*arguments, file='ring.launch', **options):
    """Output of a launch that must end by itself."""
    done = subprocess.run(['roslaunch', 'limb_ring', file, *arguments], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100, **options)
    return done.stdout


def launched_nodes(*arguments):
    return subprocess.run(['roslaunch', '--nodes', 'limb_ring', 'ring.launch', *arguments],
                          text=True, check=True, stdout=subprocess.PIPE,
                          timeout=100).stdout.split()


def own_ring():
    """A name that no other test's ring has."""
    return 'args%d' % random.randrange(10 ** 9)


class Launch:
    """A launch that goes on until it is told to end."""

    def __init__(self, *arguments, **options):
        self.output = tempfile.TemporaryFile('w+')
        self.process = subprocess.Popen(['roslaunch', 'limb_ring', 'ring.launch', *arguments], text=True,
                                        stdout=self.output, stderr=subprocess.STDOUT, **options)

    def said(self):
        return os.pread(self.output.fileno(), 10 ** 6, 0).decode()

    def wait_for(self, text):
        def is_said():
            if text in self.said():
                return True
            if self.process.poll() is not None:
                raise AssertionError('the launch has ended: ' + self.said())
        wait_for(is_said, text)

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(60)


class LaunchArguments(unittest.TestCase):
    def launch(self, *arguments, **options):
        launch = Launch(*arguments, **options)
        self.addCleanup(launch.end)
        return launch

    def test_another_number_of_nodes_than_the_file_has_is_an_error_naming_both(self):
        output = roslaunch('config:=' + HUMANOID, 'nodes:=5', 'ring:=' + own_ring())
        self.assertIn('--nodes is 5, but ' + HUMANOID + ' has 16 nodes', output)

    def test_a_transport_nobody_knows_is_an_error_naming_the_choice(self):
        output = roslaunch('nodes:=2', 'transport:=pigeon', 'ring:=' + own_ring())
        self.assertIn('pigeon', output)
        self.assertIn('udp', output)

    def test_a_bad_name_of_the_ring_is_an_error_that_names_it(self):
        output = roslaunch('nodes:=2', 'ring:=two/words')
        self.assertIn("'two/words'", output)

    def test_a_ring_that_runs_already_is_an_error_and_goes_on(self):
        ring = own_ring()
        first = self.launch('nodes:=2', 'ring:=' + ring)
        first.wait_for('is closed: 2 nodes up')
        self.assertIn('is running already', roslaunch('nodes:=2', 'ring:=' + ring))
        self.assertIsNone(first.process.poll())

    def test_a_file_that_is_not_there_is_an_error_naming_it_in_full(self):
        output = roslaunch('config:=no/such.yaml', 'ring:=' + own_ring(), env=dict(os.environ, PWD='/tmp'), cwd='/tmp')
        self.assertIn('/tmp/no/such.yaml: there is no such file', output)

    def test_a_file_may_be_named_from_the_folder_of_roslaunch(self):
        launch = self.launch('config:=config/plain4.yaml', 'ring:=' + own_ring(), cwd=HERE,
                             env=dict(os.environ, PWD=HERE))
        launch.wait_for('is closed: 4 nodes up')

    def test_names_of_files_may_have_spaces_and_quotes(self):
        folder = tempfile.mkdtemp(prefix='ada\'s "robot" \\ é ')
        self.addCleanup(shutil.rmtree, folder)
        config, bag = os.path.join(folder, 'my "ring".yaml'), os.path.join(folder, "no 'such.bag")
        shutil.copy(os.path.join(HERE, 'config', 'plain4.yaml'), config)
        launch = self.launch('config:=' + config, 'bridge:=false', 'ring:=' + own_ring())
        launch.wait_for('is closed: 4 nodes up')
        self.assertIn('play_bag: %s: No such file or directory' % bag,
                      roslaunch('nodes:=2', 'ring:=' + own_ring(), 'bag:=' + bag))

    def test_the_controller_of_the_demonstration_says_what_it_is_without_a_master(self):
        controller = os.path.join(HERE, 'examples', 'walk_controller.py')
        nobody = dict(os.environ, ROS_MASTER_URI='http://localhost:1')
        for words, code, said in ((['--help'], 0, '~step'), (['--steps'], 2, 'unrecognized arguments: --steps')):
            done = subprocess.run([controller, *words], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  timeout=100, env=nobody)
            self.assertEqual(done.returncode, code, done.stdout)
            self.assertIn(said, done.stdout)

    def test_what_keeps_the_bridge_from_starting_is_reported_and_ends_the_launch(self):
        for argument, said in (('bridge_node:=nobody', "no node 'nobody'"),
                               ('bridge_node:=neck', "node 'neck' has 'cpu: none'"),
                               ('rate:=-3', 'it must be 0 (as configured) or 0.01 to 1000 Hz'),
                               ('frames:={kinds: [datta]}', 'parameter ~frames/kinds: datta; it must be data')):
            with self.subTest(argument):
                output = roslaunch('config:=' + TWO_BRIDGES, 'ring:=' + own_ring(), argument)
                self.assertIn(said, output)

    def test_a_wrong_value_leaves_no_master_behind(self):
        with socket.socket() as free:
            free.bind(('localhost', 0))
            uri = 'http://localhost:%d' % free.getsockname()[1]
        output = roslaunch('clock:=virtual', 'pace:=-1', 'ring:=' + own_ring(), env=dict(os.environ, ROS_MASTER_URI=uri))
        self.assertIn('--pace', output)
        master = rosgraph.Master('/test', uri)
        if master.is_online():
            os.kill(master.getPid(), signal.SIGTERM)
            self.fail('the master is still there: ' + output)

    def test_a_pace_or_an_end_without_a_clock_of_its_own_is_an_error(self):
        for argument, option in (('pace:=2', '--pace'), ('lasts:=3', '--for')):
            with self.subTest(argument):
                self.assertIn(option + ' requires --clock', roslaunch('nodes:=2', 'ring:=' + own_ring(), argument))

    def test_what_keeps_the_walk_from_starting_is_reported_and_ends_the_launch(self):
        self.assertIn('it must be 0.8 to 10 s', roslaunch('ring:=' + own_ring(), 'step:=99', file='demo.launch'))

    def test_what_keeps_the_view_from_starting_is_reported(self):
        ended = subprocess.run(['rosrun', 'limb_ring', 'ring_view', '_config:=no_such.yaml'], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
        self.assertIn('no_such.yaml: there is no such file', ended.stdout)
        self.assertEqual(ended.returncode, 2)

    def test_a_wrong_parameter_is_forgotten_with_its_launch(self):
        wrong = roslaunch('config:=' + TWO_BRIDGES, 'ring:=' + own_ring(), 'frames:={kinds: [datta]}')
        self.assertIn('parameter ~frames/kinds', wrong)
        right = self.launch('config:=' + TWO_BRIDGES, 'ring:=' + own_ring())
        right.wait_for('is closed')
        # The last thing that a bridge offers, once all its parameters were taken.
        wait_for(lambda: '/reset_node' in [name for name, _ in rosgraph.Master('/test').getSystemState()[2]],
                 'the bridge')

    def test_every_node_has_help(self):
        for program in ('ringctl', 'ringd', 'ring_bridge', 'ring_view', 'walk', 'scenario_server', 'play_bag'):
            with self.subTest(program):
                ended = subprocess.run(['rosrun', 'limb_ring', program, '--help'], text=True,
                                       stdout=subprocess.PIPE, timeout=60)
                self.assertEqual(ended.returncode, 0)
                self.assertIn(program, ended.stdout)
                with open('/dev/full', 'w') as full:
                    ended = subprocess.run(['rosrun', 'limb_ring', program, '--help'], stdout=full, timeout=60)
                self.assertNotEqual(ended.returncode, 0, 'it could not be printed')

    def test_the_help_of_the_bridge_names_its_parameters(self):
        with open(os.path.join(HERE, 'launch', 'bridge.launch')) as file:
            parameters = re.findall(r'param (?:name|param)="(\w+)"', file.read())
        said = subprocess.run(['rosrun', 'limb_ring', 'ring_bridge', '--help'], text=True, stdout=subprocess.PIPE,
                              timeout=60).stdout
        for parameter in parameters:
            self.assertIn('~' + parameter, said)

    def test_the_bridge_gets_the_same_arguments_on_any_host(self):
        def passed_on(file):
            launch = xml.etree.ElementTree.parse(os.path.join(HERE, 'launch', file))
            include, = [each for each in launch.iter('include') if each.get('file').endswith('/bridge.launch')]
            return {argument.get('name') for argument in include.iter('arg')}
        # A ring on a clock of its own is on one host.
        self.assertEqual(passed_on('host.launch') - {'machine'}, passed_on('ring.launch') - {'clock'})

    def test_roslaunch_prints_what_an_argument_is_without_gaps(self):
        folder = os.path.join(HERE, 'launch')
        for file in os.listdir(folder):
            for argument in xml.etree.ElementTree.parse(os.path.join(folder, file)).iter('arg'):
                self.assertNotIn('  ', argument.get('doc', ''), file)  # --ros-args keeps the indentation of a second line

    def test_the_virtual_demo_has_help_and_says_nothing_else(self):
        ended = subprocess.run([os.path.join(HERE, 'scripts', 'virtual_demo'), '--help'], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
        self.assertEqual((ended.returncode, ended.stderr), (0, ''))
        self.assertIn('usage: virtual_demo', ended.stdout)

    def test_a_bag_is_played_if_one_is_given(self):
        self.assertIn('/play', launched_nodes('bag:=any.bag'))
        self.assertNotIn('/play', launched_nodes())

    def test_a_view_is_shown_if_one_is_asked_for(self):
        self.assertTrue({'/rviz', '/ring_view', '/robot_state_publisher'} <= set(launched_nodes('view:=true')))
        self.assertFalse({'/rviz', '/ring_view'} & set(launched_nodes()))

    def test_what_is_neither_true_nor_false_is_an_error(self):
        for argument in ('view:=foo', 'bridge:=foo'):
            with self.subTest(argument):
                self.assertIn("foo is not a 'bool' type", roslaunch('--nodes', argument))

    def test_a_description_that_cannot_be_read_is_an_error_naming_it(self):
        output = roslaunch('--nodes', 'view:=true', 'description:=nofile')
        self.assertIn('nofile: No such file or directory', output)
        self.assertNotIn('Traceback', output)

    def test_the_name_of_a_description_may_have_quotes(self):
        folder = tempfile.mkdtemp(prefix='ada\'s "robot" ')
        self.addCleanup(shutil.rmtree, folder)
        description = os.path.join(folder, "ada's robot.urdf")
        shutil.copy(os.path.join(HERE, 'urdf', 'humanoid16.urdf'), description)
        self.assertIn('/robot_state_publisher', launched_nodes('view:=true', 'description:=' + description))

    def test_without_arguments_it_is_the_humanoid_with_its_bridge(self):
        self.assertEqual(set(launched_nodes()), {'/ring', '/ring_bridge'})

    def test_plain_nodes_have_no_bridge(self):
        self.assertEqual(set(launched_nodes('nodes:=255')), {'/ring'})


if __name__ == '__main__':
    rostest.rosrun('limb_ring', 'launch_arguments', LaunchArguments)
