# Two commands on a fresh machine: make demo, make test. Each installs what is missing (apt),
# builds, and runs. See README.md.

# The system's Python: another one in front of PATH (conda, pyenv) has no catkin_pkg and no rospy.
SHELL := /bin/bash
MAKEFLAGS += --no-print-directory
PYTHON ?= /usr/bin/python3
JOBS ?= $(shell nproc)
BUILD := build
SANITIZE ?=
DURATION ?=
BENCH_ARGS ?=
BENCH_SIM_ARGS ?=
ROS_SETUP := $(wildcard /opt/ros/noetic/setup.bash)
WITH_ROS := $(if $(ROS_SETUP),. $(ROS_SETUP) &&)

.PHONY: all build test demo soak traces bench bench-sim chaos fault-table install-dissector deps clean
all: build

deps:
	@scripts/install_dependencies

$(BUILD)/CMakeCache.txt: | deps
	$(WITH_ROS) cmake -S . -B $(BUILD) -DPYTHON_EXECUTABLE=$(PYTHON)

build: deps $(BUILD)/CMakeCache.txt
	$(WITH_ROS) cmake --build $(BUILD) -j$(JOBS)
	@echo "Built. The programs are in $(BUILD)/devel/lib/limb_ring; '. $(BUILD)/devel/setup.bash' finds them."

ifeq ($(SANITIZE),)
test: build
	. $(BUILD)/devel/setup.bash && cd $(BUILD) && ctest -j$(JOBS) --output-on-failure
else
# What needs no ROS, under sanitizers.
test: deps
	cmake -S . -B $(BUILD)-sanitize -DLIMB_RING_ROS=OFF -DLIMB_RING_SANITIZE=$(SANITIZE) -DPYTHON_EXECUTABLE=$(PYTHON)
	cmake --build $(BUILD)-sanitize -j$(JOBS)
	cd $(BUILD)-sanitize && ctest -j$(JOBS) --output-on-failure
endif

demo: build
	. $(BUILD)/devel/setup.bash && $(PYTHON) scripts/demo $(if $(DURATION),--duration $(DURATION))

# Random faults by seed under the virtual clock; stops at the first broken promise.
SEEDS ?= 1000
soak: build
	$(BUILD)/devel/lib/limb_ring/ring_sim soak --seeds $(SEEDS)

# What the virtual ring does, as hashes: the same before and after a change that is to change nothing.
traces: build
	@$(PYTHON) scripts/traces --programs $(BUILD)/devel/lib/limb_ring --seeds 2000

# Random faults on a live ring of 16, by SEED (drawn and printed where not given), for MINUTES.
MINUTES ?= 1
SEED ?=
TRANSPORT ?= unix
REDUNDANCY ?= none
LIVE_ARGS = $(if $(SEED),--seed $(SEED)) --transport $(TRANSPORT) --redundancy $(REDUNDANCY) \
            --programs $(BUILD)/devel/lib/limb_ring
chaos: build
	$(PYTHON) scripts/chaos --minutes $(MINUTES) $(LIVE_ARGS)

# What the ring does about each fault, in figures: COUNT times each.
COUNT ?= 20
fault-table: build
	$(PYTHON) scripts/fault_table --count $(COUNT) $(LIVE_ARGS)

bench: build
	$(BUILD)/devel/lib/limb_ring/ringctl bench $(BENCH_ARGS)
	@$(MAKE) bench-sim

# In a build of its own, for speed whatever the other is built for.
bench-sim: deps
	cmake -S . -B $(BUILD)-bench -DLIMB_RING_ROS=OFF -DCMAKE_BUILD_TYPE=Release -DPYTHON_EXECUTABLE=$(PYTHON)
	cmake --build $(BUILD)-bench -j$(JOBS) --target bench_sim_hops
	$(BUILD)-bench/devel/lib/limb_ring/bench_sim_hops $(BENCH_SIM_ARGS)

# Into the user's Wireshark: see docs/capture.md.
install-dissector:
	@scripts/install_dissector

clean:
	rm -rf $(BUILD) $(BUILD)-sanitize $(BUILD)-bench
