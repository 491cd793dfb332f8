"""Starting SUMO through libsumo, with its error messages caught, so that the command can report them in one line."""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import IO, Any

GUI_SETTINGS = Path(__file__).with_name("gui-settings.xml")

WINDOW_SIZE = "1200,800"
"""In pixels: it fits on the screen of a small laptop."""

VIEW_OPENS_WITHIN = 10.0
"""In s: a busy machine takes several."""

UNUSED = ("numpy", "lxml", "importlib.metadata")
"""Optional imports of libsumo and its sumolib that closecall does not need. They cost 0.1 s of each run and numpy's
threads."""

NO_CLIENT = ("--remote-port", "0")
"""With a configuration made for TraCI libsumo would wait for a client for ever."""


def start(words: list[str], gui: bool) -> Any:
    """Start SUMO with the arguments of its command line and return the module libsumo.

    Raises:
        ImportError: libsumo is not installed.
        RuntimeError: SUMO refuses, with its own message.
    """
    libsumo = import_libsumo()
    command = ["sumo-gui", "--start", "--quit-on-end", *window_size(words), *gui_settings(words)] if gui else ["sumo"]
    with caught_stderr() as caught:
        try:
            libsumo.start([*command, *NO_CLIENT, *words])
        except (libsumo.TraCIException, libsumo.exceptions.FatalTraCIError, RuntimeError) as error:
            caught.seek(0)
            raise RuntimeError(first_error(caught.read()) or str(error)) from error
    if gui:
        wait_for_view(libsumo)
    return libsumo


def wait_for_view(libsumo: Any) -> None:
    """Wait until the window can be asked for what it shows: sumo-gui opens it in a thread of its own."""
    end = time.monotonic() + VIEW_OPENS_WITHIN
    while not libsumo.gui.getIDList() and time.monotonic() < end:
        time.sleep(0.01)


def import_libsumo() -> Any:
    """Import libsumo without its optional imports, and without its warning about an installed pyarrow.

    Raises:
        ImportError: it is not installed.
    """
    with redirect_stdout(io.StringIO()):
        try:
            with without(*UNUSED):
                import libsumo
        except ImportError:
            # Another version of libsumo may need these imports.
            import libsumo
    return libsumo


def has_display() -> bool:
    """Whether there is a display: without one sumo-gui ends the whole process without a message."""
    if sys.platform in ("win32", "darwin"):
        return True
    display = os.environ.get("DISPLAY", "")
    local = re.match(r":(\d+)", display)
    return bool(display) and (local is None or Path(f"/tmp/.X11-unix/X{local.group(1)}").exists())


def wait_for_user() -> None:
    """Keep the window open until the user presses Enter; without a terminal, return at once."""
    if sys.stdin is not None and sys.stdin.isatty():
        input("the run is over; Enter closes sumo-gui: ")


def close(gui: bool) -> None:
    """Close SUMO.

    sumo-gui 1.28 did not close in 21 of 21 tries some time after its last step or with a delay set, and in 1 of 21
    tries right after a step. Hence one more step here; the caller must still end a process that does not close.
    """
    import libsumo

    if gui:
        libsumo.simulationStep()
    libsumo.close()


def convert_net(net: Path, within: list[float], to: Path) -> None:
    """Write the part of a net within low x, low y, high x and high y as OpenDRIVE.

    Raises:
        RuntimeError: netconvert is not there, or refuses, with its own message.
    """
    places = [str(Path(sys.executable).parent), str(Path(os.environ.get("SUMO_HOME", "")) / "bin")]
    netconvert = shutil.which("netconvert", path=os.pathsep.join([*places, os.environ.get("PATH", "")]))
    if netconvert is None:
        raise RuntimeError("SUMO's netconvert, which writes OpenDRIVE, is not there: pip install eclipse-sumo")
    boundary = ",".join(str(corner) for corner in within)
    words = ["--sumo-net-file", str(net), "--keep-edges.in-boundary", boundary, "--opendrive-output", str(to)]
    done = subprocess.run([netconvert, *words], capture_output=True, text=True, errors="replace", check=False)
    if done.returncode != 0:
        raise RuntimeError(f"netconvert says: {first_error(done.stderr) or f'status {done.returncode}'}")


def gui_settings(words: list[str]) -> list[str]:
    """The options for settings that show painted colours, unless the user has settings of their own."""
    has_own = any(word.startswith(("-g", "--gui-settings-file")) for word in words)
    has_own = has_own or re.search(r"<(gui-settings-file|g)\b", configuration(words)) is not None
    return [] if has_own else ["--gui-settings-file", str(GUI_SETTINGS)]


def window_size(words: list[str]) -> list[str]:
    """The options for a window in which a junction can be seen, unless the user has a size of their own."""
    has_own = any(word.startswith("--window-size") for word in words) or "<window-size" in configuration(words)
    return [] if has_own else ["--window-size", WINDOW_SIZE]


def configuration(words: list[str]) -> str:
    """The text of the configuration that the words name; empty where they name none."""
    return Path(words[words.index("-c") + 1]).read_text(errors="replace") if "-c" in words else ""


def first_error(text: str) -> str:
    """The first error that SUMO reported, in one line, without the lines that only say that it quits."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    at = next((number for number, line in enumerate(lines) if line.startswith("Error:")), None)
    if at is None:
        return ""
    message = [lines[at].removeprefix("Error:").strip()]
    for line in lines[at + 1 :]:
        if line.startswith(("Error:", "Warning:", "Quitting")):
            break
        message.append(line)
    return " ".join(message)


@contextmanager
def without(*modules: str) -> Iterator[None]:
    """Make imports of these modules fail meanwhile, except of those already imported."""
    blocked = [module for module in modules if module not in sys.modules]
    sys.modules.update(dict.fromkeys(blocked))  # type: ignore[arg-type]
    try:
        yield
    finally:
        for module in blocked:
            del sys.modules[module]


@contextmanager
def caught_stderr() -> Iterator[IO[str]]:
    """Redirect standard error of the whole process, SUMO's C++ included, to a file; on success print it afterwards."""
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile("w+", errors="replace") as caught:
        os.dup2(caught.fileno(), 2)
        try:
            yield caught
        except BaseException:
            os.dup2(kept, 2)
            raise
        else:
            os.dup2(kept, 2)
            caught.seek(0)
            sys.stderr.write(caught.read())
        finally:
            os.close(kept)
