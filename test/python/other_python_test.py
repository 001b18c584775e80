"""The package beside a Python that it was not built for."""
import os
import shutil
import subprocess
import sys

import pytest

import limb_ring


@pytest.mark.parametrize('name', ['Ring', 'HostPort', 'HostPortError'])
def test_says_for_which_python_it_was_built(tmp_path, name):
    package = str(tmp_path / 'limb_ring')
    shutil.copytree(os.path.dirname(limb_ring.__file__), package)
    for file in os.listdir(package):
        if file.startswith('_client.'):
            os.rename(os.path.join(package, file), os.path.join(package, '_client.cpython-27-some-machine.so'))
    done = subprocess.run([sys.executable, '-c', 'import limb_ring; limb_ring.%s' % name], stderr=subprocess.PIPE,
                          universal_newlines=True, env=dict(os.environ, PYTHONPATH=str(tmp_path)))
    last = done.stderr.splitlines()[-1]
    assert 'was built for cpython-27-some-machine, this is Python %d.%d' % sys.version_info[:2] in last
    assert '-DPYTHON_EXECUTABLE=' in last
