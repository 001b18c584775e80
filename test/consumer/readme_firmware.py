"""The section "Your own firmware" of README.md: its files are written, its commands run, its firmware answers.

usage: readme_firmware.py README PROGRAMS FOLDER     (the environment says how limb_ring is found)
"""
import os
import re
import subprocess
import sys

HEADING = '### Your own firmware'
FILES = {'ring.yaml', 'CMakeLists.txt', 'knee_cpu.cpp'}
GUARD = 240  # s


def section(readme):
    with open(readme) as file:
        text = file.read()
    start = text.index(HEADING) + len(HEADING)
    return text[start:text.index('\n### ', start)]


def blocks(text):
    return re.findall(r'^```(\w+)\n(.*?)^```', text, re.M | re.S)


def write_files(found, folder):
    """Every block but the commands names its file in the comment at its beginning."""
    written = set()
    for _, block in found:
        name = re.match(r'(?:#|//) ([\w.]+)', block)
        if name:
            written.add(name.group(1))
            with open(os.path.join(folder, name.group(1)), 'w') as file:
                file.write(block)
    assert written == FILES, written


def main():
    readme, programs, folder = sys.argv[1:]
    os.mkdir(folder)
    found = blocks(section(readme))
    write_files(found, folder)
    commands, = (block for language, block in found if language == 'sh')
    environment = {key: value for key, value in os.environ.items() if not key.startswith('LIMB_RING')}
    environment['PATH'] = programs + ':' + environment['PATH']
    # `wait`: knee_cpu ends with the ring.
    done = subprocess.run(['bash', '-e', '-c', commands + '\nwait\n'], cwd=folder, env=environment, timeout=GUARD,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    print(done.stdout)
    subprocess.run(['ringctl', '--ring', 'mine', 'down'], env=environment, cwd=folder,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    assert done.returncode == 0, 'exit %d' % done.returncode
    for said in ('delivered', '5 bytes from node 0', 'sent back: delivered', 'ring mine is down'):
        assert said in done.stdout, 'nobody said: ' + said


if __name__ == '__main__':
    main()
