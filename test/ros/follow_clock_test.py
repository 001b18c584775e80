#!/usr/bin/python3
"""A ring on a virtual clock that follows a /clock given by somebody else: here the test, as Gazebo or a bag would."""
import os
import subprocess
import threading
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import Imu, JointState

from limb_ring.msg import Frame, RingEvent, RingStatus
from ring_testing import Newest, Ring, wait_for

START = 1000.0   # s, of the outer clock
STEP = 0.01      # s


def seconds(message):
    return message.header.stamp.to_sec()


class OuterClock:
    """Publishes /clock, in steps, while it runs."""

    def __init__(self, start):
        self.now, self.running, self.ended = start, True, False
        self.lock = threading.Lock()   # of self.now, while it is changed
        self.publisher = rospy.Publisher('/clock', Clock, queue_size=10, tcp_nodelay=True)
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        while not self.ended:
            if self.running:
                self.jump(STEP)
            self.publisher.publish(Clock(rospy.Time.from_sec(self.now)))
            time.sleep(0.005)

    def jump(self, time_s):
        with self.lock:
            self.now += time_s

    def jump_to(self, time_s):
        with self.lock:
            self.now = time_s

    def end(self):
        self.ended = True
        self.thread.join()


class FollowClock(unittest.TestCase):
    def test_goes_as_far_as_the_outer_clock_pauses_with_it_and_survives_a_jump_back(self):
        said = []
        rospy.Subscriber('/rosout', Log, lambda line: said.append(line.msg))
        joints = Newest('joint_states', JointState)
        others = [Newest(topic, kind) for topic, kind in (
            ('sensors/knee_imu', Imu), ('ring_status', RingStatus), ('ring_events', RingEvent), ('ring_frames', Frame),
            ('/diagnostics', DiagnosticArray))]
        wait_for(lambda: any('waits for /clock: nobody publishes it' in line for line in said), 'the word that it waits')
        clock = OuterClock(START)
        self.addCleanup(clock.end)

        joints.wait(lambda states: seconds(states) > START + 2, 'two seconds of the outer clock')
        self.assertLessEqual(seconds(joints.get()), clock.now)
        for newest in others:
            newest.wait(lambda message: START <= seconds(message) <= clock.now, 'stamps of the outer clock')

        clock.running = False   # what is under way comes to its end there
        self.settled(joints, clock)
        self.assertLessEqual(seconds(joints.get()), clock.now)
        clock.running = True
        joints.wait(lambda states: seconds(states) > START + 4, 'the clock to be followed again')

        clock.jump_to(5.0)
        wait_for(lambda: [line for line in said if line.startswith('/clock has jumped back, from 10')], 'a word about the jump')
        joints.wait(lambda states: 6 < seconds(states) <= clock.now, 'stamps of the clock as it is now')
        self.assertEqual(joints.get().name, ['knee'])

        # Further than a ring lives; what follows is followed as if it had not been said.
        ring = Ring()
        ring.wait_until_up()
        boots = ring.node('body').cpu_boots

        def leap_is_refused():   # said anew: queues keep 10, so what stands still for 50 ms loses it
            clock.publisher.publish(Clock(rospy.Time(4294967295)))
            return any('/clock: it has jumped more than 1000000000 s beyond' in line for line in said)
        wait_for(leap_is_refused, 'a word about the leap')
        after = clock.now + 1
        joints.wait(lambda states: after < seconds(states) <= clock.now, 'the clock to be followed again')
        self.assertEqual(len([line for line in said if 'has jumped back' in line]), 1)
        self.assertEqual(ring.node('body').cpu_boots, boots)

    def test_the_clock_of_a_ring_that_is_started_anew_begins_at_the_next_outer_one(self):
        config = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'follow_clock.yaml')
        name = 'anew%d' % os.getpid()
        said = []
        rospy.Subscriber('/rosout', Log, lambda line: said.append(line.msg) if line.name == '/anew/bridge' else None)

        def begun():
            return [line for line in said if "the ring's clock follows /clock; its 0 is" in line]

        def ringctl(*arguments):
            return subprocess.call(['rosrun', 'limb_ring', 'ringctl', '--ring', name, *arguments])
        self.addCleanup(ringctl, 'down')   # where it has not come so far
        clock = OuterClock(20.0)
        self.addCleanup(clock.end)
        bridge = subprocess.Popen(['rosrun', 'limb_ring', 'ring_bridge', '__ns:=/anew', '__name:=bridge',
                                   '_config:=' + config, '_ring:=' + name, '_node:=body', '_clock:=follow'])
        self.addCleanup(bridge.wait)
        self.addCleanup(bridge.terminate)
        for turn in range(2):
            self.assertEqual(ringctl('up', config, '--clock', 'follow', '--detach'), 0)
            wait_for(lambda: len(begun()) > turn, "the ring's clock to begin")
            self.assertEqual(ringctl('down'), 0)

    def test_what_was_allowed_before_a_jump_back_still_runs_and_that_is_reported(self):
        said = []
        rospy.Subscriber('/rosout', Log, lambda line: said.append(line.msg))
        joints = Newest('joint_states', JointState)
        clock = OuterClock(5.0)
        self.addCleanup(clock.end)
        joints.wait(lambda states: 6 < seconds(states) <= clock.now, 'the clock to be followed')
        clock.jump(1e7)
        joints.wait(lambda states: clock.now > 1e7 > seconds(states) > 20, 'the clock to be followed far forward')
        clock.jump_to(5.0)
        wait_for(lambda: [line for line in said if 'Until it has caught up, its stamps are that much earlier than /clock' in line],
                 'the word that the ring is behind')
        joints.wait(lambda states: seconds(states) == 0, 'a stamp that cannot be before 0')

    def settled(self, joints, clock):
        """Nothing new while the bridge goes on to be asked: ten of its statuses are published in the meantime."""
        status = Newest('ring_status', RingStatus)
        wait_for(lambda: clock.now - seconds(joints.get()) < 3 * STEP, 'the last joint states')
        status.wait_for_more(2, 'statuses')
        before = joints.count()
        status.wait_for_more(3, 'statuses')
        self.assertEqual(joints.count(), before, 'time stands')


if __name__ == '__main__':
    rospy.init_node('follow_clock_test')
    rostest.rosrun('limb_ring', 'follow_clock', FollowClock)
