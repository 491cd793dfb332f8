"""Alarms as they come, one JSON object per line, for a dashboard or another program.

    python examples/live.py town.sumocfg | jq -c 'select(.severity == "critical")'
    python examples/live.py town.sumocfg --http 8080        # curl -N localhost:8080, or fetch() in a browser
    python examples/live.py --connect 8813                  # beside the client that drives a co-simulation

`event` is "alarm" when a conflict opens, "conflict" when it is settled, with the columns of the log, and "end" at last,
also after Ctrl-C. For --connect start SUMO with `--remote-port 8813 --num-clients 2`; the other client calls
`setOrder(1)`. It ends with SUMO, or when the road users that came have left.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import redirect_stdout, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import closecall
from traci.exceptions import FatalTraCIError

# Which of several TraCI clients this one is: those before it have made their changes to a step.
LAST = 2


class Stream:
    """The lines so far, printed or served; a reader that comes later gets the earlier ones, too."""

    def __init__(self, port: int | None) -> None:
        self.lines: list[bytes] = []
        self.has_ended = False
        self.changed = threading.Condition()
        self.server = None if port is None else Server(self, port)

    def send(self, event: str, **values: Any) -> None:
        line = json.dumps({"event": event, **values}, allow_nan=False)
        if self.server is None:
            print(line, flush=True)
            return
        with self.changed:
            self.lines.append(line.encode() + b"\n")
            self.changed.notify_all()

    def read(self) -> Iterator[bytes]:
        """The lines from the first on, each as it comes, until the last."""
        read = 0
        while True:
            with self.changed:
                while read == len(self.lines):
                    if self.has_ended:
                        return
                    self.changed.wait()
            yield self.lines[read]
            read += 1

    def close(self) -> None:
        """Lets the readers read to the end."""
        if self.server is not None:
            with self.changed:
                self.has_ended = True
                self.changed.notify_all()
            self.server.shutdown()
            self.server.server_close()


class Server(ThreadingHTTPServer):
    """Serves the lines to any number of readers on this machine."""

    daemon_threads = False

    def __init__(self, stream: Stream, port: int) -> None:
        class Reader(BaseHTTPRequestHandler):
            # One that has stopped reading holds up the end no longer, in s.
            timeout = 10

            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "application/x-ndjson")
                self.send_header("Access-Control-Allow-Origin", "*")
                self.end_headers()
                with suppress(OSError):  # the reader has left
                    for line in stream.read():
                        self.wfile.write(line)

            def log_message(self, *_: Any) -> None:
                pass

        super().__init__(("localhost", port), Reader)
        threading.Thread(target=self.serve_forever).start()


def values(found: closecall.Alarm | closecall.Conflict) -> dict[str, Any]:
    """What is known of an alarm or a conflict."""
    named = {name: getattr(found, name) for name in dir(found) if not name.startswith("_")}
    return {name: value for name, value in named.items() if value is not None}


def watch(sumo: Any, stream: Stream, end: float, waits: bool) -> None:
    """Steps the simulation to its end, and sends what happens; `waits` for road users that the other client inserts."""
    checker = closecall.Checker(
        sumo,
        paint=False,
        keep=0,
        on_alarm=lambda alarm: stream.send("alarm", **values(alarm)),
        on_conflict=lambda conflict: stream.send("conflict", **values(conflict)),
    )
    sumo.addStepListener(checker)
    is_over = threading.Event()

    def stop(*_: Any) -> None:
        """Ends after this step, whose lines are whole; a second Ctrl-C does not wait for the other client's step."""
        is_over.set()
        signal.signal(signal.SIGINT, signal.default_int_handler)

    signal.signal(signal.SIGINT, stop)
    try:
        while (
            not is_over.is_set()
            and sumo.simulation.getTime() < end
            and (waits or sumo.simulation.getMinExpectedNumber() > 0)
        ):
            sumo.simulationStep()
            waits = waits and sumo.simulation.getMinExpectedNumber() == 0
    except (KeyboardInterrupt, FatalTraCIError):
        pass
    checker.close()
    stream.send("end", time=checker.time, steps=checker.summary["steps"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", nargs="?")
    parser.add_argument("--connect", type=int, metavar="PORT", help="watch the SUMO that listens there")
    parser.add_argument("--http", type=int, metavar="PORT", help="serve the lines there instead of printing them")
    parser.add_argument("--end", type=float, default=float("inf"), help="simulated second at which to stop watching")
    arguments = parser.parse_args()
    if (arguments.scenario is None) == (arguments.connect is None):
        parser.error("name a scenario, or --connect")
    if arguments.connect is None:
        with redirect_stdout(sys.stderr):  # libsumo says there what it thinks of pyarrow
            import libsumo as sumo

        sumo.start(["sumo", "-c", arguments.scenario, "--no-warnings", "--no-step-log"])
    else:
        import traci

        sumo = traci.connect(arguments.connect)
        sumo.setOrder(LAST)
    stream = Stream(arguments.http)
    try:
        watch(sumo, stream, arguments.end, waits=arguments.connect is not None)
    except BrokenPipeError:
        # The reader has seen enough, as head has; Python would complain of it at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    finally:
        stream.close()
        with suppress(FatalTraCIError):
            sumo.close()


if __name__ == "__main__":
    main()
