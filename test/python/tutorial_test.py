"""The tests that the tutorial prints pass as they stand there."""
import os
import re
import subprocess
import sys


def test_the_tests_of_the_tutorial_pass(tmp_path):
    with open(os.environ['LIMB_RING_TUTORIAL']) as page:
        blocks = re.findall(r'^```python\n(# (test_\w+\.py).*?)^```', page.read(), re.M | re.S)
    assert blocks
    for block, name in blocks:
        assert len(block.splitlines()) <= 16
        (tmp_path / name).write_text(block)
    done = subprocess.run([sys.executable, '-m', 'pytest', '-q', '-p', 'no:cacheprovider'], cwd=str(tmp_path),
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=100)
    assert done.returncode == 0, done.stdout
    assert '%d passed' % len(re.findall(r'^def test_', ''.join(block for block, _ in blocks), re.M)) in done.stdout


def test_its_example_of_a_host_port_does_what_its_comment_says():
    with open(os.environ['LIMB_RING_TUTORIAL']) as page:
        block, = re.findall(r'^```python\n(with limb_ring.*?)^```', page.read(), re.M | re.S)
    said, = re.findall(r'# (<.*>)', block)
    done = subprocess.run([sys.executable, '-c', 'import limb_ring\n' + block], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, timeout=100)
    assert done.stdout.strip() == said
