"""What scripts/chaos and scripts/fault_table stand on: a live ring of real daemons in a folder of its own, traffic
whose every packet can be checked, the ring's own account of what happens, and faults on purpose."""
import os
import sys

# The host port's messages, as the process tests have them.
sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'test', 'process'))
