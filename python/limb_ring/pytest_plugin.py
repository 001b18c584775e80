"""Fixtures for pytest, which finds this module by itself where it finds the package.

    @pytest.mark.ring('leg8.yaml')                       # beside the test file, or one that comes with limb_ring
    def test_knee(ring): ...

    @pytest.mark.ring('leg8.yaml', clock='virtual')      # what Ring() takes
    def test_on_the_virtual_clock(ring): ...

`ring` is up when the test begins, and of this test alone. `make_ring` makes further ones."""
import os

import pytest

from .ring import Ring, find_config


def pytest_configure(config):
    config.addinivalue_line('markers', 'ring(config, clock=..., pace=...): the ring that the fixture `ring` starts')


@pytest.fixture
def make_ring(request):
    """make_ring(config, ...): a Ring that is up, and goes down with the test."""
    rings = []

    def make(config, **options):
        if isinstance(config, (str, os.PathLike)):
            config = find_config(config, beside=os.path.dirname(str(request.fspath)))
        rings.append(Ring(config, **options))
        return rings[-1].up()
    yield make
    for ring in reversed(rings):
        ring.down()


@pytest.fixture
def ring(request, make_ring):
    """The ring that the mark `ring` describes."""
    mark = request.node.get_closest_marker('ring')
    if mark is None:
        pytest.fail("the fixture `ring` needs a mark that says which: @pytest.mark.ring('leg8.yaml')")
    return make_ring(*mark.args, **mark.kwargs)
