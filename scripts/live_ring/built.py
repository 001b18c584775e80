"""Imported before limb_ring where that is to be found without a set-up shell: beside the programs that are used, or in the
build beside these scripts."""
import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
PROGRAMS = os.environ.get('RING_TEST_PROGRAMS') or os.path.join(ROOT, 'build', 'devel', 'lib', 'limb_ring')

try:
    import limb_ring._client  # noqa: F401
except ImportError:
    sys.path.insert(0, os.path.join(PROGRAMS, '..', 'python3', 'dist-packages'))
    sys.modules.pop('limb_ring', None)   # one with the messages alone
