"""A virtual screen with rviz, for tests: takes pictures of it and moves its mouse."""
import os
import shutil
import subprocess
import tempfile

import numpy

from polling import wait_until  # of test/ros

WIDTH, HEIGHT = 1000, 800
RVIZ_NODE = 'viewer'  # name of its node; the test's own is 'rviz'
NEEDED = {'Xvfb': 'xvfb', 'xdotool': 'xdotool', 'import': 'imagemagick', 'rviz': 'rviz'}


def missing_requirement():
    """Names a program or library that these tests need and do not find; empty if all are there."""
    for program, package in NEEDED.items():
        if shutil.which(program) is None:
            return 'not installed: %s (Debian: %s)' % (program, package)
    libraries = [os.path.join(prefix, 'lib', 'libcloth_rviz.so')
                 for prefix in os.environ['CMAKE_PREFIX_PATH'].split(':')]
    if not any(os.path.exists(library) for library in libraries):
        return 'the rviz plugin is not built: install librviz-dev and qtbase5-dev'
    return ''


class Screen:
    """Xvfb on a free display number, drawn by software. It keeps running when rviz, its last client,
    closes, so that the next rviz finds a display at once."""

    def __init__(self):
        reader, writer = os.pipe()
        self.xvfb = subprocess.Popen(
            ['Xvfb', '-displayfd', str(writer), '-screen', '0', '%dx%dx24' % (WIDTH, HEIGHT),
             '-nolisten', 'tcp', '-noreset'], pass_fds=[writer], stderr=subprocess.DEVNULL)
        os.close(writer)
        with os.fdopen(reader) as pipe:
            number = pipe.readline().strip()  # '' if the server ended before it was ready
        if not number:
            raise AssertionError('Xvfb did not start')
        self.environment = dict(os.environ, DISPLAY=':' + number, LIBGL_ALWAYS_SOFTWARE='1',
                                QT_X11_NO_MITSHM='1')
        self.rviz = None
        self.config = None  # text of rviz's config file; None if another command started rviz
        self.folder = tempfile.mkdtemp()

    def close(self):
        self.close_rviz()
        self.xvfb.terminate()
        self.xvfb.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def open_rviz(self, config):
        """Starts rviz with the text of a config file, unless it is running with this text already."""
        if self.rviz is not None and self.config == config:
            return
        path = os.path.join(self.folder, 'test.rviz')
        with open(path, 'w') as file:
            file.write(config)
        self.open(['rviz', '-d', path, '__name:=' + RVIZ_NODE])
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
        """Ends rviz like a crash: it cannot unregister from the master."""
        self.rviz.kill()
        self.rviz.wait()
        self.close_rviz()

    def picture(self):
        """The screen as an array of red, green and blue, shape (HEIGHT, WIDTH, 3)."""
        if self.rviz.poll() is not None:
            self.log.seek(0)
            raise AssertionError('rviz ended with status %s:\n%s' %
                                 (self.rviz.returncode, self.log.read()[-2000:]))
        raw = subprocess.run(['import', '-silent', '-window', 'root', '-depth', '8', 'rgb:-'],
                             env=self.environment, stdout=subprocess.PIPE, check=True).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(HEIGHT, WIDTH, 3).astype(int)

    def save(self, path):
        """Saves the screen in the folder that the environment variable CLOTH_SIM_SHOTS names, if it
        is set, for people to look at."""
        folder = os.environ.get('CLOTH_SIM_SHOTS')
        if folder:
            subprocess.run(['import', '-silent', '-window', 'root', os.path.join(folder, path)],
                           env=self.environment, check=True)

    def mouse(self, *commands):
        subprocess.run(['xdotool'] + [str(word) for word in commands], env=self.environment,
                       check=True)

    def drag(self, points):
        """Presses the left button at the first point and moves along the others."""
        self.mouse('mousemove', *points[0])
        self.mouse('mousedown', 1)
        for point in points[1:]:
            self.mouse('mousemove', *point)

    def release(self):
        self.mouse('mouseup', 1)


def is_near(picture, colour, tolerance=12):
    """A mask of the pixels whose parts differ from those of a colour by at most `tolerance`."""
    return (abs(picture - numpy.array(colour)) <= tolerance).all(axis=2)


def view_of(screen, background):
    """The 3D view as (left, top, right, bottom) in pixels, found by its background colour. Waits
    until it is drawn."""
    def found():
        ys, xs = numpy.nonzero(is_near(screen.picture(), background, 2))
        if len(xs) < 0.1 * WIDTH * HEIGHT:
            return None
        return xs.min(), ys.min(), xs.max() + 1, ys.max() + 1
    return wait_until(found, 'the 3D view of rviz', deadline=120.0)
