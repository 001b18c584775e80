# Two commands on a fresh machine: make demo, make test. Each installs what is missing (apt),
# builds, and runs. See README.md.

# The system's Python: another one in front of PATH (conda, pyenv) has no catkin_pkg and no rospy.
SHELL := /bin/bash
MAKEFLAGS += --no-print-directory
PYTHON ?= /usr/bin/python3
JOBS ?= $(shell nproc)
# All builds are below it: rosrun looks for a program in the whole package, but not there.
BUILD := build
SANITIZE ?=
DURATION ?=
BENCH_ARGS ?=
BENCH_SIM_ARGS ?=
ROS_SETUP := $(wildcard /opt/ros/noetic/setup.bash)
SPACE := $(subst ,, )
WITH_ROS := $(if $(ROS_SETUP),. $(ROS_SETUP) &&)

.PHONY: help all build docs demo virtual-demo board-demo demo-hosts tests test test-quick soak goals compared campaign mutants planted coverage fuzz traces bench bench-sim bench-large chaos fault-table conform forge install-dissector playground deb deb-check deps clean format
all: build

help: ## This list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-18s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

deps: ## Installs what is missing (apt)
	@scripts/install_dependencies

$(BUILD)/CMakeCache.txt: | deps
	$(WITH_ROS) cmake -S . -B $(BUILD) -DPYTHON_EXECUTABLE=$(PYTHON)

BUILD_TARGET = $(WITH_ROS) cmake --build $(BUILD) -j$(JOBS) --target

build: deps $(BUILD)/CMakeCache.txt ## Builds all programs
	$(BUILD_TARGET) all
	@echo "Built. In each terminal: . $(BUILD)/devel/setup.bash; export PATH=\$$PWD/$(BUILD)/devel/lib/limb_ring:\$$PATH"

demo: deps $(BUILD)/CMakeCache.txt ## Builds what it needs; a humanoid walks, hangs and is reset (DURATION=20)
	$(BUILD_TARGET) demo_programs
	. $(BUILD)/devel/setup.bash && $(PYTHON) scripts/demo $(if $(DURATION),--duration $(DURATION))

virtual-demo: deps $(BUILD)/CMakeCache.txt ## The same on a virtual clock, twice the same, beside its bound (DURATION=20)
	$(BUILD_TARGET) virtual_demo_programs
	. $(BUILD)/devel/setup.bash && $(PYTHON) scripts/virtual_demo $(if $(DURATION),--duration $(DURATION))

board-demo: deps $(BUILD)/CMakeCache.txt ## The humanoid with its left knee on a Cortex-M3 (needs gcc-arm-none-eabi, qemu-system-arm)
	$(BUILD_TARGET) demo_programs ring_serial
	. $(BUILD)/devel/setup.bash && $(PYTHON) scripts/board_demo

demo-hosts: deps $(BUILD)/CMakeCache.txt ## A ring on four hosts (network namespaces; needs root): cable pulled, host killed
	$(BUILD_TARGET) ringd ringctl limb_firmware limb_ring_python
	$(PYTHON) scripts/demo_hosts --programs $(BUILD)/devel/lib/limb_ring

tests: build ## Builds the tests
	$(BUILD_TARGET) tests

# What is quick, under sanitizers: 3 minutes on 2 cores.
QUICK_TESTS := test_wire test_core test_capture test_fault payload_fragment_test payload_joint_test test_study_soak \
               fuzz_slices fuzz_packets fuzz_control_messages fuzz_controller fuzz_fragments fuzz_pcapng
test-quick: deps ## The quick tests, under address and undefined behaviour sanitizers
	@cmake -S . -B $(BUILD)/quick -DLIMB_RING_ROS=OFF -DLIMB_RING_SANITIZE=address,undefined -DCMAKE_BUILD_TYPE=Quick \
	  -DCMAKE_CXX_FLAGS_QUICK=-O1 -DPYTHON_EXECUTABLE=$(PYTHON) > /dev/null
	cmake --build $(BUILD)/quick -j$(JOBS) --target $(QUICK_TESTS)
	cd $(BUILD)/quick && LIMB_RING_SEEDS=10 GTEST_FILTER=-*InWideWorlds:*KeptDeadline*:Goals.AreMetBy* ctest -j$(JOBS) --output-on-failure -R '^($(subst $(SPACE),|,$(strip $(QUICK_TESTS))))$$'

# Those of living rings mostly wait.
TESTS_AT_ONCE = $$((4 * $(JOBS)))
ifeq ($(SANITIZE),)
test: tests ## Builds and runs all tests (SANITIZE=address,undefined: what needs no ROS, under sanitizers)
	. $(BUILD)/devel/setup.bash && cd $(BUILD) && ctest -j$(TESTS_AT_ONCE) --output-on-failure
else
test: deps
	cmake -S . -B $(BUILD)/sanitize -DLIMB_RING_ROS=OFF -DLIMB_RING_SANITIZE=$(SANITIZE) -DPYTHON_EXECUTABLE=$(PYTHON)
	cmake --build $(BUILD)/sanitize -j$(JOBS) --target all tests
	cd $(BUILD)/sanitize && ctest -j$(TESTS_AT_ONCE) --output-on-failure
endif

# Random faults by seed under the virtual clock; stops at the first broken promise.
SEEDS ?= 1000
soak: build ## Random faults by seed under the virtual clock (SEEDS=10000)
	$(BUILD)/devel/lib/limb_ring/ring_sim soak --seeds $(SEEDS)

# In how many seeds each situation was met that a ring should be seen in; into docs/explanation/soak.md.
goals: build ## In how many seeds each goal was met, into docs/explanation/soak.md (SEEDS=20000)
	$(PYTHON) scripts/soak_tables goals --seeds $(SEEDS) --programs $(BUILD)/devel/lib/limb_ring

# Core and model of the specification, over random histories of each world; Ctrl-C ends it, and it writes what it has.
compared: deps $(BUILD)/CMakeCache.txt ## Core and model over SEEDS histories of each world, into docs/explanation/soak.md
	$(BUILD_TARGET) test_model
	$(PYTHON) scripts/soak_tables compared --seeds $(SEEDS) --test-model $(BUILD)/tests/test_model

# All that looks for broken promises, in turns, with fresh seeds; goes on after an interruption.
HOURS ?= 1
campaign: build ## Soak, the model, explore, chaos, and fuzz after `make fuzz`, in turns for hours; one page (HOURS=8)
	$(BUILD_TARGET) test_model
	$(PYTHON) scripts/campaign --hours $(HOURS) --folder $(BUILD)/campaign --programs $(BUILD)/devel/lib/limb_ring \
	  --test-model $(BUILD)/tests/test_model $(if $(wildcard $(BUILD)/fuzz/tests),--fuzz $(BUILD)/fuzz)

# Does a change of the core at a random place go unnoticed by the quick tests? By SEED (1), COUNT of them.
mutants: deps ## Changes a copy of the core at random places; do the tests notice? (COUNT=20 SEED=1)
	$(PYTHON) test/mutants/try_mutants $(if $(COUNT),--count $(COUNT)) $(if $(SEED),--seed $(SEED)) --jobs $(JOBS)

# Failures of chaos with a core that is broken on purpose: recorded live, and replayed.
planted: build ## Breaks the core of live rings on purpose, and replays what failed from their recordings (FAILURES=10)
	$(BUILD_TARGET) limb_ring_python
	$(PYTHON) test/mutants/plant_failures $(if $(FAILURES),--failures $(FAILURES)) --programs $(BUILD)/devel/lib/limb_ring --jobs $(JOBS)

# Lines and branches that the tests which need no ROS have run, for each folder; in a build of its own. ONLY some of them.
# What links to our libraries from outside cannot be built with it; a daemon that is killed while it writes down what it has
# run leaves less than all, and libgcov says so in gcov_errors.
ONLY ?=
coverage: deps ## How much of the sources the tests run, by folder (ONLY="test_core test_wire" FILES=daemon/core; needs gcovr)
	@command -v gcovr > /dev/null || { echo "make coverage needs gcovr: apt-get install gcovr"; exit 2; }
	cmake -S . -B $(BUILD)/coverage -DLIMB_RING_ROS=OFF -DCMAKE_BUILD_TYPE=Coverage \
	  -DCMAKE_CXX_FLAGS_COVERAGE="-Og --coverage" -DLIMB_RING_PATIENCE=10 -DPYTHON_EXECUTABLE=$(PYTHON)
	cmake --build $(BUILD)/coverage -j$(JOBS) --target $(if $(ONLY),$(ONLY),all tests)
	find $(BUILD)/coverage -name '*.gcda' -delete
	cd $(BUILD)/coverage && GCOV_ERROR_FILE=$$PWD/gcov_errors ctest -j$(JOBS) --output-on-failure -E '^consumer_of' $(if $(ONLY),-R '^($(subst $(SPACE),|,$(strip $(ONLY))))$$') || \
	  echo "Not all tests have passed: what is printed is of all that were run."
	$(PYTHON) scripts/print_coverage --build $(BUILD)/coverage $(if $(FILES),--files $(FILES))

# Everything that reads bytes or text from outside, given anything; in a build of its own, by clang's libFuzzer.
SECONDS ?= 60
fuzz: deps ## Gives all parsers anything, for 60 s each (SECONDS=60 FUZZ_ARGS="--target slices"; needs clang)
	@command -v clang++ > /dev/null || { echo "make fuzz needs clang++ and its libFuzzer: apt-get install clang"; exit 2; }
	cmake -S . -B $(BUILD)/fuzz -DLIMB_RING_ROS=OFF -DLIMB_RING_FUZZ=ON -DLIMB_RING_SANITIZE=address,undefined \
	  -DCMAKE_CXX_COMPILER=clang++ -DPYTHON_EXECUTABLE=$(PYTHON)
	cmake --build $(BUILD)/fuzz -j$(JOBS) --target fuzz
	$(PYTHON) test/fuzz/run_fuzz --build $(BUILD)/fuzz --seconds $(SECONDS) $(FUZZ_ARGS)

# What the virtual ring does, as hashes: the same before and after a change that is to change nothing.
traces: build ## What the virtual ring does, as hashes
	@$(PYTHON) scripts/traces --programs $(BUILD)/devel/lib/limb_ring --seeds 2000

# Random faults on a live ring of 16, or with CLOCK=virtual on a virtual one with real programs, by SEED (drawn and printed where not given), for MINUTES.
MINUTES ?= 1
SEED ?=
TRANSPORT ?=
KEYED ?=
CLOCK ?=
REDUNDANCY ?= none
LIVE_ARGS = $(if $(SEED),--seed $(SEED)) $(if $(TRANSPORT),--transport $(TRANSPORT)) $(if $(KEYED),--keyed) --redundancy $(REDUNDANCY) \
            --programs $(BUILD)/devel/lib/limb_ring
chaos: build ## Random faults on a live ring of 16 (MINUTES=10 SEED=7 TRANSPORT=mixed KEYED=1 REDUNDANCY=foldback CLOCK=virtual FOREIGN=1)
	$(PYTHON) scripts/chaos --minutes $(MINUTES) $(if $(CLOCK),--clock $(CLOCK)) $(if $(FOREIGN),--foreign) $(LIVE_ARGS)

# What the ring does about each fault, in figures: COUNT times each.
COUNT ?= 20
fault-table: build ## What the ring does about each fault, in figures (COUNT=20)
	$(PYTHON) scripts/fault_table --count $(COUNT) $(LIVE_ARGS)

# Somebody with a hand on the cable of a keyed ring; COUNT datagrams, RATE a second.
RATE ?= 20000
FORGE_COUNT = $(if $(filter command environment,$(origin COUNT)),$(COUNT),1000000)
forge: build ## Forged, replayed and damaged datagrams against a keyed ring (COUNT=1000000 RATE=20000)
	$(BUILD_TARGET) forge_line
	FORGE_COUNT=$(FORGE_COUNT) FORGE_RATE=$(RATE) FORGE_LINE=$(BUILD)/tests/forge_line \
	  RING_TEST_PROGRAMS=$(BUILD)/devel/lib/limb_ring $(PYTHON) test/process/forge_test.py

conform: build ## The conformance kit on ringd, the nodes in C and Python, and on wrong ones
	cd $(BUILD) && ctest -j$(JOBS) --output-on-failure -R '^conform_'

bench: build ## Live and virtual benchmarks (BENCH_ARGS=...)
	@code=0; (set -x; $(BUILD)/devel/lib/limb_ring/ring_bench $(BENCH_ARGS)) || code=$$?; $(MAKE) bench-sim && exit $$code

# In a build of its own, for speed whatever the other is built for.
bench-sim: deps ## The virtual ring alone (BENCH_SIM_ARGS=...)
	cmake -S . -B $(BUILD)/bench-sim -DLIMB_RING_ROS=OFF -DCMAKE_BUILD_TYPE=Release -DPYTHON_EXECUTABLE=$(PYTHON)
	cmake --build $(BUILD)/bench-sim -j$(JOBS) --target bench_sim_hops bench_core_hop
	$(BUILD)/bench-sim/devel/lib/limb_ring/bench_sim_hops $(BENCH_SIM_ARGS)
	$(BUILD)/bench-sim/devel/lib/limb_ring/bench_core_hop

# A ring of 254 daemons, on one host and over four, one of which dies and comes back.
bench-large: build ## How long a ring of 254 nodes takes to close (BENCH_LARGE_ARGS=...)
	$(PYTHON) scripts/large_ring --programs $(BUILD)/devel/lib/limb_ring $(BENCH_LARGE_ARGS)

# Needs the programs: they know best what their options are.
docs: build ## The manual as HTML, into build/docs, with the playground if it was built (needs python3-sphinx, python3-myst-parser, furo)
	@$(PYTHON) -c 'import furo, myst_parser, sphinx' 2> /dev/null || \
	  { echo "make docs needs Sphinx: apt-get install python3-sphinx python3-myst-parser furo"; exit 2; }
	PYTHONPATH=$(BUILD)/devel/lib/python3/dist-packages $(PYTHON) docs/generate_reference.py --programs $(BUILD)/devel/lib/limb_ring
	$(PYTHON) -m sphinx -W --keep-going -q -b html docs $(BUILD)/docs
	@[ -d $(BUILD)/playground/page ] || echo "Without the playground, which 'make playground' builds"
	@echo "The manual: $(BUILD)/docs/index.html"

# Without emscripten it says so and ends with 77.
playground: ## The simulator for a browser tab, into build/playground/page (needs emscripten)
	@JOBS=$(JOBS) scripts/make_playground $(BUILD)/playground

deb: ## The Debian packages, into build/deb/ (installs by apt what building needs)
	@JOBS=$(JOBS) scripts/make_deb build/deb

# Root only; elsewhere it says so and ends with 77.
SUITE ?= bookworm
MIRROR ?=
CCACHE ?=
deb-check: ## Builds, installs and tries the packages in clean chroots (SUITE=trixie; needs root; MIRROR= CCACHE=)
	@JOBS=$(JOBS) scripts/deb_check $(SUITE) $(if $(MIRROR),--mirror $(MIRROR)) $(if $(CCACHE),--ccache $(CCACHE))

format: ## Formats all C++ files (clang-format 14)
	git ls-files '*.h' '*.cpp' | xargs clang-format -i

# Into the user's Wireshark: see docs/reference/captures.md.
install-dissector: ## The Wireshark dissector, for this user
	@scripts/install_dissector

clean: ## Removes all builds
	rm -rf $(BUILD)
