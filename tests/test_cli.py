"""The command line from outside: exit status, what is printed where, and the JSON record."""

import json
import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import fuzzynav_mj
from fuzzynav_mj.cli import main
from fuzzynav_mj.commands import run as run_command
from fuzzynav_mj.scenarios import library_names

RAM = """
[[moving]]
circle = 0.2
waypoints = [[1.75, 0.6], [0.25, 0.6]]
speed = 0.5
"""

DRAWN = """
[[random_moving]]
count = [1, 2]
radius = [0.05, 0.06]
vertices = [3, 5]
concave_fraction = 0.0
speed = [0.05, 0.1]
region = [[1.4, 0.1], [1.9, 0.1], [1.9, 1.1], [1.4, 1.1]]
"""

TIMINGS = {"plan_ms_p50", "plan_ms_p99", "wall_s"}

NUMBER = (int, float)
FIELDS: dict[str, tuple[type, ...]] = {
    "scenario": (str,),
    "planner": (str,),
    "seed": (int,),
    "outcome": (str,),
    "sim_time_s": NUMBER,
    "path_length_m": NUMBER,
    "shortest_path_m": NUMBER,
    "optimality": (*NUMBER, type(None)),
    "min_clearance_m": NUMBER,
    "contacts": (list,),
    "risk_max": (*NUMBER, type(None)),
    "risk_mean": (*NUMBER, type(None)),
    "gate_vetoes": (int,),
    "decisions": (int,),
    "plan_ms_p50": NUMBER,
    "plan_ms_p99": NUMBER,
    "wall_s": NUMBER,
    "physics_steps": (int,),
    "tracking_rms_m": NUMBER,
    "slip_max_mps": NUMBER,
    "versions": (dict,),
    "disturbance": (dict,),
    "goal_distance_m": NUMBER,
}


def run_json(capsys, *arguments: str) -> tuple[int, dict]:
    status = main(["run", *arguments, "--json"])
    output = capsys.readouterr()
    assert output.err == ""
    return status, json.loads(output.out)


def error_line(capsys, *arguments: str) -> str:
    """The one line that bad input gets, after its prefix."""
    assert main(list(arguments)) == 2
    output = capsys.readouterr()
    assert output.out == ""
    lines = output.err.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith("fuzzynav: ")
    return lines[0].removeprefix("fuzzynav: ")


# run -------------------------------------------------------------------------------------------


def test_reaching_the_goal_is_status_0_and_one_json_object(capsys, write_scenario):
    status, record = run_json(capsys, write_scenario("open"))
    assert status == 0
    assert record["outcome"] == "goal_reached"
    assert (record["scenario"], record["planner"], record["seed"]) == ("open", "fuzzy", 0)
    assert {name: type(value) in FIELDS[name] for name, value in record.items()} == dict.fromkeys(
        FIELDS, True
    )
    assert record["contacts"] == []
    assert record["shortest_path_m"] == pytest.approx(0.6, abs=1e-9)
    assert record["optimality"] == record["shortest_path_m"] / record["path_length_m"]
    assert record["physics_steps"] == round(record["sim_time_s"] / 0.005)
    assert record["versions"] == {
        "fuzzynav_mj": fuzzynav_mj.__version__,
        "mujoco": version("mujoco"),
        "dm_control": version("dm-control"),
        "numpy": version("numpy"),
    }


def test_running_out_of_time_is_status_1(capsys, write_scenario):
    status, record = run_json(capsys, write_scenario("short", time_limit=0.5))
    assert (status, record["outcome"], record["optimality"]) == (1, "timeout", None)
    assert record["sim_time_s"] == pytest.approx(0.5)


def test_contact_is_status_1_and_says_with_what(capsys, write_scenario):
    walled_in = "[[static]]\npolygon = [[0.1, 0.75], [0.9, 0.75], [0.9, 0.8], [0.1, 0.8]]\n"
    walled_in += "[[static]]\npolygon = [[0.1, 0.4], [0.9, 0.4], [0.9, 0.45], [0.1, 0.45]]\n"
    walled_in += "[[static]]\npolygon = [[0.2, 0.46], [0.25, 0.46], [0.25, 0.74], [0.2, 0.74]]\n"
    ram = RAM.replace("circle = 0.2", "circle = 0.12").replace("[0.25, 0.6]", "[0.45, 0.6]")
    status, record = run_json(capsys, write_scenario("ram", walled_in + ram))
    assert (status, record["outcome"]) == (1, "contact")
    (contact,) = record["contacts"]
    assert list(contact) == ["time_s", "with", "robot_speed_mps", "at_fault"]
    assert contact["with"] == "moving:0"
    assert contact["at_fault"] is (contact["robot_speed_mps"] > 0.02)
    assert 0.0 < contact["time_s"] <= record["sim_time_s"]
    assert record["min_clearance_m"] == 0.0


def test_a_goal_without_a_way_has_no_shortest_path(capsys, write_scenario):
    wall = "[[static]]\npolygon = [[0.85, 0.0], [0.87, 0.0], [0.87, 1.2], [0.85, 1.2]]\n"
    status, record = run_json(capsys, write_scenario("shut", wall, time_limit=1.0))
    assert (status, record["shortest_path_m"]) == (1, None)


def test_same_seed_gives_the_same_record_apart_from_timings(capsys, write_scenario):
    scenario = write_scenario("drawn", DRAWN)

    def without_timings(seed: int) -> dict:
        _, record = run_json(capsys, scenario, "--seed", str(seed), "--planner", "multilayer")
        return {name: value for name, value in record.items() if name not in TIMINGS}

    first = without_timings(7)
    assert (first["seed"], first["planner"]) == (7, "multilayer")
    assert without_timings(7) == first
    assert without_timings(8) != first | {"seed": 8}


def test_the_summary_is_plain_on_a_pipe(capsys, write_scenario):
    assert main(["run", write_scenario("open")]) == 0
    output = capsys.readouterr()
    assert output.err == ""
    lines = output.out.splitlines()
    assert lines[0] == "open, planner fuzzy, seed 0: goal reached"
    assert [line[2:16].rstrip() for line in lines[1:]] == [
        "simulated time", "path", "min clearance", "risk", "planning",
    ]  # fmt: skip
    assert "\x1b" not in output.out


def test_quiet_prints_nothing(capsys, write_scenario):
    assert main(["run", write_scenario("open"), "--quiet"]) == 0
    output = capsys.readouterr()
    assert (output.out, output.err) == ("", "")


def test_a_recording_is_written_and_the_summary_says_how_to_open_it(
    capsys, write_scenario, tmp_path
):
    recording = tmp_path / "open.rrd"
    assert main(["run", write_scenario("open"), "--rrd", str(recording)]) == 0
    label, _, command = capsys.readouterr().out.splitlines()[-1].partition("with ")
    assert label.strip() == "open it"
    assert command.strip().endswith(f"rerun {recording}")
    assert recording.read_bytes().startswith(b"RRF2")


def test_json_stays_alone_on_standard_output_beside_a_recording(capsys, write_scenario, tmp_path):
    recording = str(tmp_path / "open.rrd")
    status, record = run_json(capsys, write_scenario("open"), "--rrd", recording, "--quiet")
    assert (status, record["outcome"]) == (0, "goal_reached")


def test_an_interrupt_is_status_130(capsys, monkeypatch, write_scenario):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(run_command, "play_episode", interrupted)
    assert main(["run", write_scenario("open")]) == 130
    assert capsys.readouterr().err == "fuzzynav: interrupted\n"


# Bad input -------------------------------------------------------------------------------------

SEEDS = "allowed is a whole number from 0 to 9223372036854775807 (see fuzzynav run --help)"


@pytest.mark.parametrize("seed", ["-1", "1.5", "x", "", "1e3", "٣", "9223372036854775808"])
def test_a_bad_seed_names_what_is_allowed(capsys, seed):
    line = error_line(capsys, "run", "concave", f"--seed={seed}")
    assert line == f"argument --seed: given {seed!r}; {SEEDS}"


def test_a_seed_of_thousands_of_digits_is_one_line(capsys):
    assert error_line(capsys, "run", "concave", "--seed", "9" * 5000).endswith(SEEDS)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "the following arguments are required: COMMAND (see fuzzynav --help)"),
        (["run"], "the following arguments are required: SCENARIO (see fuzzynav run --help)"),
        (["run", "maze", "--see", "1"], "unrecognized arguments: --see 1 (see fuzzynav --help)"),
        (
            ["run", "concav"],
            f"unknown scenario 'concav': allowed are {', '.join(library_names())}. "
            "Did you mean 'concave'?",
        ),
        (
            ["run", "missing/x.toml"],
            "missing/x.toml: file: given a path that cannot be read (No such file or directory); "
            "allowed a readable .toml file",
        ),
        (
            ["bench", "--episodes", "0"],
            "argument --episodes: given '0'; allowed is a whole number from 1 to 1000000 "
            "(see fuzzynav bench --help)",
        ),
        (
            ["bench", "--seed", "9223372036854775807", "--episodes", "2"],
            "argument --seed: given 9223372036854775807 with 2 episodes; "
            "allowed is a last seed of at most 9223372036854775807",
        ),
        (
            ["list", "robots"],
            "argument scenarios|planners: invalid choice: 'robots' "
            "(choose from 'scenarios', 'planners') (see fuzzynav list --help)",
        ),
    ],
)
def test_bad_arguments_get_one_line(capsys, arguments, expected):
    # Releases of Python differ in whether they quote the choices.
    assert error_line(capsys, *arguments).replace("'", "") == expected.replace("'", "")


def test_an_unknown_planner_gets_a_suggestion(capsys, write_scenario):
    line = error_line(capsys, "run", write_scenario("open"), "--planner", "fuzy")
    assert line.startswith("unknown planner 'fuzy': allowed are ")
    assert line.endswith(" Did you mean 'fuzzy'?")


def test_a_bad_scenario_names_file_and_key(capsys, write_scenario):
    scenario = write_scenario("bad", "[[static]]\ncircle = [1.6, 0.6, -0.1]\n")
    assert error_line(capsys, "run", scenario) == (
        f"{scenario}: static.0.circle.2: given -0.1; "
        "allowed 3 numbers x, y, radius in m, the radius above 0"
    )


ALLOWED = "allowed is a file in a folder that can be written"


@pytest.mark.parametrize(
    ("target", "given"),
    [
        ("missing/a.rrd", "a file in {folder}/missing, which is not a folder"),
        ("open.toml/a.rrd", "a file in {folder}/open.toml, which is not a folder"),
        (".", "something else than a file"),
        ("x" * 300, "a file that cannot be written (File name too long)"),
    ],
)
def test_a_recording_that_cannot_be_written_is_found_before_the_episode(
    capsys, monkeypatch, write_scenario, tmp_path, target, given
):
    def played(*_):
        raise AssertionError("the episode was run")

    monkeypatch.setattr(run_command, "play_episode", played)
    path = tmp_path / target
    line = error_line(capsys, "run", write_scenario("open"), "--rrd", str(path))
    assert line == f"{path}: --rrd: given {given.format(folder=tmp_path)}; {ALLOWED}"


# list, check and the rest ----------------------------------------------------------------------


def test_list_prints_a_name_and_what_it_is_on_every_line(capsys):
    assert main(["list", "scenarios"]) == 0
    scenarios = capsys.readouterr().out.splitlines()
    names = [line.split()[0] for line in scenarios]
    assert names[:4] == ["concave", "convex", "maze", "narrow"]
    assert sorted(names) == list(library_names())
    assert main(["list", "planners"]) == 0
    planners = capsys.readouterr().out.splitlines()
    assert "fuzzy" in [line.split()[0] for line in planners]
    assert all(len(line.split()) > 2 for line in scenarios + planners)


def test_check_names_every_bad_file_and_goes_on(capsys, write_scenario):
    good = write_scenario("good", DRAWN)
    bad = write_scenario("bad", "speed = 1.0")
    assert main(["check", bad, good, "missing.toml"]) == 2
    output = capsys.readouterr()
    assert output.out == f"{good}: ok (good)\n"
    first, second = output.err.splitlines()
    assert first.startswith(f"fuzzynav: {bad}: robot.speed: given an unknown key; allowed ")
    assert second.startswith("fuzzynav: missing.toml: file: given a path that cannot be read")
    assert main(["check", good]) == 0


def test_help_imports_nothing_heavy():
    program = (
        "import sys; from fuzzynav_mj.cli import main; status = main(['run', '--help']); "
        "heavy = {'numpy', 'mujoco', 'dm_control', 'rerun', 'rich', 'shapely', 'pyarrow'}; "
        "print(status, heavy & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "0 set()"


def test_a_reader_that_goes_away_gets_no_complaint():
    read_end, write_end = os.pipe()
    os.close(read_end)
    program = [sys.executable, "-m", "fuzzynav_mj.cli", "list", "planners"]
    done = subprocess.run(program, stdout=write_end, stderr=subprocess.PIPE)
    os.close(write_end)
    assert (done.returncode, done.stderr) == (141, b"")


def test_the_first_run_without_a_display_is_silent(write_scenario):
    environment = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}
    done = subprocess.run(
        [sys.executable, "-m", "fuzzynav_mj.cli", "run", write_scenario("open"), "--json"],
        capture_output=True,
        env=environment,
        cwd=Path(write_scenario("open")).parent,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert json.loads(done.stdout)["outcome"] == "goal_reached"
