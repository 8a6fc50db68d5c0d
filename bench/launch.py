"""Runs a command and reports its exit code, wall seconds and peak memory.

usage: launch.py TIMEOUT REPORT.json COMMAND...

A program of its own because Linux counts the memory of the process that starts another into the
peak of the one that is started: this one is small. The command gets a session of its own, all of
which is killed when TIMEOUT seconds are over or the launcher is interrupted.
"""

import json
import os
import signal
import subprocess
import sys
import time


def main():
    timeout, report, command = float(sys.argv[1]), sys.argv[2], sys.argv[3:]

    def give_up(*_):
        raise TimeoutError

    signal.signal(signal.SIGALRM, give_up)
    signal.signal(signal.SIGTERM, give_up)
    start = time.perf_counter()
    process = subprocess.Popen(command, start_new_session=True)
    try:
        signal.setitimer(signal.ITIMER_REAL, timeout)
        _, status, usage = os.wait4(process.pid, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        code = os.waitstatus_to_exitcode(status)
        peak = usage.ru_maxrss / 1024
    except TimeoutError:
        os.killpg(process.pid, signal.SIGKILL)
        code, peak = None, None
    except KeyboardInterrupt:
        os.killpg(process.pid, signal.SIGKILL)
        raise
    seconds = time.perf_counter() - start
    process.returncode = -1  # it has been waited for
    with open(report, "w") as file:
        json.dump({"code": code, "seconds": seconds, "peak_mib": peak}, file)


main()
