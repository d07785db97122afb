"""What tests of programs share: where the programs are, and a folder of their own."""
import os
import subprocess
import tempfile
import unittest


def find_program(name):
    """Path of a program of this package."""
    return subprocess.check_output(
        ['catkin_find', '--first-only', '--libexec', 'cloth_sim', name], text=True).strip()


class ScratchTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name, text=None):
        """Of a file in the folder; with a text, one that has it."""
        path = os.path.join(self.folder.name, name)
        if text is not None:
            with open(path, 'w') as file:
                file.write(text)
        return path
