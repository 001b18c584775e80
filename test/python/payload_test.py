"""What is inside packets, from Python."""
import os
import re
import time

import pytest

from limb_ring import Announcement, CommandSet, Fragmenter, JointCommand, JointState, Reassembler, SensorReading

PAGE = os.path.join(os.path.dirname(os.environ['LIMB_RING_TUTORIAL']), '..', 'reference', 'host_port.md')
STAMP = 1700000000000000000


def documented(title):
    with open(PAGE) as page:
        behind = page.read().split('### %s\n' % title)[1]
    return bytes.fromhex(re.search(r'^    (.*)$', behind, re.M).group(1))


def test_a_joint_state_has_the_documented_bytes():
    state = JointState([JointState.Joint(0.5, -1, 2)], sequence=7, stamp_ns=STAMP)
    state.mode.commanded = True
    assert state.encode() == documented('Joint state')
    read = JointState.decode(state.encode())
    assert (read.sequence, read.stamp_ns, read.mode.commanded, read.mode.safe) == (7, STAMP, True, False)
    assert [(joint.position, joint.velocity, joint.effort) for joint in read.joints] == [(0.5, -1, 2)]


def test_a_joint_command_has_the_documented_bytes():
    command = JointCommand([JointCommand.Joint(position=0.5)], valid_for=0.1, resume=True, sequence=7, stamp_ns=STAMP)
    assert command.encode() == documented('Joint command')
    read = JointCommand.decode(command.encode())
    assert (read.joints[0].position, read.joints[0].velocity, read.valid_for_us) == (0.5, None, 100000)


def test_a_command_set_has_the_documented_bytes():
    parts = {1: [JointCommand.Joint(position=0.5)], 2: [JointCommand.Joint(position=-0.25)]}
    commands = CommandSet(parts, valid_for=0.1, sequence=7, stamp_ns=STAMP)
    assert commands.encode() == documented('Command set')
    read = CommandSet.decode(commands.encode())
    assert sorted(read.parts) == [1, 2] and read.to(3) is None
    command = read.to(2)
    assert (command.joints[0].position, command.sequence, command.stamp_ns) == (-0.25, 7, STAMP)
    assert repr(read) == '<CommandSet 7: 2 nodes, valid for 0.1 s>'


def test_a_sensor_reading_has_the_documented_bytes():
    reading = SensorReading('imu', (0, 0, 9.80665), (0, 0, 0), sequence=7, stamp_ns=STAMP)
    assert reading.encode() == documented('Sensor reading')
    assert SensorReading.decode(reading.encode()).linear == [0, 0, 9.80665]
    assert SensorReading.decode(SensorReading('force', (1, 2, 3), (4, 5, 6)).encode()).kind == 'force'


def test_data_without_a_stamp_is_stamped_now():
    before = time.time_ns()
    assert before <= JointState().stamp_ns <= time.time_ns()


@pytest.mark.parametrize('wrong, words', [
    (lambda: JointState.decode(b'\1\1'), 'ends before'),
    (lambda: JointState.decode(JointCommand().encode()), 'another type'),
    (lambda: JointState([JointState.Joint(float('nan'))]).encode(), 'item 0: is not a number'),
    (lambda: JointState([JointState.Joint()] * 42).encode(), 'item 41'),
    (lambda: SensorReading('thermometer', (0, 0, 0), (0, 0, 0)), "'imu' or 'force'"),
    (lambda: JointCommand(valid_for=-1), 'valid_for')])
def test_an_impossible_value_is_a_value_error_that_says_why(wrong, words):
    with pytest.raises(ValueError, match=words):
        wrong()


def test_a_message_goes_through_fragments():
    fragmenter, reassembler = Fragmenter(4), Reassembler()
    announcement = Announcement('chatter', 'std_msgs/String', '992ce8a1687cec8c8bd883ec73ca41d1', 'string data\n')
    message = bytes(range(256)) * 5
    for packet in fragmenter.packets(announcement.encode(), announcement=True):
        assert reassembler.take(3, packet) is None
    pieces = fragmenter.packets(message)
    assert [len(piece) for piece in pieces] == [512, 512, 20 + 1280 - 2 * 492]
    assert [reassembler.take(3, piece) for piece in pieces] == [None, None, (4, message)]
    assert reassembler.announcement(3, 4).datatype == 'std_msgs/String'
    assert reassembler.announcement(3, 5) is None


def test_a_validity_is_rounded_to_microseconds():
    assert [JointCommand(valid_for=seconds).valid_for_us for seconds in (1.001, 0.0000014)] == [1001000, 1]


def test_a_stamp_that_was_given_stays():
    command = JointCommand()
    assert not command.stamp_given
    assert JointCommand.decode(command.encode(5)).stamp_ns == 5
    assert JointCommand.decode(command.encode()).stamp_ns == command.stamp_ns
    command.stamp_ns = 0
    for given in command, JointCommand(stamp_ns=0), JointCommand.decode(command.encode()):
        assert given.stamp_given and JointCommand.decode(given.encode(5)).stamp_ns == 0


def test_they_show_what_they_are():
    state = JointState([JointState.Joint(0.5, -1, 2)], sequence=7)
    state.mode.safe = state.mode.hold = True
    assert repr(state) == '<JointState 7: 1 joint, safe, hold>'
    assert repr(state.joints) == '[<Joint 0.5 rad, -1 rad/s, 2 N m>]'
    command = JointCommand([JointCommand.Joint(velocity=0.5)] * 2, valid_for=0.25, sequence=7)
    assert repr(command) == '<JointCommand 7: 2 joints, valid for 0.25 s>'
    assert repr(command.joints[0]) == '<Joint 0.5 rad/s>'
    assert repr(SensorReading('imu', (0, 0, 0), (0, 0, 0), sensor=1)) == '<SensorReading 0: imu 1>'
