"""A virtual screen with rviz on it, for tests: what it shows, and a mouse that clicks on it."""
import os
import shutil
import subprocess
import sys
import tempfile

import numpy

from polling import wait_until  # of test/ros

WIDTH, HEIGHT = 1000, 800
NEEDED = {'Xvfb': 'xvfb', 'xdotool': 'xdotool', 'import': 'imagemagick', 'rviz': 'rviz'}


def what_is_missing():
    """What these tests stand on and is not there, and what to do about it; empty if all is."""
    for program, package in NEEDED.items():
        if shutil.which(program) is None:
            return 'no %s: install %s' % (program, package)
    libraries = [os.path.join(prefix, 'lib', 'libcloth_rviz.so')
                 for prefix in os.environ['CMAKE_PREFIX_PATH'].split(':')]
    if not any(os.path.exists(library) for library in libraries):
        return 'the rviz plugin is not built: install librviz-dev and qtbase5-dev'
    return ''


def record_skipped(name, why):
    """Says on the terminal and in the JUnit file that a test was skipped: rosunit would count it as
    passed."""
    print('%s: skipped: %s' % (name, why), file=sys.stderr)
    option = '--gtest_output=xml:'
    for path in [word[len(option):] for word in sys.argv if word.startswith(option)]:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w') as file:
            file.write('<?xml version="1.0" encoding="utf-8"?>\n'
                       '<testsuite name="%s" tests="1" errors="0" failures="0" skipped="1">'
                       '<testcase classname="%s" name="all" time="0"><skipped message="%s"/>'
                       '</testcase></testsuite>\n' % (name, name, why))


class Screen:
    """Xvfb on a free display number, drawn by software. It does not start anew when rviz, its last
    client, closes: the next rviz would find no display for a moment."""

    def __init__(self):
        reader, writer = os.pipe()
        self.xvfb = subprocess.Popen(
            ['Xvfb', '-displayfd', str(writer), '-screen', '0', '%dx%dx24' % (WIDTH, HEIGHT),
             '-nolisten', 'tcp', '-noreset'], pass_fds=[writer], stderr=subprocess.DEVNULL)
        os.close(writer)
        with os.fdopen(reader) as pipe:
            number = pipe.readline().strip()  # comes when the screen is there; '' if it never is
        if not number:
            raise AssertionError('Xvfb did not start')
        self.environment = dict(os.environ, DISPLAY=':' + number, LIBGL_ALWAYS_SOFTWARE='1',
                                QT_X11_NO_MITSHM='1')
        self.rviz = None
        self.config = None  # of rviz, as far as it is known
        self.folder = tempfile.mkdtemp()

    def close(self):
        self.close_rviz()
        self.xvfb.terminate()
        self.xvfb.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def open_rviz(self, config):
        """Has rviz run with the text of a config file, afresh unless it does already."""
        if self.rviz is not None and self.config == config:
            return
        path = os.path.join(self.folder, 'test.rviz')
        with open(path, 'w') as file:
            file.write(config)
        self.open(['rviz', '-d', path])
        self.config = config

    def open(self, command, **variables):
        """Starts a command that becomes rviz, with some environment variables of its own."""
        self.close_rviz()
        self.log = open(os.path.join(self.folder, 'rviz.log'), 'w+')
        self.rviz = subprocess.Popen(command, env=dict(self.environment, **variables),
                                     stdout=self.log, stderr=subprocess.STDOUT)

    def close_rviz(self):
        if self.rviz is None:
            return
        self.rviz.terminate()
        try:
            self.rviz.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self.rviz.kill()
            self.rviz.wait()
        self.rviz = None
        self.config = None

    def kill_rviz(self):
        """As a crash would: it has no time to say goodbye."""
        self.rviz.kill()
        self.rviz.wait()
        self.close_rviz()

    def picture(self):
        """What is on the screen now: red, green and blue of every pixel."""
        if self.rviz.poll() is not None:
            self.log.seek(0)
            raise AssertionError('rviz ended with status %s:\n%s' %
                                 (self.rviz.returncode, self.log.read()[-2000:]))
        raw = subprocess.run(['import', '-silent', '-window', 'root', '-depth', '8', 'rgb:-'],
                             env=self.environment, stdout=subprocess.PIPE, check=True).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(HEIGHT, WIDTH, 3).astype(int)

    def save(self, path):
        """The same as a file, for people: left where CLOTH_SIM_SHOTS says, if it says."""
        folder = os.environ.get('CLOTH_SIM_SHOTS')
        if folder:
            subprocess.run(['import', '-silent', '-window', 'root', os.path.join(folder, path)],
                           env=self.environment, check=True)

    def mouse(self, *commands):
        subprocess.run(['xdotool'] + [str(word) for word in commands], env=self.environment,
                       check=True)

    def drag(self, points):
        """Presses the left button at the first point and takes it along; it stays down."""
        self.mouse('mousemove', *points[0])
        self.mouse('mousedown', 1)
        for point in points[1:]:
            self.mouse('mousemove', *point)

    def release(self):
        self.mouse('mouseup', 1)


def is_near(picture, colour, tolerance=12):
    """Which pixels have a colour, give or take some of each part."""
    return (abs(picture - numpy.array(colour)) <= tolerance).all(axis=2)


def view_of(screen, background):
    """The 3D view as (left, top, right, bottom), by its background; waits until it is drawn."""
    def found():
        ys, xs = numpy.nonzero(is_near(screen.picture(), background, 2))
        if len(xs) < 0.1 * WIDTH * HEIGHT:
            return None
        return xs.min(), ys.min(), xs.max() + 1, ys.max() + 1
    return wait_until(found, 'the 3D view of rviz', deadline=120.0)
