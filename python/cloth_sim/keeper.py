"""Runs a program until its standard input ends, and then ends the program.

`python3 keeper.py PROGRAM ARGUMENT...`: whoever starts this holds the other end of the pipe, so
that the program ends with it, however that ends. The exit status is the program's.
"""
import os
import subprocess
import sys
import threading

PATIENCE = 5.0  # from the request to end until the program is killed [s]


def end_with_input(child):
    while os.read(sys.stdin.fileno(), 4096):
        pass
    child.terminate()
    try:
        child.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        child.kill()


def main():
    child = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL)
    threading.Thread(target=end_with_input, args=(child,), daemon=True).start()
    status = child.wait()
    os._exit(status if status >= 0 else 128 - status)  # the thread still reads


if __name__ == '__main__':
    main()
