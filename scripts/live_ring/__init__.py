"""What scripts/demo, scripts/chaos, scripts/fault_table and the process tests stand on: rings of real daemons in a folder
of their own, the host port, traffic whose every packet can be checked, the ring's own account of what happens, and
faults on purpose."""
