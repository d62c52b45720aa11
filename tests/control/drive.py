#!/usr/bin/python3
"""LinuxCNC's display, of which nobody looks: homes the axes and runs and records each program of the folder it is started in."""

import os
import subprocess
import time

import linuxcnc

FOLDER = os.environ["VPOST_RIG"]
LONGEST_S = 600


def wait(stat, done, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        stat.poll()
        if done(stat):
            return
        time.sleep(0.02)
    raise SystemExit("the control did not get there")


def main():
    command, stat, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
    for state in (linuxcnc.STATE_ESTOP_RESET, linuxcnc.STATE_ON):
        command.state(state)
        command.wait_complete()
    command.mode(linuxcnc.MODE_MANUAL)
    command.wait_complete()
    stat.poll()
    for joint in range(stat.joints):
        command.home(joint)
    wait(stat, lambda s: all(s.homed[: s.joints]), 10)
    for name in sorted(name for name in os.listdir(FOLDER) if name.endswith(".ngc")):
        stem = os.path.join(FOLDER, name[:-4])
        command.mode(linuxcnc.MODE_AUTO)
        command.wait_complete()
        command.program_open(stem + ".ngc")
        recorder = subprocess.Popen(["halsampler", "-t", stem + ".recorded"])
        time.sleep(0.2)
        command.auto(linuxcnc.AUTO_RUN, 0)
        wait(stat, lambda s: s.interp_state != linuxcnc.INTERP_IDLE, 5)
        wait(stat, lambda s: s.interp_state == linuxcnc.INTERP_IDLE and s.inpos, LONGEST_S)
        time.sleep(0.3)
        recorder.terminate()
        recorder.wait()
        error = errors.poll()
        with open(stem + ".ran", "w") as ran:
            ran.write("" if error is None else str(error[1]))


main()
