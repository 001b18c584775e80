"""What `cmake --install` puts in place, what the Debian packages hold, and that both say the same as the programs.

usage: install_test.py SOURCE BUILD CMAKE
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BUILD, CMAKE = '', '', 'cmake'
GUARD = 120   # s
NO_DEBIAN_PACKAGES_BUILD = {'libgtest-dev', 'libgmock-dev', 'librostest-dev', 'ros-base-dev', 'zlib1g-dev'}   # tests alone need them


def read(*path):
    with open(os.path.join(*path)) as file:
        return file.read()


def run(*command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                          timeout=GUARD, check=True, **options).stdout


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='install_test_')
        # In a copy of the build's folder: its list of what was installed last is not for a test to replace.
        cls.prefix = os.path.join(cls.folder, 'prefix')
        cls.manifest = os.path.join(cls.folder, 'install_manifest.txt')
        kept = os.path.join(BUILD, 'install_manifest.txt')
        before = read(kept) if os.path.exists(kept) else None
        run(CMAKE, '--install', BUILD, '--prefix', cls.prefix)
        shutil.copy(kept, cls.manifest)
        if before is None:
            os.remove(kept)
        else:
            with open(kept, 'w') as file:
                file.write(before)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def man(self, program):
        return read(self.prefix, 'share', 'man', 'man1', program + '.1')

    def programs(self):
        return os.listdir(os.path.join(self.prefix, 'bin'))

    def test_a_every_program_on_path_runs_and_has_a_man_page_and_completion(self):
        self.assertEqual(sorted(self.programs()), ['compare_networks', 'limb_firmware', 'ring_sim', 'ringctl', 'ringd'])
        for program in self.programs():
            self.assertIn(program + ' ', run(os.path.join(self.prefix, 'bin', program), '--version'))
            self.assertIn('.SH SEE ALSO', self.man(program))
            self.assertTrue(os.path.exists(os.path.join(self.prefix, 'share/bash-completion/completions', program)))

    def test_a_man_pages_name_every_subcommand(self):
        for program in ('ringctl', 'ring_sim'):
            path, page = os.path.join(self.prefix, 'bin', program), self.man(program).replace('\\-', '-')
            subcommands = [word for word in run(path, 'complete', '').split() if word not in ('', 'help')]
            self.assertGreater(len(subcommands), 5)
            for subcommand in subcommands:
                self.assertIn('\n.SS %s %s ' % (program, subcommand), page)
                for option in re.findall(r'^\s+(?:-\w,)?(--[\w-]+)', run(path, subcommand, '--help'), re.M):
                    self.assertIn(option, page, subcommand)

    def test_a_the_unit_starts_a_program_that_is_there(self):
        unit = read(self.prefix, 'share', 'systemd', 'user', 'limb-ring@.service')
        program, = re.findall(r'^ExecStart="(.+?)" up %i$', unit, re.M)
        self.assertEqual(program, os.path.join(self.prefix, 'bin', 'ringctl'))
        self.assertTrue(os.access(program, os.X_OK))

    def test_a_scenarios_find_their_rings(self):
        folder = os.path.join(self.prefix, 'share', 'limb_ring', 'scenarios')
        self.assertGreater(len(os.listdir(folder)), 30)
        scenario, = [name for name in os.listdir(folder) if name.startswith('07-')]
        ringctl = os.path.join(self.prefix, 'bin', 'ringctl')
        self.assertIn('all as expected', run(ringctl, 'scenario', 'run', os.path.join(folder, scenario)))
        self.assertNotIn('not a scenario', run(ringctl, 'scenario', 'list', folder))

    def test_a_moved_prefix_works(self):
        moved = os.path.join(self.folder, 'moved')
        shutil.copytree(self.prefix, moved, symlinks=True)
        # The ring's file is found by its name, below the prefix; a wrong option is found after it.
        environment = dict(os.environ, HOME=self.folder, XDG_RUNTIME_DIR=self.folder)
        environment.pop('XDG_CONFIG_HOME', None)
        done = subprocess.run([os.path.join(moved, 'bin', 'ringctl'), 'up', 'leg8', '--nodes', '3'], env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=GUARD,
                              check=False)
        self.assertIn(os.path.join(moved, 'share/limb_ring/config/leg8.yaml') + ' has 8 nodes', done.stdout)
        if shutil.which('pkg-config'):
            folder, = [path for path, _, files in os.walk(moved) if 'limb_ring.pc' in files]
            flags = run('pkg-config', '--cflags', 'limb_ring', env=dict(os.environ, PKG_CONFIG_PATH=folder)).split()
            self.assertTrue(os.path.exists(os.path.join(flags[0][2:], 'limb_ring', 'host_port.h')), flags)

    def test_b_uninstalling_leaves_nothing(self):
        script = os.path.join(SOURCE, 'cmake', 'uninstall.cmake')
        run(CMAKE, '-D', 'MANIFEST=' + self.manifest, '-P', script)
        # .catkin marks a prefix that other packages may be in, too.
        left = set(os.listdir(self.prefix)) - {'.catkin'}
        self.assertTrue(left <= {'bin', 'etc', 'include', 'lib', 'share'}, left)
        for folder in left:
            self.assertEqual(os.listdir(os.path.join(self.prefix, folder)), [], folder)
        with self.assertRaises(subprocess.CalledProcessError) as again:
            run(CMAKE, '-D', 'MANIFEST=' + self.manifest, '-P', script)
        self.assertIn('nothing to uninstall', again.exception.stdout)


class Debian(unittest.TestCase):
    def test_its_version_is_the_packages(self):
        version, = re.findall(r'<version>(.+?)</version>', read(SOURCE, 'package.xml'))
        self.assertEqual(re.match(r'limb-ring \((.+?)\)', read(SOURCE, 'debian', 'changelog')).group(1), version)
        self.assertIn('file(STRINGS package.xml version', read(SOURCE, 'CMakeLists.txt'))

    def test_it_builds_with_all_that_a_build_here_is_given(self):
        given = set(re.findall(r'[\w.+-]+-dev\b', read(SOURCE, 'scripts', 'install_dependencies')))
        control = read(SOURCE, 'debian', 'control')
        wanted = set(re.findall(r'[\w.+-]+-dev\b', control[:control.index('\nPackage:')]))
        self.assertEqual(given - wanted - NO_DEBIAN_PACKAGES_BUILD, set())

    def test_its_scripts_say_what_they_are_for(self):
        for script in ('make_deb', 'deb_check', 'deb_trial', 'copy_tree'):
            path = os.path.join(SOURCE, 'scripts', script)
            self.assertIn('usage: ' + script, run(path, '--help'))
            wrong = subprocess.run([path, '--no-such-option'], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   timeout=GUARD, check=False)
            self.assertEqual(wrong.returncode, 2)


if __name__ == '__main__':
    SOURCE, BUILD, CMAKE = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1], verbosity=2)
