"""`ringctl new` and `ringctl check`: from the URDF of a robot of others to joints that move, by the file alone."""
import os
import subprocess
import sys

import ring_process
import yaml
from ring_process import GUARD, RingTest
from limb_ring import BROADCAST, CommandSet, JointCommand, JointState, Packet

ROBOTS = os.path.join(os.environ.get('LIMB_RING_DATA', ''), 'robots')
TABLE = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts', 'robots_table')
# Arms, quadrupeds, humanoids, one with a lift, wheels and a gripper: nodes of their rings, and joints with a motor.
EXPECTED = {'anymal': (5, 12), 'bravo7_gripper': (5, 8), 'go2': (5, 12), 'icub': (13, 32), 'kinova': (3, 6),
            'panda': (4, 8), 'solo12': (5, 12), 'talos_full_v2': (13, 32), 'tiago': (25, 48), 'ur5_robot': (3, 6)}


class NewRing(RingTest):
    def new(self, robot, *options, code=0):
        urdf = os.path.join(ROBOTS, robot)
        self.file = os.path.join(self.folder, robot.split('.')[0] + '.yaml')
        done = self.ctl('new', urdf, '-o', self.file, '--name', self.ring, *options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def joints(self):
        """{id of a node: its joints}, of those that have some."""
        with open(self.file) as file:
            nodes = yaml.safe_load(file)['nodes']
        return {node['id']: [joint['name'] for joint in node['joints']] for node in nodes if 'joints' in node}

    def test_ten_robots_of_others_move_all_their_joints(self):
        for robot, (nodes, joints) in EXPECTED.items():
            with self.subTest(robot):
                said = self.new(robot + '.urdf').stdout
                checked = self.ctl('check', self.file)
                self.assertEqual(checked.returncode, 0, checked.stderr)
                self.assertIn('%d joints' % joints, checked.stdout)
                self.assertIn('%d nodes in this order' % nodes, said)
                self.assertIn('The ring carries this.', said)
                self.moves_all(self.joints())

    def moves_all(self, joints):
        """A joint that cannot move, since its limits are one value, is left out: its firmware holds it there."""
        ring = self.start('ring', [ring_process.program('ringctl'), 'up', self.file, '--clock', 'virtual', '--pace', 'max'])
        self.wait_closed(range(len(joints) + 1))
        body = self.port(0, role='cpu', lockstep=True)
        first, still, sequence = {}, {(node, i) for node in joints for i in range(len(joints[node]))}, 0
        while still:
            sequence += 1
            self.assertLess(sequence, 2000, 'these do not move: %s' % [joints[node][i] for node, i in still])
            for node, names in joints.items():
                goal = 0.3 if sequence % 200 < 100 else -0.3
                start = first.get(node, [0.0] * len(names))
                parts = {node: [JointCommand.Joint(position=at + goal) for at in start]}
                body.send(BROADCAST, CommandSet(parts, valid_for=0.2, sequence=sequence & 0xFFFF))
            for _ in range(len(joints)):
                state = body.find(lambda message: isinstance(message, Packet)
                                  and isinstance(message.payload, JointState), timeout=GUARD)
                positions = [joint.position for joint in state.payload.joints]
                start = first.setdefault(state.source, positions)
                still -= {(state.source, i) for i, at in enumerate(positions) if abs(at - start[i]) > 1e-3}
        body.close()
        self.assertEqual(self.ctl('down').returncode, 0)
        self.wait_exit(ring)

    def test_what_is_no_urdf_is_named_for_what_it_is(self):
        self.assertIn('is an SDF', self.new('cassie.sdf', code=2).stderr)
        xacro = os.path.join(self.folder, 'robot.urdf.xacro')
        with open(xacro, 'w') as file:
            file.write('<?xml version="1.0"?>\n<robot name="r"><xacro:macro name="leg"/></robot>\n')
        checked = self.ctl('check', os.path.join(ROBOTS, 'cassie.sdf'), xacro)
        self.assertEqual(checked.returncode, 2, checked.stdout)
        self.assertIn('is an SDF', checked.stderr)
        self.assertIn('is a xacro file', checked.stderr)

    def test_the_table_of_robots_says_how_many_load_and_how_many_did(self):
        table = subprocess.run([sys.executable, TABLE, ROBOTS, '--programs', os.path.dirname(ring_process.program('ringctl'))],
                               stdout=subprocess.PIPE, universal_newlines=True, timeout=GUARD)
        self.assertEqual(table.returncode, 0, table.stdout)
        self.assertIn('10 URDFs with joints that move: 3 load with the rules of 0.1.0, 10 today', table.stdout)
        self.assertIn('not counted: cassie.sdf', table.stdout)

    def test_writes_over_nothing_that_is_there_unless_forced(self):
        self.new('go2.urdf')
        self.assertIn('already exists', self.new('go2.urdf', code=2).stderr)
        one_a_chain = self.new('go2.urdf', '--force', '--per-chain', '--rate', 500).stdout
        self.assertIn('FL_hip: FL_hip_joint, FL_thigh_joint, FL_calf_joint\n', one_a_chain)
        with open(self.file) as file:
            self.assertIn('firmware: {state_rate: 500}', file.read())
        self.assertIn('13 nodes', self.new('go2.urdf', '--force', '--per-node', 1).stdout)

    def test_says_what_it_assumes_and_what_follows(self):
        panda = self.new('panda.urdf')
        self.assertIn('panda_finger_joint2 follows panda_finger_joint1, without a motor', panda.stdout)
        unknown = self.new('bravo7_gripper.urdf')
        self.assertRegex(unknown.stderr, 'warning: .*bravo7_gripper.urdf has .*no velocity .* for joint1, ')

    def test_checks_scenarios_and_urdfs_too_and_says_all_that_is_wrong(self):
        scenario = self.write('s.yaml', 'scenario: s\nnodes: 3\nsteps: []\n')
        good = self.ctl('check', scenario, os.path.join(ROBOTS, 'talos_full_v2.urdf'))
        self.assertEqual(good.returncode, 0, good.stderr)
        self.assertIn("scenario 's', 0 steps, on ring plain, 3 nodes", good.stdout)
        self.assertIn('32 joints with a motor, 12 that follow them', good.stdout)
        bad = self.ctl('check', self.write('b.yaml', 'ring: r\ncolor: 1\nnodes: [{id: 0}, {id: 0, name: 7}]\n'), scenario)
        self.assertEqual(bad.returncode, 2)
        self.assertEqual(len(bad.stderr.splitlines()), 2, bad.stderr)
        self.assertIn('s.yaml is right', bad.stdout)


if __name__ == '__main__':
    if not os.path.exists(ROBOTS):
        print('skipped: %s is missing (set LIMB_RING_DATA)' % ROBOTS)
        sys.exit(0)
    ring_process.main()
