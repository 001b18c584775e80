#!/usr/bin/python3
"""A controller in lockstep with a virtual ring: lets the humanoid of config/humanoid16.yaml walk in place.

Answers every joint_states with joint_commands of the same stamp, which is what the ring's time waits for
(`bridge: {lockstep: true}`). It takes its time from these stamps alone, so it does the same every time, at any pace; on a
live ring it works as well. Usually started by virtual_demo.launch. Parameters: ~step: s for a left and a right step
(1.6); ~report: s between two lines that say how it walks (10; 0: none)
"""
import argparse
import math

import rospy
from sensor_msgs.msg import JointState

# The gait of the program `walk` made simpler, so that one can read it here: the arms swing at the shoulders alone and
# with the sway, the torso does not turn, and the step grows evenly. Of each joint, rad: lifted with the left leg, with
# the right leg, swaying over the standing leg. Signs are iCub's.
SHARES = {
    'l_hip_pitch': (0.25, 0, 0), 'l_knee': (-0.50, 0, 0), 'l_ankle_pitch': (-0.25, 0, 0),
    'r_hip_pitch': (0, 0.25, 0), 'r_knee': (0, -0.50, 0), 'r_ankle_pitch': (0, -0.25, 0),
    'l_hip_roll': (0, 0, -0.06), 'r_hip_roll': (0, 0, 0.06), 'l_ankle_roll': (0, 0, 0.06), 'r_ankle_roll': (0, 0, -0.06),
    'torso_roll': (0, 0, 0.04), 'l_shoulder_pitch': (0, 0, 0.20), 'r_shoulder_pitch': (0, 0, -0.20)}
GROWS = 2.0   # s from standing to the full step


class WalkController:
    def __init__(self, step, report):
        self.step, self.report = step, report
        self.standing = {}   # rad, of each joint when it was heard first
        self.began = self.reported = None   # s of the ring's clock
        self.range = (math.inf, -math.inf)  # of l_knee since the last report
        self.commands = rospy.Publisher('joint_commands', JointState, queue_size=10)
        self.states = rospy.Subscriber('joint_states', JointState, self.answer, tcp_nodelay=True)

    def answer(self, states):
        now = states.header.stamp.to_sec()
        if self.began is None:
            self.began = self.reported = now
        for name, position in zip(states.name, states.position):
            self.standing.setdefault(name, position)
        command = JointState(name=states.name, position=[self.goal(name, now - self.began) for name in states.name])
        command.header.stamp = states.header.stamp
        self.commands.publish(command)
        self.tell(now, states)

    def goal(self, joint, time):
        left, right, sway = SHARES.get(joint, (0, 0, 0))
        sine = math.sin(2 * math.pi * time / self.step)
        lifted = left * max(sine, 0) ** 2 + right * max(-sine, 0) ** 2   # the foot leaves and meets the ground at rest
        return self.standing[joint] + min(time / GROWS, 1) * (lifted + sway * sine)

    def tell(self, now, states):
        knee = dict(zip(states.name, states.position)).get('l_knee')
        if knee is not None:
            self.range = min(self.range[0], knee), max(self.range[1], knee)
        if not self.report or now < self.reported + self.report:
            return
        self.reported = now
        moved = 'l_knee from %.2f to %.2f rad' % self.range if self.range[0] <= self.range[1] else 'l_knee is silent'
        rospy.loginfo('walking, %.2f s: %d joints heard, %s', now, len(states.name), moved)
        self.range = (math.inf, -math.inf)


if __name__ == '__main__':
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args(
        rospy.myargv()[1:])   # first: init_node() waits for a master
    rospy.init_node('walk_controller')
    controller = WalkController(rospy.get_param('~step', 1.6), rospy.get_param('~report', 10.0))
    rospy.spin()
