"""Imported before limb_ring where that is to be found without a set-up shell: beside the programs that are used, or in the
build beside these scripts."""
import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
PROGRAMS = os.environ.get('RING_TEST_PROGRAMS') or os.path.join(ROOT, 'build', 'devel', 'lib', 'limb_ring')

try:
    import limb_ring._client  # noqa: F401
except ImportError:
    sys.path.insert(0, os.path.normpath(os.path.join(PROGRAMS, '..', 'python3', 'dist-packages')))
    sys.modules.pop('limb_ring', None)   # one with the messages alone
    try:
        import limb_ring._client  # noqa: F401
    except ImportError as problem:
        print('%s: no Python library of limb_ring in %s: %s; run `make build` first, or say by RING_TEST_PROGRAMS in which '
              'folder ringd is' % (os.path.basename(sys.argv[0]), sys.path[0], problem), file=sys.stderr)
        sys.exit(2)
