"""What a recording's future and its noise allow: `--path driven` and `--smooth`."""

from __future__ import annotations

import random
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import closecall as api
import layouts
import pytest
from conftest import NETS, closecall, is_one_message, rows

Copy = Callable[[str], Path]


def test_driven_paths_are_the_same_from_every_format(scenario: Copy, tmp_path: Path) -> None:
    config = scenario("left_turn")
    found = []
    for ending in ("xml", "csv", "parquet"):
        file = tmp_path / f"fcd.{ending}"
        words = ("--end", "60", "--fcd-output", file, "--precision", "6")
        done = closecall("run", config, "--quiet", "--out", tmp_path / "live", "--", *words)
        assert done.returncode == 0, done.stderr
        routes = config.with_suffix(".rou.xml")
        table = api.replay(file, path="driven", route_files=[routes]).to_dict()
        found.append((list(table["ego"]), list(table["kind"]), [round(value, 3) for value in table["margin"]]))
    assert found[0] == found[1] == found[2] and "side" in found[0][1]


def test_a_table_has_the_driven_paths_of_the_fcd_output(tmp_path: Path) -> None:
    scene = layouts.scene()
    recording, types = layouts.fcd(tmp_path, scene)
    (tmp_path / "driven.toml").write_text('path = "driven"\nalign = "never"\n')
    words = ("--config", tmp_path / "driven.toml", "--quiet")
    for file, out, more in (
        (recording, "fcd", ("--route-files", types)),
        (layouts.levelx(tmp_path, scene), "table", ()),
    ):
        assert closecall("replay", file, *words, "--out", tmp_path / out, *more).returncode == 0
    one, other = (rows(tmp_path / out / "conflicts.csv") for out in ("fcd", "table"))
    assert [row["kind"] for row in one] == [row["kind"] for row in other] != []
    for a, b in zip(one, other):
        assert float(a["margin"]) == pytest.approx(float(b["margin"]), abs=1e-3)


def test_a_run_with_sumo_does_not_know_what_will_be_driven(tmp_path: Path) -> None:
    config = NETS / "rear_end" / "rear_end.sumocfg"
    done = closecall("run", config, "--path", "driven", "--out", tmp_path / "none")
    assert done.returncode == 2 and is_one_message(done.stderr) and "only a recording knows" in done.stderr
    assert not (tmp_path / "none").exists()
    with pytest.raises(ValueError, match="only a recording knows"):
        api.Checker(path="driven")


@dataclass
class Way:
    """A car that drives along x; it begins at these coordinates."""

    x: float
    y: float
    speed: float


def tracks(file: Path, ways: dict[str, Way], noise: float, exchange: tuple[int, str, str] | None = None) -> Path:
    """A table of cars at 25 Hz for 4 s with white noise; from a frame on two exchange their ids."""
    draw = random.Random(3)
    lines = ["id,time,x,y"]
    for frame in range(100):
        for name, way in ways.items():
            id_ = name
            if exchange and frame >= exchange[0] and name in exchange[1:]:
                id_ = exchange[2] if name == exchange[1] else exchange[1]
            x, y = way.x + way.speed * frame / 25, way.y
            lines.append(f"{id_},{frame / 25},{draw.gauss(x, noise)},{draw.gauss(y, noise)}")
    file.write_text("\n".join(lines) + "\n")
    return file


COLUMNS = "id=id,time=time,x=x,y=y"
PASSING = {"a": Way(0.0, 0.0, 20.0), "b": Way(-10.0, 3.5, 18.0)}


def test_cars_that_pass_each_other_are_in_conflict_for_noise_only(tmp_path: Path) -> None:
    clean, noisy = (tracks(tmp_path / f"{noise}.csv", PASSING, noise) for noise in (0.0, 0.3))
    for path in ("straight", "driven"):
        conflicts = {
            "truth": len(api.replay(clean, COLUMNS, path=path)),
            "noisy": len(api.replay(noisy, COLUMNS, path=path)),
            "smoothed": len(api.replay(noisy, COLUMNS, path=path, smooth=0.3)),
        }
        assert conflicts["truth"] == 0 and conflicts["smoothed"] <= conflicts["noisy"], conflicts
    assert len(api.replay(noisy, COLUMNS, path="straight")) > len(
        api.replay(noisy, COLUMNS, path="straight", smooth=0.3)
    )
    with pytest.raises(ValueError, match="smooth"):
        api.replay(noisy, COLUMNS, smooth=-1.0)


@pytest.mark.parametrize("words", [(), ("--smooth",)])
def test_exchanged_identities_and_jumps_are_told_and_not_mended(words: tuple[str, ...], tmp_path: Path) -> None:
    def told(file: Path) -> str:
        done = closecall("replay", file, "--columns", COLUMNS, "--path", "straight", "--out", tmp_path / "out", *words)
        assert done.returncode == 0, done.stderr
        return done.stderr

    assert "identities" not in (clean := told(tracks(tmp_path / "clean.csv", PASSING, 0.1))) and "jumps" not in clean
    exchanged = told(tracks(tmp_path / "exchanged.csv", PASSING, 0.1, exchange=(50, "a", "b")))
    assert (
        'identities: 1 time two road users exchange their places between two rows, first "a" and "b" at 2 s'
        in exchanged
    )
    assert "jumps" not in exchanged
    lines = tracks(tmp_path / "jump.csv", PASSING, 0.1).read_text().splitlines()
    lines[121] = "a,2.4,48.0,9.0"
    (tmp_path / "jump.csv").write_text("\n".join(lines) + "\n")
    jumped = told(tmp_path / "jump.csv")
    assert "jumps: 2 times" in jumped and 'first "a" at 2.4 s, 8.9 m' in jumped and "identities" not in jumped


def test_a_simulation_has_no_noise_to_smooth(tmp_path: Path) -> None:
    recording, _ = layouts.fcd(tmp_path, layouts.scene())
    for words, said in (((), "--smooth is for tables"), (("--columns", COLUMNS), "it has no column id")):
        done = closecall("replay", recording, "--smooth", "--out", tmp_path / "none", *words)
        assert done.returncode == 2 and said in done.stderr and is_one_message(done.stderr), done.stderr
    for noise in ("0", "-1", "eleven", "11"):
        done = closecall("replay", recording, f"--smooth={noise}", "--out", tmp_path / "none")
        assert done.returncode == 2 and is_one_message(done.stderr), done.stderr
