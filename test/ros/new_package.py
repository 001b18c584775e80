#!/usr/bin/python3
"""What `ringctl new --package` writes for the robots of others builds outside the tree, against the build or an install,
and passes its own three kinds of test.

usage: new_package.py RINGCTL DEVEL CMAKE_PREFIX_PATH ROBOT.urdf ..."""
import os
import shlex
import subprocess
import sys
import tempfile

GUARD = 280   # s, for each step
TESTS = {'pytest', 'scenario', '_ctest_my_robot_rostest_test_moves.test'}


def run(command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=GUARD,
                          **options)
    assert done.returncode == 0, '%s ended with %d:\n%s' % (command, done.returncode, done.stdout)
    return done.stdout


def code_lines(source):
    """Of firmware, controller and tests: neither empty nor a comment alone."""
    files = [os.path.join(source, folder, name) for folder in ('src', 'scripts', 'test')
             for name in os.listdir(os.path.join(source, folder))]
    lines = [line.strip() for file in files for line in open(file)]
    return sum(bool(line) and not line.startswith(('#', '//')) for line in lines)


def try_package(ringctl, devel, prefix, robot, folder):
    """@return lines of code in it"""
    environment = {key: value for key, value in os.environ.items() if not key.startswith('LIMB_RING')}
    environment.update(PATH=os.path.dirname(ringctl) + ':' + environment['PATH'], PYTHONDONTWRITEBYTECODE='1',
                       ROS_HOME=os.path.join(folder, 'ros'))
    source, build = os.path.join(folder, 'src', 'my_robot'), os.path.join(folder, 'build')
    os.makedirs(os.path.dirname(source))
    said = run([ringctl, 'new', robot, '--package', 'my_robot', '--name', 'mine' + str(os.getpid())],
               cwd=os.path.dirname(source))
    assert 'The ring carries this.' in said, said
    own = os.path.join(folder, 'devel')
    run(['cmake', '-S', source, '-B', build, '-DCMAKE_PREFIX_PATH=%s;%s' % (devel, prefix), '-DCATKIN_DEVEL_PREFIX=' + own,
         '-DPYTHON_EXECUTABLE=' + sys.executable], env=environment)
    run(['cmake', '--build', build], env=environment)
    sourced = '. %s/setup.sh && cd %s && ctest --output-on-failure' % (shlex.quote(own), shlex.quote(build))
    tests = run(['bash', '-c', sourced + ' -N'], env=environment)
    assert all(name in tests for name in TESTS), tests
    run(['bash', '-c', sourced], env=environment)
    return code_lines(source)


def main():
    ringctl, devel, prefix, *robots = sys.argv[1:]
    missing = [robot for robot in robots if not os.path.exists(robot)]
    if missing:
        print('skipped: %s is missing (set LIMB_RING_DATA)' % missing[0])
        return
    for robot in robots:
        with tempfile.TemporaryDirectory(prefix='new_package') as folder:
            lines = try_package(ringctl, devel, prefix, robot, folder)
        print('%s is built and tested; firmware of two nodes, controller and three kinds of test: %d lines, all written by '
              'ringctl new' % (robot, lines))


if __name__ == '__main__':
    main()
