#!/usr/bin/python3
"""The recipes of docs/sweeps.md, for real: GNU parallel here, GNU parallel over ssh to a server of
our own, and a job array in a Slurm cluster of one node. Each is left out where its programs are not
installed (scripts/test.sh installs them)."""
import contextlib
import getpass
import os
import shutil
import signal
import socket
import subprocess
import sys
import time

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import processes  # noqa: E402
from sweep_support import ROOT, SweepTest  # noqa: E402

os.environ['PATH'] += ':/usr/sbin:/sbin'  # where the servers are
DEADLINE = 30.0  # [s]


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def listens(port):
    with socket.socket() as probe:
        return probe.connect_ex(('127.0.0.1', port)) == 0


class RecipesTest(SweepTest):
    GRID = ('phases.hold.timeout=0.1,0.2', 'seed=1..2')
    LONG = ('phases.hold.timeout=0.1,10000',)  # the second: a minute

    def need(self, *programs):
        missing = [program for program in programs if shutil.which(program) is None]
        self.assertFalse(missing, 'not installed: ' + ' '.join(missing))

    def wait_until(self, condition, what):
        end = time.monotonic() + DEADLINE
        while not condition():
            self.assertLess(time.monotonic(), end, 'still waiting for ' + what)
            time.sleep(0.05)

    def start(self, *command, **options):
        """A process of its own group, ended with the test."""
        with open(self.path('servers.log'), 'ab') as log:
            process = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL,
                                       start_new_session=True, **options)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def end_runs(self):
        """Ends the runs of this test that have outlived the program that started them."""
        for process in processes(self.folder.name):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)

    def check(self, *command, **options):
        result = subprocess.run(command, capture_output=True, text=True, timeout=120, **options)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    def all_done(self):
        self.assertEqual(self.jobs(*self.GRID), [])
        self.assertEqual(len(self.summaries()), 4)

    # ---- one machine -----------------------------------------------------------------------------

    def test_parallel(self):
        self.need('parallel')
        self.check('parallel', '--jobs', '2', '--arg-file', self.job_list(*self.GRID), '{}')
        self.all_done()

    def test_parallel_that_is_killed_is_resumed(self):
        self.need('parallel')
        self.addCleanup(self.end_runs)
        process = self.start('parallel', '--jobs', '2', '--arg-file', self.job_list(*self.LONG),
                             '{}')
        self.wait_until(lambda: self.summaries(), 'the short run')
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        left = self.jobs(*self.LONG)
        self.assertEqual(len(left), 1)
        self.assertIn('timeout=10000', left[0])
        self.assertEqual([name for name in self.summaries() if name.endswith('.json')],
                         ['phases.hold.timeout=0.1.json'])

    # ---- ssh -------------------------------------------------------------------------------------

    def ssh_server(self):
        """An sshd of our own with keys of our own. \\return the ssh command that gets in."""
        for name in ('host_key', 'key'):
            self.check('ssh-keygen', '-q', '-t', 'ed25519', '-N', '', '-f', self.path(name))
        if os.getuid() == 0:
            os.makedirs('/run/sshd', exist_ok=True)  # it insists on that
        port = free_port()
        server = self.path('sshd_config', '\n'.join((
            'Port %d' % port, 'ListenAddress 127.0.0.1', 'HostKey ' + self.path('host_key'),
            'PidFile none', 'AuthorizedKeysFile ' + self.path('key.pub'), 'StrictModes no',
            'UsePAM no', 'PasswordAuthentication no', '')))
        client = self.path('ssh_config', '\n'.join((
            'Host *', 'Port %d' % port, 'IdentityFile ' + self.path('key'), 'IdentitiesOnly yes',
            'StrictHostKeyChecking no', 'UserKnownHostsFile ' + self.path('known_hosts'),
            'BatchMode yes', 'LogLevel ERROR', '')))
        self.start(shutil.which('sshd'), '-D', '-e', '-f', server)
        self.wait_until(lambda: listens(port), 'sshd')
        return 'ssh -F ' + client

    def test_parallel_over_ssh(self):
        self.need('parallel', 'sshd', 'ssh', 'ssh-keygen')
        ssh = self.ssh_server()
        self.check('parallel', '--ssh', ssh, '--sshlogin', '2/127.0.0.1', '--arg-file',
                   self.job_list(*self.GRID), '{}')
        self.all_done()

    # ---- Slurm -----------------------------------------------------------------------------------

    def cluster(self):
        """A controller, a node and what they sign with, all here. \\return environment."""
        for folder in ('munge', 'state', 'spool'):
            os.mkdir(self.path(folder))
        with open(self.path('munge/key'), 'wb') as file:
            file.write(os.urandom(128))
        os.chmod(self.path('munge/key'), 0o600)
        own = ['--%s=%s' % (name, self.path('munge/' + name.split('-')[0]))
               for name in ('key-file', 'pid-file', 'seed-file', 'log-file', 'socket')]
        self.start('munged', '--foreground', '--force', *own)
        self.wait_until(lambda: os.path.exists(self.path('munge/socket')), 'munged')
        host = socket.gethostname().split('.')[0]
        control = free_port()
        config = self.path('slurm.conf', '\n'.join((
            'ClusterName=test', 'SlurmctldHost=%s(127.0.0.1)' % host,
            'SlurmUser=' + getpass.getuser(), 'SlurmdUser=' + getpass.getuser(),
            'SlurmctldPort=%d' % control, 'SlurmdPort=%d' % free_port(),
            'AuthType=auth/munge', 'AuthInfo=socket=' + self.path('munge/socket'),
            'StateSaveLocation=' + self.path('state'), 'SlurmdSpoolDir=' + self.path('spool'),
            'SlurmctldPidFile=' + self.path('slurmctld.pid'),
            'SlurmdPidFile=' + self.path('slurmd.pid'),
            'ProctrackType=proctrack/linuxproc', 'TaskPlugin=task/none', 'MpiDefault=none',
            'SwitchType=switch/none', 'SelectType=select/linear', 'ReturnToService=2',
            'AccountingStorageType=accounting_storage/none',
            'JobAcctGatherType=jobacct_gather/none',
            'NodeName=%s NodeAddr=127.0.0.1 CPUs=1 State=UNKNOWN' % host,
            'PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP', '')))
        environment = {**os.environ, 'SLURM_CONF': config}
        for name in ('slurmctld', 'slurmd'):
            self.start(name, '-D', '-f', config, env=environment)
        self.wait_until(lambda: 'idle' in subprocess.run(
            ['sinfo', '--noheader', '--format=%T'], capture_output=True, text=True,
            env=environment).stdout, 'the node')
        return environment

    def test_slurm_array(self):
        self.need('munged', 'slurmctld', 'slurmd', 'sbatch')
        environment = self.cluster()
        script = os.path.join(ROOT, 'scripts', 'sweep.sbatch')
        self.check('sbatch', '--wait', '--array=1-4', script, self.job_list(*self.GRID),
                   env=environment, cwd=self.folder.name)
        self.all_done()

    def test_a_task_that_the_list_does_not_have(self):
        script = os.path.join(ROOT, 'scripts', 'sweep.sbatch')
        for task, says in (('5', 'no line 5'), (None, 'array')):
            environment = {key: value for key, value in os.environ.items() if 'SLURM' not in key}
            if task:
                environment['SLURM_ARRAY_TASK_ID'] = task
            result = subprocess.run(['sh', script, self.path('jobs.txt', 'true\n')], text=True,
                                    capture_output=True, env=environment)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(says, result.stderr)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'sweep_recipes_test', RecipesTest)
