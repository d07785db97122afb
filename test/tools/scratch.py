"""Helpers of the tests of programs: the paths of the programs, and a temporary folder."""
import os
import subprocess
import tempfile
import unittest


def find_program(name):
    """The path of a program of this package."""
    return subprocess.check_output(
        ['catkin_find', '--first-only', '--libexec', 'cloth_sim', name], text=True).strip()


def processes(text):
    """The numbers of all processes whose command has a text."""
    found = set()
    for number in filter(str.isdigit, os.listdir('/proc')):
        try:
            with open('/proc/%s/cmdline' % number, errors='replace') as file:
                if text in file.read():
                    found.add(int(number))
        except OSError:  # it has ended
            pass
    return found


class ScratchTest(unittest.TestCase):
    """A test with a temporary folder, which is removed after it."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name, text=None):
        """The path of a file in the temporary folder; with a text, the file is written."""
        path = os.path.join(self.folder.name, name)
        if text is not None:
            with open(path, 'w') as file:
                file.write(text)
        return path
