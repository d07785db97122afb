#!/usr/bin/python3
"""Inputs and outputs of cloth_run that are no regular files, and disks that are full."""
import os
import resource
import signal
import stat
import subprocess
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch import ScratchTest, find_program  # noqa: E402

CLOTH_RUN = find_program('cloth_run')
SCENE = 'cloth: {size: [0.2, 0.2], particles: [9, 9], pins: [corner_00]}\n'
OUTPUTS = ('--summary', '--save-state', '--bag')


class FilesTest(ScratchTest):
    def setUp(self):
        super().setUp()
        self.scene = self.path('scene.yaml', SCENE)

    def run_cloth(self, *arguments, expected=0, says='', **options):
        """Runs it; refusals must be one line."""
        result = subprocess.run(
            [CLOTH_RUN, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            timeout=60, **options)
        self.assertEqual(result.returncode, expected, result.stderr)
        lines = [line for line in result.stderr.splitlines() if 'real-time factor' not in line]
        self.assertEqual(len(lines), 0 if expected == 0 else 1, result.stderr)
        self.assertIn(says, result.stderr)

    def run_short(self, *arguments, **options):
        self.run_cloth(self.scene, '--duration', '0.05', *arguments, **options)

    def device(self, minor):
        """A character device: of our own where we may make one, so that an error here cannot
        destroy that of the machine. 3 is /dev/null, 5 /dev/zero, 7 /dev/full."""
        path = self.path('device%d' % minor)
        try:
            os.mknod(path, stat.S_IFCHR | 0o600, os.makedev(1, minor))
            with open(path, 'rb'):
                return path
        except OSError:
            if os.path.exists(path):
                os.remove(path)
            os.symlink({3: '/dev/null', 5: '/dev/zero', 7: '/dev/full'}[minor], path)
            return path

    def pipe(self):
        path = self.path('pipe')
        os.mkfifo(path)
        return path

    # ---- outputs ---------------------------------------------------------------------------------

    def test_a_device_is_written_into(self):
        null = self.device(3)
        before = os.lstat(null)
        self.run_short('--summary', null)
        self.run_short('--save-state', null)
        self.run_short('--bag', null, expected=2, says='is a character device')
        self.assertEqual(os.lstat(null).st_ino, before.st_ino)
        self.assertTrue(stat.S_ISCHR(os.stat(null).st_mode))

    def test_a_pipe_gets_the_output_and_its_end(self):
        pipe = self.pipe()
        with subprocess.Popen(['cat', pipe], stdout=subprocess.PIPE, text=True) as reader:
            try:
                # The reader may come later than a first run.
                while subprocess.run([CLOTH_RUN, self.scene, '--duration', '0.05', '--summary',
                                      pipe], capture_output=True, timeout=60).returncode == 2:
                    self.assertIsNone(reader.poll())
                text, _ = reader.communicate(timeout=60)
            finally:
                reader.kill()
        self.assertIn('"state_hash"', text)
        self.assertTrue(stat.S_ISFIFO(os.stat(pipe).st_mode))

    def test_a_pipe_without_a_reader_is_refused(self):
        pipe = self.pipe()
        for option in OUTPUTS:
            self.run_short(option, pipe, expected=2, says='is a pipe')
            self.assertTrue(stat.S_ISFIFO(os.stat(pipe).st_mode))

    def test_a_link_stays_a_link(self):
        for option in OUTPUTS:
            target, link = self.path('target' + option), self.path('link' + option)
            os.symlink(target, link)
            self.run_short(option, link)
            self.assertTrue(os.path.islink(link))
            self.assertGreater(os.path.getsize(target), 0)

    def test_what_cannot_be_written_is_refused_before_the_run(self):
        os.mkdir(self.path('folder'))
        before = sorted(os.listdir(self.folder.name))
        for option in OUTPUTS:
            for bad in ('', self.path('folder'), self.path('nowhere/x'), '/proc/x'):
                self.run_cloth(self.scene, '--duration', '1e6', option, bad, expected=2)
        self.assertEqual(sorted(os.listdir(self.folder.name)), before)

    def test_a_full_disk_is_one_line_and_leaves_nothing_behind(self):
        self.run_short('--summary', self.device(7), expected=1, says='No space left')
        with open('/dev/full', 'w') as full:
            result = subprocess.run(
                [CLOTH_RUN, self.scene, '--duration', '0.05', '--summary', '-'], stdout=full,
                stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(result.returncode, 1, result.stderr)
        for limit in (0, 1000, 20000):
            for option in ('--save-state', '--bag'):
                self.limited(limit, option)
        left = set(os.listdir(self.folder.name)) - {'scene.yaml', 'device7', 'a--bag.active'}
        self.assertEqual(left, set())

    def limited(self, limit, option):
        """A limit on the size of files stands for a full disk. Python ignores SIGXFSZ; a shell does
        not."""
        def limit_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        self.run_short(option, self.path('a' + option), expected=1, says='File too large',
                       preexec_fn=limit_files)

    def test_a_reader_that_goes_is_one_line(self):
        read, write = os.pipe()
        os.close(read)
        self.run_short('--summary', '/dev/fd/%d' % write, expected=1, says='Broken pipe',
                       pass_fds=[write])
        os.close(write)

    # ---- inputs ----------------------------------------------------------------------------------

    def test_inputs_are_regular_files(self):
        os.mkdir(self.path('folder'))
        huge = self.path('huge', '')
        os.truncate(huge, 1 << 40)
        for bad, says in ((self.path('folder'), 'is a directory'), (self.pipe(), 'is a pipe'),
                          (self.device(5), 'is a character device'), (huge, '')):
            self.run_cloth(bad, expected=2, says=says)
            self.run_short('--load-state', bad, expected=2, says=says)
            self.run_cloth('--replay', bad, expected=2, says=says)
            mesh = self.path('mesh.yaml', 'cloth: {obj: %s, fabric: cotton}\n' % bad)
            self.run_cloth(mesh, expected=2, says=says)
        self.run_cloth('', expected=2)
        self.run_short('--load-state', '', expected=2)
        self.run_cloth('--replay', '', expected=2)


if __name__ == '__main__':
    rosunit.unitrun('cloth_sim', 'files', FilesTest)
