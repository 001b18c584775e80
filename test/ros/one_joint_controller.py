#!/usr/bin/python3
"""Holds one joint at an angle, answering each joint_states: one_joint_controller.py TOPIC JOINT ANGLE"""
import sys

import rospy
from sensor_msgs.msg import JointState

topic, joint, angle = sys.argv[1:4]
rospy.init_node(joint + '_controller')
commands = rospy.Publisher(topic, JointState, queue_size=10)


def answer(states):
    command = JointState(name=[joint], position=[float(angle)])
    command.header.stamp = states.header.stamp
    commands.publish(command)


rospy.Subscriber('joint_states', JointState, answer, tcp_nodelay=True)
rospy.spin()
