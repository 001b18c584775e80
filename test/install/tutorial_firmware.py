"""The tutorial's chapter about firmware: its files are those of examples/, its commands run, its firmware answers.

usage: tutorial_firmware.py SOURCE PROGRAMS FOLDER     (the environment says how limb_ring is found)
"""
import json
import os
import re
import shutil
import subprocess
import sys

PAGE = 'docs/tutorial/4_firmware.md'
PRINTED = {'ring.yaml', 'CMakeLists.txt', 'echo_cpu.cpp'}
BESIDE = ['joint_cpu.cpp', 'echo_cpu.py', 'joint_cpu.py']   # what the chapter links to
GUARD = 240  # s


def blocks(page):
    with open(page) as file:
        return re.findall(r'^```(\w+)\n(.*?)^```', file.read(), re.M | re.S)


def write_files(found, examples, folder):
    """Every block but the commands names its file in the comment at its beginning."""
    printed = {}
    for _, block in found:
        name = re.match(r'(?:#|//) ([\w.]+):', block)
        if name:
            printed[name.group(1)] = block
    assert set(printed) == PRINTED, set(printed)
    for name, block in printed.items():
        with open(os.path.join(examples, name)) as file:
            assert file.read() == block, 'the page and examples/%s differ' % name
        with open(os.path.join(folder, name), 'w') as file:
            file.write(block)
    for name in BESIDE:
        shutil.copy(os.path.join(examples, name), folder)


def main():
    source, programs, folder = sys.argv[1:]
    os.mkdir(folder)
    found = blocks(os.path.join(source, PAGE))
    write_files(found, os.path.join(source, 'examples'), folder)
    commands, = (block for language, block in found if language == 'sh')
    run(commands, programs, folder)
    without_build = commands.split('\n', 1)[1]
    run(re.sub(r'build/(\w+)', r'"$PYTHON_EXECUTABLE" \1.py', without_build), programs, folder)
    for cpu in [os.path.join(folder, 'build/joint_cpu')], [sys.executable, os.path.join(folder, 'joint_cpu.py')]:
        expect_safe_state_without_a_command(cpu, programs, folder)


def expect_safe_state_without_a_command(cpu, programs, folder):
    """From the first state on, at 0.02 s of a virtual ring's time: a stamp of 0 is one like others there."""
    with open(os.path.join(folder, 'ring.yaml')) as file:
        ring = file.read()
    started = ring.replace('name: knee\n    cpu: attached', 'name: knee\n    cpu: {command: %s}' % json.dumps(cpu))
    assert started != ring
    with open(os.path.join(folder, 'started.yaml'), 'w') as file:
        file.write(started)
    commands = ('ringctl up started.yaml --clock virtual --pace max --for 0.1 --capture knee.pcapng',
                'ringctl traffic show -r knee.pcapng --from knee --channel joint -d')
    outputs = [subprocess.run(command.split(), cwd=folder, env=environment_with(programs), timeout=GUARD, check=True,
                              stdout=subprocess.PIPE, universal_newlines=True).stdout for command in commands]
    states = re.findall(r'joint state \d+ \(([^)]*)', outputs[-1])
    assert set(states) == {'safe, hold'}, outputs[-1]


def environment_with(programs):
    environment = {key: value for key, value in os.environ.items() if not key.startswith('LIMB_RING')}
    environment['PATH'] = programs + ':' + environment['PATH']
    return environment


def run(commands, programs, folder):
    environment = environment_with(programs)
    # `wait`: the CPUs end with the ring.
    done = subprocess.run(['bash', '-e', '-c', commands + '\nwait\n'], cwd=folder, env=environment, timeout=GUARD,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    print(done.stdout)
    subprocess.run(['ringctl', '--ring', 'mine', 'down'], env=environment, cwd=folder,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    assert done.returncode == 0, 'exit %d' % done.returncode
    for said in ('delivered', '5 bytes from node 3', 'sent back: delivered', 'joint state', 'ring mine is down'):
        assert said in done.stdout, 'nobody said: ' + said


if __name__ == '__main__':
    main()
