"""`ringctl traffic judge` beside a living ring: it must find nothing."""
import signal
import subprocess

END_TIMEOUT = 10  # s


class PromiseWatch:
    def __init__(self, ring):
        self.log = '%s/watch.log' % ring.folder
        with open(self.log, 'wb') as log:
            self.process = subprocess.Popen([ring.launcher.program('ringctl'), '--ring', ring.name, 'traffic', 'judge'],
                                            env=ring.launcher.environment, stdout=log, stderr=subprocess.STDOUT,
                                            start_new_session=True)

    def lines(self):
        with open(self.log, encoding='utf-8', errors='replace') as log:
            return [line.strip() for line in log if line.strip()]

    def problems(self):
        """What it says is broken, and that it has ended by itself."""
        broken = ['ringctl traffic judge: ' + line for line in self.lines() if ': broken: ' in line]
        if not broken and self.process.poll() is not None:
            broken = ['ringctl traffic judge has ended by itself with %d: %s' % (self.process.returncode, self.last())]
        return broken

    def last(self):
        return self.lines()[-1] if self.lines() else 'it has said nothing'

    def end(self):
        """What was wrong."""
        if self.process.poll() is not None:
            return self.problems()
        self.process.send_signal(signal.SIGINT)
        try:
            code = self.process.wait(END_TIMEOUT)
        except subprocess.TimeoutExpired:
            self.kill()
            return ['ringctl traffic judge does not end']
        broken = [problem for problem in self.problems() if ': broken: ' in problem]
        return broken or ([] if code == 0 else ['ringctl traffic judge ended with %d: %s' % (code, self.last())])

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
