#!/usr/bin/python3
"""Saves the screen at given moments of a running cloth_node; see rviz_photo.sh.

usage: photograph.py --size WxH --out DIR PHASE[+SECONDS]...

Of a scene without phases, +SECONDS counts from its start.
"""
import argparse
import subprocess
import sys
import time

import rospy

from cloth_sim.msg import ClothState
from cloth_sim.srv import GetState, Pause

DEADLINE = 600.0  # for the whole run [s]


class Watcher:
    def __init__(self):
        self.state = None
        self.started = {}  # phase: simulated time at which it was first seen [s]
        rospy.Subscriber('/cloth/state', ClothState, self.on_state, queue_size=5)

    def on_state(self, message):
        self.started.setdefault(message.phase, message.time)
        self.state = message

    def reached(self, phase, later):
        if self.state is None or phase not in self.started:
            return False
        return self.state.time >= self.started[phase] + later


def wait(until, deadline, what):
    while not until():
        if time.monotonic() > deadline:
            sys.exit(f'error: waited too long for {what}')
        if rospy.is_shutdown():
            sys.exit(f'error: the run ended before {what}')
        time.sleep(0.05)


def window_shown():
    """Whether rviz has subscribed to markers, and so draws the scene."""
    import rosgraph
    subscribers = rosgraph.Master('/photograph').getSystemState()[1]
    return any(topic in ('/cloth/markers', '/cloth/scene_markers') and names
               for topic, names in subscribers)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--size', required=True)
    parser.add_argument('--out', required=True)
    parser.add_argument('moments', nargs='+')
    args = parser.parse_args()

    deadline = time.monotonic() + DEADLINE
    rospy.init_node('photograph', anonymous=True, disable_signals=True)
    watcher = Watcher()
    for service in ('/cloth/pause', '/cloth/get_state'):  # offered one after the other
        rospy.wait_for_service(service, timeout=60)
    pause = rospy.ServiceProxy('/cloth/pause', Pause)
    phases = rospy.ServiceProxy('/cloth/get_state', GetState)().phases
    for moment in args.moments:
        phase = moment.partition('+')[0]
        if phase not in (phases or ['']):
            sys.exit(f"error: --at {moment}: expected PHASE or PHASE+SECONDS, of the phases "
                     f"{', '.join(phases)}" if phases else
                     f'error: --at {moment}: expected +SECONDS, the scene has no phases')
    wait(window_shown, deadline, 'rviz')
    time.sleep(3.0)  # until its window is drawn
    pause(False)
    for moment in args.moments:
        phase, _, later = moment.partition('+')
        wait(lambda: watcher.reached(phase, float(later or 0)), deadline, moment)
        pause(True)
        time.sleep(1.5)  # until rviz has drawn the newest frame
        # The name of the phase alone, unless there are several pictures of it.
        several = [m.partition('+')[0] for m in args.moments].count(phase) > 1
        path = f'{args.out}/rviz_{(moment if several else phase) or "start"}.png'
        subprocess.run(['import', '-silent', '-window', 'root', '-trim', '+repage', path],
                       check=True)
        print(f'== wrote {path} (t = {watcher.state.time:.2f} s)', flush=True)
        pause(False)


if __name__ == '__main__':
    main()
