"""Machines on one machine: network namespaces in a ring of cables (veth pairs), each with an address of its own. Needs
root. A host reaches its two neighbours by cable, and the others through them, as computers in a robot's limbs do."""
import os
import subprocess

PREFIX = '10.77.0.'


class NoNamespaces(Exception):
    """They cannot be had here; says why."""


def ip(*arguments, check=True):
    done = subprocess.run(['ip', *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    if check and done.returncode != 0:
        raise RuntimeError('ip %s: %s' % (' '.join(arguments), done.stdout.strip()))
    return done.stdout


class Network:
    """@param count of hosts, 3 to 9; cable i leads from host i to the next one"""

    def __init__(self, count):
        if os.geteuid() != 0:
            raise NoNamespaces('network namespaces need root')
        self.spaces = ['lr%d-%d' % (os.getpid(), i) for i in range(count)]
        try:
            ip('-V')
            ip('netns', 'add', self.spaces[0])
        except (OSError, RuntimeError) as problem:
            raise NoNamespaces('no network namespace can be made here: %s' % problem) from problem
        try:
            self._build()
        except BaseException:
            self.remove()
            raise

    def _build(self):
        for space in self.spaces[1:]:
            ip('netns', 'add', space)
        for i, space in enumerate(self.spaces):
            ip('-n', space, 'address', 'add', self.address(i) + '/32', 'dev', 'lo')
            ip('-n', space, 'link', 'set', 'lo', 'up')
            self.run(i, 'sh', '-c', 'echo 1 > /proc/sys/net/ipv4/ip_forward; '
                                    'echo 0 > /proc/sys/net/ipv4/conf/all/rp_filter; '
                                    'echo 0 > /proc/sys/net/ipv4/conf/default/rp_filter', check=True)
        for i, space in enumerate(self.spaces):
            ip('link', 'add', 'next', 'netns', space, 'type', 'veth', 'peer', 'name', 'prev', 'netns',
               self.spaces[self.after(i)])
        for i in range(len(self.spaces)):
            self.plug(i)

    def after(self, i):
        return (i + 1) % len(self.spaces)

    def address(self, i):
        return PREFIX + str(i + 1)

    def _lead(self, i, device):
        """The half of the others that is nearer by that cable is reached by it."""
        count = len(self.spaces)
        step = 1 if device == 'next' else -1
        neighbour = (i + step) % count
        ip('-n', self.spaces[i], 'route', 'replace', self.address(neighbour) + '/32', 'dev', device, 'src', self.address(i))
        far = range(2, count // 2 + 1) if step == 1 else range(2, (count + 1) // 2)
        for distance in far:
            ip('-n', self.spaces[i], 'route', 'replace', self.address((i + step * distance) % count) + '/32', 'via',
               self.address(neighbour), 'dev', device, 'onlink', 'src', self.address(i))

    def plug(self, cable):
        for i, device in ((cable, 'next'), (self.after(cable), 'prev')):
            ip('-n', self.spaces[i], 'link', 'set', device, 'up')
        for i, device in ((cable, 'next'), (self.after(cable), 'prev')):
            self._lead(i, device)

    def pull(self, cable):
        ip('-n', self.spaces[cable], 'link', 'set', 'next', 'down')

    def inside(self, i, *command):
        return ['ip', 'netns', 'exec', self.spaces[i], *command]

    def run(self, i, *command, **options):
        return subprocess.run(self.inside(i, *command), **options)

    def remove(self):
        for space in self.spaces:
            ip('netns', 'del', space, check=False)
