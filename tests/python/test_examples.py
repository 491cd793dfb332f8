"""The examples in `examples/` with the real packages that they are for."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path
from typing import Any, Callable

import sumo
from conftest import NETS, TIMEOUT, closecall, rows, until
from sumolib.miscutils import getFreeSocketPort

EXAMPLES = NETS.parent / "examples"

Copy = Callable[[str], Path]

EPISODES = """
import json, sys
import near_misses
env = near_misses.NearMisses(near_misses.sumo_rl(*sys.argv[1:3], 100), weight=float(sys.argv[3]))
print(json.dumps([near_misses.episode(env), near_misses.episode(env)]))
env.close()
"""


def episodes(weight: float, **environment: str) -> Any:
    """Reward, cost and number of alarms of two episodes of sumo-rl with the same seed."""
    parts = [str(NETS / f"signals/signals.{kind}.xml") for kind in ("net", "rou")]
    done = subprocess.run(
        [sys.executable, "-c", EPISODES, *parts, str(weight)],
        cwd=EXAMPLES,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_sumo_rl_pays_for_near_misses_alike_through_traci_and_libsumo() -> None:
    free, again = episodes(0.0)
    paid = episodes(100.0)[0]
    assert free == again and free[1] > 0.0 < free[2]
    assert paid[1:] == free[1:] and abs(free[0] - paid[0] - 100.0 * free[1]) < 1e-6
    assert episodes(0.0, LIBSUMO_AS_TRACI="quiet")[0] == free


def live(*words: str | Path | int) -> subprocess.Popen[str]:
    """Start the stream of alarms."""
    command = [sys.executable, str(EXAMPLES / "live.py"), *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def ended(process: subprocess.Popen[str]) -> list[dict[str, Any]]:
    """The lines that are left in a stream, which ends by itself and without an error."""
    said, errors = process.communicate(timeout=TIMEOUT)
    assert process.returncode == 0 and "Traceback" not in errors, errors
    return [json.loads(line) for line in said.splitlines()]


def test_the_stream_has_the_conflicts_of_the_log(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("reckless")
    lines = ended(live(config, "--end", 120))
    assert closecall("run", config, "--end", "120", "--out", tmp_path / "log", "--quiet").returncode == 0
    settled = {(line["ego"], line["foe"], line["time"]) for line in lines if line["event"] == "conflict"}
    assert settled == {(row["ego"], row["foe"], float(row["time"])) for row in rows(tmp_path / "log/conflicts.csv")}
    assert [line["event"] for line in lines].index("alarm") == 0 and lines[-1]["event"] == "end"


def test_the_stream_ends_whole_at_ctrl_c_and_quietly_without_reader(scenario: Copy) -> None:
    config = scenario("town")
    for is_interrupted in (True, False):
        process = live(config)
        assert process.stdout is not None
        assert json.loads(process.stdout.readline())["event"] == "alarm"
        if is_interrupted:
            process.send_signal(signal.SIGINT)
            assert ended(process)[-1]["event"] == "end"
        else:
            process.stdout.close()
            assert process.wait(TIMEOUT) == 0
            assert process.stderr is not None and "Traceback" not in process.stderr.read()


def test_a_browser_reads_the_stream_from_its_first_line(scenario: Copy) -> None:
    config, port = scenario("left_turn"), getFreeSocketPort()
    served, printed = live(config, "--end", 200, "--http", port), live(config, "--end", 200)
    found: list[bytes] = []

    def reads() -> bool:
        try:
            with urllib.request.urlopen(f"http://localhost:{port}", timeout=TIMEOUT) as answer:
                found.extend(answer)
        except OSError:
            assert served.poll() is None, "it ended before anybody read"
        return bool(found)

    until(reads)
    assert ended(served) == [] and [json.loads(line) for line in found] == ended(printed)


def test_a_second_client_watches_a_co_simulation(scenario: Copy) -> None:
    config, port = scenario("left_turn"), getFreeSocketPort()
    alone = ended(live(config))
    words = ["--remote-port", str(port), "--num-clients", "2", "--no-step-log", "--no-warnings"]
    program = Path(sumo.SUMO_HOME, "bin", "sumo")
    drive = (
        "import sys, traci\n"
        "connection = traci.connect(int(sys.argv[1]))\n"
        "connection.setOrder(1)\n"
        "while connection.simulation.getMinExpectedNumber() > 0: connection.simulationStep()\n"
        "connection.close()\n"
    )
    with (
        subprocess.Popen([program, "-c", config, *words], stdout=subprocess.DEVNULL) as simulation,
        subprocess.Popen([sys.executable, "-c", drive, str(port)], stdout=subprocess.DEVNULL) as driver,
    ):
        assert ended(live("--connect", port)) == alone
        assert driver.wait(TIMEOUT) == simulation.wait(TIMEOUT) == 0
