"""A demo that enters the build's environment keeps its arguments: catkin's setup.bash must not take them."""
import os
import subprocess
import sys
import tempfile

SCRIPTS = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts')
DEMO = """
import sys
sys.path.insert(0, %r)
from live_ring import ros_ring
ros_ring.SETUP = %r
ros_ring.enter_build()
print(sys.argv[1:])
"""


def main():
    arguments = ['--help', '--duration', '20']
    outside = {name: value for name, value in os.environ.items() if name in ('HOME', 'PATH')}
    with tempfile.NamedTemporaryFile('w', suffix='.py') as demo:
        demo.write(DEMO % (SCRIPTS, sys.argv[1]))
        demo.flush()
        done = subprocess.run([sys.executable, demo.name, *arguments], env=outside, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=60)
    assert done.returncode == 0 and done.stdout == '%s\n' % arguments, done.stdout


main()
