#!/usr/bin/env python3
"""smoke_test.py RING_BENCH: a small benchmark runs, says what it promises, and leaves nothing behind."""
import glob
import json
import os
import subprocess
import sys
import tempfile
import unittest

RING_BENCH = sys.argv.pop(1) if len(sys.argv) > 1 else "ring_bench"


def bench(folder, *arguments):
    environment = dict(os.environ, TMPDIR=folder, XDG_RUNTIME_DIR=os.path.join(folder, "mine"))
    return subprocess.run([RING_BENCH, *arguments], env=environment, timeout=100,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)


def check_exit_code(test, run, report):
    """On a machine that is busy enough packets do fail, and then it says so."""
    test.assertEqual(run.returncode, 1 if report.get("failed") else 0, run.stderr)


class SmallBenchmark(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="bench_")
        cls.run_ = bench(cls.folder.name, "--nodes", "4", "--seconds", "0.2", "--rounds", "1",
                         "--payload", "100", "--no-ros", "--json")
        cls.report = json.loads(cls.run_.stdout) if cls.run_.stdout else {}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        check_exit_code(self, self.run_, self.report)

    def check_case(self, case):
        self.assertGreater(case["packets"], 0)
        self.assertGreater(case["packets_per_second"], 0)
        self.assertGreater(case["reference_ratio"], 0)
        times = case["round_trip_us"]
        self.assertLessEqual(times["p50"], times["p99"])
        self.assertLessEqual(times["p99"], times["max"])

    def test_says_what_was_measured(self):
        self.assertEqual(self.report["nodes"], 4)
        self.assertEqual(self.report["payload"], 100)
        self.assertIn("failed", self.report)

    def test_one_sender_and_all_sending_are_the_ring_over_unix_on_one_core(self):
        for sending in ("one_sender", "all_sending"):
            self.check_case(self.report[sending])
            self.assertEqual(self.report[sending], self.report["unix"]["one_core"][sending])

    def test_packets_flowed_in_every_case(self):
        for what in ("reference", "unix", "shm", "udp"):
            for pinning in ("one_core", "unpinned"):
                for sending in ("one_sender", "all_sending"):
                    with self.subTest(what=what, pinning=pinning, sending=sending):
                        self.check_case(self.report[what][pinning][sending])
        for pinning in ("one_core", "unpinned"):
            self.check_case(self.report["cpu_to_cpu"][pinning]["one_sender"])

    def test_daemons_placed_by_themselves_and_spinning_ones(self):
        for sending in ("one_sender", "all_sending"):
            self.check_case(self.report["placed"]["unpinned"][sending])
        if self.report["spin_nodes"] == 0:
            self.skipTest("one core only")
        self.check_case(self.report["spin"]["unpinned"]["one_sender"])

    def test_observing_is_compared_with_the_same_ring_unobserved(self):
        for pinning in ("one_core", "unpinned"):
            for sending in ("one_sender", "all_sending"):
                watched = self.report["watched"][pinning][sending]
                self.check_case(watched)
                self.assertGreater(watched["unwatched_ratio"], 0)

    def test_recording_is_compared_with_a_ring_that_does_not_record(self):
        recorded = self.report["recorded"]["one_core"]["all_sending"]
        self.check_case(recorded)
        self.assertGreater(recorded["unrecorded_ratio"], 0)

    def test_judging_and_viewing_are_compared_with_the_same_ring_without_them(self):
        for what in ("judged", "viewed"):
            for pinning in ("one_core", "unpinned"):
                with self.subTest(what=what, pinning=pinning):
                    case = self.report[what][pinning]["all_sending"]
                    self.check_case(case)
                    self.assertGreater(case["un%s_ratio" % what], 0)

    def test_keyed_lines_are_compared_with_the_same_without_a_key(self):
        for pinning in ("one_core", "unpinned"):
            for sending in ("one_sender", "all_sending"):
                keyed = self.report["keyed"][pinning][sending]
                self.check_case(keyed)
                self.assertGreater(keyed["unkeyed_ratio"], 0)

    def test_a_part_left_out_says_so(self):
        self.assertIn("--no-ros", self.report["relay_chain"]["skipped"])

    def test_the_idle_ring_takes_some_of_a_core(self):
        self.assertGreater(self.report["idle_cpu_percent"]["plain"], 0)

    def test_the_virtual_humanoid_leaves_no_sample_out(self):
        if not self.report["humanoid_virtual"]:
            self.skipTest("no humanoid16.yaml")
        self.assertEqual([row["state_rate"] for row in self.report["humanoid_virtual"]], [100, 1000])
        for row in self.report["humanoid_virtual"]:
            self.assertGreater(row["samples"], 0.1 * row["state_rate"] * 14)   # nodes with joints
            self.assertEqual(row["left_out"], 0)
            self.assertGreater(row["times_real_time"], 0)

    def test_leaves_nothing_behind(self):
        self.assertEqual(glob.glob(self.folder.name + "/*"), [])


class APart(unittest.TestCase):
    def test_is_measured_alone_beside_its_reference(self):
        with tempfile.TemporaryDirectory(prefix="bench_") as folder:
            run = bench(folder, "--nodes", "4", "--seconds", "0.1", "--rounds", "1", "--only", "shm", "--json")
        report = json.loads(run.stdout)
        check_exit_code(self, run, report)
        self.assertGreater(report["shm"]["one_core"]["all_sending"]["packets"], 0)
        self.assertEqual([name for name in ("unix", "udp", "judged", "viewed", "recorded", "cpu_to_cpu", "spin", "relay_chain")
                          if name in report], [])
        self.assertIsNone(report["humanoid_1khz"])


class WrongArguments(unittest.TestCase):
    def test_are_refused_as_usage(self):
        for wrong in (["--nodes", "1"], ["--only", "nothing"], ["--payload", "513"], ["--seconds", "0"], ["--rounds", "no"]):
            with self.subTest(wrong=wrong), tempfile.TemporaryDirectory(prefix="bench_") as folder:
                self.assertEqual(bench(folder, *wrong).returncode, 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
