# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""An egomotion_node as a process of its own, with its log and its diagnostics."""

import pathlib
import signal
import subprocess
import tempfile
import threading
import time

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from roslib.packages import find_node


def catches(pid, number):
    """Whether a process has a handler for a signal."""
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("SigCgt:"):
            return bool(int(line.split()[1], 16) >> (number - 1) & 1)
    return False


def wait_for(condition, seconds):
    """By the wall clock: simulated time may stand still."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return bool(condition())


class EgoMotionProcess:
    """The node /NAME/egomotion; its parameters are set before it starts."""

    def __init__(self, name, parameters=None):
        self.name = f"/{name}/egomotion"
        for key, value in (parameters or {}).items():
            rospy.set_param(f"{self.name}/{key}", value)
        self.lock = threading.Lock()
        self.summary, self.values, self.worst_latency_ms = "", {}, 0.0
        self.subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, self.receive, queue_size=100)
        self.log_file = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(
            find_node("multicam_egomotion", "egomotion_node") + ["__name:=egomotion", f"__ns:=/{name}"],
            stdout=self.log_file, stderr=subprocess.STDOUT)

    def receive(self, message):
        for status in message.status:
            if self.name.strip("/") in status.name:
                with self.lock:
                    self.summary = status.message
                    self.values = {value.key: value.value for value in status.values}
                    self.worst_latency_ms = max(self.worst_latency_ms, float(self.values["latency worst [ms]"]))

    def log(self):
        self.log_file.flush()
        return pathlib.Path(f"/proc/self/fd/{self.log_file.fileno()}").read_text()

    def logs(self, text, seconds=10.0):
        return wait_for(lambda: text in self.log(), seconds)

    def says(self, text, seconds=10.0):
        return wait_for(lambda: text in self.summary, seconds)

    def catches_signals(self):
        return all(catches(self.process.pid, number) for number in (signal.SIGINT, signal.SIGTERM))

    def end(self, number=signal.SIGINT):
        """Exit code and seconds until the exit."""
        begin = time.monotonic()
        if self.process.poll() is None:
            self.process.send_signal(number)
        try:
            code = self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = self.process.wait()
        seconds = time.monotonic() - begin
        self.subscriber.unregister()
        return code, seconds
