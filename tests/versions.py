"""closecall with each SUMO of PyPI from 1.20 on: the same conflicts through whatever reads the road users.

    make versions [VERSIONS="oldest 1.24.0 newest"]

Each SUMO has a folder of its own in target/versions. A scenario is run three times: by `closecall run`, by a script
with a Checker, and by one that must use Python's getters. Their logs must be equal, to the byte; and a replay of what
SUMO wrote must find the same conflicts. A version that compiled.rs does not name must be read through Python.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from conftest import NETS, closecall_apart, python, rows
from recordings import record, replay, same

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "target" / "versions"
SCENES = {"reckless": "900", "left_turn": "900"}
"""With times in s by which all road users have left."""
FIRST = (1, 20)
THROUGH = {"Interface": "libsumo", "Behind": "direct"}

ATTACHED = """
import sys
import libsumo
from libsumo import _libsumo
import closecall

config, out, end, through = sys.argv[1:]
if through == "python":
    _libsumo.__file__ = "/nowhere/_libsumo.so"
libsumo.start(["sumo", "-c", config, "--end", end, "--no-warnings"])
checker = closecall.Checker(libsumo, out=out)
libsumo.addStepListener(checker)
while libsumo.simulation.getMinExpectedNumber() > 0 and libsumo.simulation.getTime() < float(end):
    libsumo.simulationStep()
checker.close()
libsumo.close()
print(_libsumo.simulation_getVersion()[1], checker.getters, sep="\\n")
"""


def available() -> list[str]:
    """The versions of libsumo for this interpreter, the oldest first."""
    asked = pip("index", "versions", "libsumo")
    (line,) = re.findall(r"Available versions: (.*)", asked)
    versions = sorted(line.split(", "), key=numbers)
    return [version for version in versions if numbers(version) >= FIRST]


def numbers(version: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", version))


def verified() -> dict[str, str]:
    """What compiled.rs says that each version is read through."""
    text = (ROOT / "bridge/src/sumo/compiled.rs").read_text(encoding="utf-8")
    found = re.findall(r'\("SUMO (\S+)", Verified::(\w+)\)', text)
    return {version: THROUGH[depth] for version, depth in found}


def pip(*words: str) -> str:
    done = subprocess.run([sys.executable, "-m", "pip", *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return done.stdout


def install(version: str) -> Path:
    """The folder with this version of libsumo."""
    folder = FOLDER / version
    if not folder.exists():
        names = [f"{name}=={version}" for name in ("libsumo", "traci", "sumolib")]
        part = folder.with_suffix(".part")
        shutil.rmtree(part, ignore_errors=True)
        pip("install", "--quiet", "--no-deps", "--no-compile", "--target", str(part), *names)
        part.rename(folder)
    return folder


def check(version: str, scene: str, out: Path) -> tuple[str, int, str]:
    """What the version was read through, the number of conflicts, and what is wrong."""
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(NETS / scene, out / scene, ignore=shutil.ignore_patterns("expected"))
    config = out / scene / f"{scene}.sumocfg"
    end = SCENES[scene]
    try:
        recording = record(config, "fcd.xml", "--end", end, sumo=("--no-warnings",), run=closecall_apart)
    except AssertionError as error:
        return "", 0, f"closecall run: {error}".strip()
    logs = {"closecall run": config.parent / "live"}
    through = []
    for asked in ("own", "python"):
        logs[asked] = out / asked
        done = python(ATTACHED, config, out / asked, end, asked)
        if done.returncode != 0:
            return "", 0, done.stderr.strip().splitlines()[-1]
        name, read = done.stdout.splitlines()[-2:]
        if name != f"SUMO {version}":
            return read, 0, f"{name} was loaded"
        through.append(read)
    expected = verified().get(version, "python")
    conflicts = rows(logs["python"] / "conflicts.csv")
    texts = {name: (log / "conflicts.csv").read_bytes() for name, log in logs.items()}
    wrong = [f"{name} differs" for name, text in texts.items() if text != texts["python"]]
    if through != [expected, "python"]:
        wrong.append(f"read through {through[0]}, not {expected}")
    status, message = replay(config, recording, out / "replayed")
    try:
        assert status == 0, message
        same(rows(logs["closecall run"] / "conflicts.csv"), rows(out / "replayed" / "conflicts.csv"))
    except AssertionError as error:
        wrong.append(f"replay differs {error}".split("\n")[0])
    return through[0], len(conflicts), "; ".join(wrong)


def main() -> int:
    """Print the table; returns 1 if a version gives other conflicts, or is read through what it should not be."""
    every = available()
    places = {"oldest": 0, "newest": -1}
    asked = [every[places[word]] if word in places else word for word in sys.argv[1:]] or every
    print(
        f"{'SUMO':8}  {'read through':12}  " + "  ".join(f"{f'{scene}, conflicts':20}" for scene in SCENES) + "  equal"
    )
    failed = False
    path = os.environ.get("PYTHONPATH", "")
    for version in asked:
        os.environ["PYTHONPATH"] = os.pathsep.join([str(install(version)), path])
        found = [check(version, scene, FOLDER / f"{version}-{scene}") for scene in SCENES]
        wrong = "; ".join(f"{scene}: {wrong}" for scene, (_, _, wrong) in zip(SCENES, found) if wrong)
        through = " ".join(sorted({through for through, _, _ in found}))
        counts = "  ".join(f"{count:20}" for _, count, _ in found)
        print(f"{version:8}  {through:12}  {counts}  {wrong or 'yes'}", flush=True)
        failed = failed or bool(wrong)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
