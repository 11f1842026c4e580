"""The command ``dielectric-actuator``, in this process."""

import csv
import os
import re
import sys

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssv

from dielectric_actuator import Actuator, command, device, native, presets
from dielectric_actuator.kept import KeptTable


def run(capsys, *words) -> tuple[int, str, str]:
    code = command.main([str(word) for word in words])
    printed = capsys.readouterr()
    return code, printed.out, printed.err


def test_a_run_is_printed_written_and_drawn(capsys, tmp_path):
    code, out, _ = run(capsys, "run", "--phi", 0.6, "--plot", tmp_path / "out.png", "--csv", tmp_path / "out.csv")
    assert code == 0 and "stretch from 1 to 1.23157" in out and "not pulled in" in out
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    with (tmp_path / "out.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 801 and float(rows[-1]["time"]) == 80.0


def test_a_collapse_is_drawn_too(capsys, tmp_path):
    code, out, _ = run(capsys, "run", "--preset", "pull_in", "--plot", tmp_path / "out.png")
    assert code == 0 and "pulled in at time 38.6058" in out


@pytest.mark.parametrize("name", presets.names())
def test_every_preset_moves(capsys, name):
    preset = presets.load(name)
    with Actuator(preset.model) as actuator:
        response = actuator.run(
            preset.start_values, stop_time=preset.stop_time, communication_step=preset.communication_step
        )
    assert np.ptp(response["lambda"]) > 0.01
    code, out, _ = run(capsys, "presets", name)
    assert code == 0 and preset.title in out
    assert name in run(capsys, "presets")[1]


def test_a_preset_is_written_for_other_hosts(capsys, tmp_path):
    code, _, _ = run(capsys, "presets", "prestress", "--ssv", tmp_path / "prestress.ssv")
    parameters = read_ssv(str(tmp_path / "prestress.ssv")).parameters
    found = {parameter.name: float(parameter.value) for parameter in parameters}
    assert code == 0 and found == presets.load("prestress").start_values


def test_a_device_is_run_in_si_units(capsys, tmp_path):
    code, out, _ = run(capsys, "run", "--si", "--voltage", 600, "--plot", tmp_path / "out.png")
    assert code == 0 and "at time 3e-05 s" in out and "not pulled in" in out
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    code, out, _ = run(capsys, "run", "--preset", "silicone_snap")
    assert code == 0 and "pulled in at time 1.24978e-05 s" in out
    code, out, _ = run(capsys, "thresholds", "--preset", "silicone_swing")
    assert code == 0 and "715.255" in out and " V  static" in out
    code, out, _ = run(capsys, "presets", "vhb_4905")
    assert code == 0 and "E_breakdown = 6.06e+07 V/m" in out and "Not verified" in out
    code, out, _ = run(capsys, "variables", "--si", "voltage")
    assert code == 0 and " V " in out


def test_all_presets_are_written_for_each_fmu(capsys, tmp_path):
    assert run(capsys, "presets", "--ssv", tmp_path)[0] == 0
    found = sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.ssv"))
    assert len(found) == len(presets.names())
    assert {"DielectricElastomerActuator/step.ssv", "DielectricElastomerActuatorSI/vhb_4905.ssv"} <= set(found)


def test_thresholds_are_printed(capsys):
    code, out, _ = run(capsys, "thresholds", "--phi", 0.3)
    assert code == 0 and "0.6469836322448275" in out and "1.016397327212915" in out
    assert run(capsys, "thresholds", "--phi", 0.8)[1].count("none") == 1


@pytest.mark.parametrize("words, message", [
    (["rnu"], "no command 'rnu'; did you mean run"),
    (["run", "--fi", "0.6"], "no option or variable 'fi'; did you mean si or phi"),
    (["run", "--stop-tme", "5"], "no option or variable 'stop-tme'; did you mean stop-time"),
    (["run", "--lambda", "2"], "no option or variable 'lambda'; did you mean lambda_m"),
    (["run", "--si", "--phi", "0.6"], "no option or variable 'phi'"),
    (["run", "--si", "--preset", "step"], "the preset step is nondimensional; leave --si out"),
    (["run", "--stop-time", "-1"], "stop_time is -1"),
    (["run", "--step", "0"], "communication_step is 0; it must be a number above 0"),
    (["variables", "fi"], "no variable 'fi'; did you mean phi"),
    (["thresholds", "--gama_s", "1"], "did you mean gamma_s"),
    (["sweep", "--vary", "fi=0:1:3"], "no variable 'fi'; did you mean phi"),
    (["sweep", "--vary", "phi=0:1:3", "--vary", "phi=0:1:2"], "phi is given twice"),
    (["sweep", "--vary", "phi=0:1:3", "--phi", "0.5"], "phi is given twice"),
    (["run", "--phi", "high"], "phi is 'high'; it must be a number"),
    (["run", "--stop-tme", "fast"], "no option or variable 'stop-tme'"),
    (["run", "--c", "-1"], "c = -1 is below its minimum"),
    (["run", "--preset", "stp"], "no preset 'stp'; did you mean step"),
    (["run", "--fmu", "none.fmu"], "no FMU at none.fmu"),
    (["thresholds", "phi"], "'phi' is no option"),
    (["presets", "--phi=1"], "no option 'phi'"),
    (["fit", "none.csv", "--free", "c"], "none.csv"),
    (["fit", "none.csv", "--free", "c", "--units", "s,V,1"], "--units needs --si"),
    (["fit", "none.csv", "--free", "c", "--time", "voltage"], "'voltage' is named twice"),
    (["run", "--phi"], "phi is ''; it must be a number"),
    (["run", "--on_pull_in", "1.5"], "on_pull_in is 1.5; it must be a whole number"),
    (["run", "--stop-time", "1e18"], "communication_step is 0.1; for more than 1e+09 steps"),
    (["sweep", "--vary", "phi=0:1:100000000000000000"], "ask for fewer steps or scenes"),
    (["run", "--fmu", __file__], "cannot be read as an FMU"),
    (["sweep", "--vary", "phi=0:1:3", "--workers", "-1"], "workers is -1"),
])  # fmt: skip
def test_an_error_is_one_line(capsys, words, message):
    code, _, err = run(capsys, *words)
    assert code in (1, 2) and message in err and err.startswith("error: ") and err.count("\n") == 1


def test_a_missing_extra_is_named(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    code, _, err = run(capsys, "run", "--plot", "out.png")
    assert code == 1 and "pip install 'dielectric-actuator[plot]'" in err


def test_a_sweep_is_a_table_of_all_combinations(capsys, tmp_path):
    path = tmp_path / "sweep.csv"
    axes = ["--vary", "phi=0.5:0.7:3", "--vary", "S=0:0.1:2"]
    code, out, err = run(capsys, "sweep", *axes, "--E_s", 0.01, "--output", path)
    assert code == 0 and str(path) in out and "6 of 6" in err
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert [(float(row["phi"]), float(row["S"]), row["E_s"]) for row in rows[:3]] == [
        (0.5, 0.0, "0.01"), (0.5, 0.1, "0.01"), (0.6, 0.0, "0.01"),
    ]  # fmt: skip
    assert [row["pulled_in"] for row in rows] == ["False"] * 6
    assert not list(tmp_path.glob("*.unfinished"))


def test_an_interrupted_sweep_goes_on_from_what_is_done(capsys, tmp_path, monkeypatch):
    path, axes = tmp_path / "sweep.csv", ["--vary", "phi=0.1:0.6:20000", "--stop-time", "20"]
    whole = native.parts

    def stopped(*scenes, **options):
        yield next(whole(*scenes, **options))
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(native, "parts", stopped)
        code, _, err = run(capsys, "sweep", *axes, "--output", path)
    assert code == 130 and "interrupted" in err and not path.exists()
    # a line that was being written does not count
    unfinished = tmp_path / "sweep.csv.unfinished"
    unfinished.write_text(unfinished.read_text() + "0.3,0.")
    code, _, err = run(capsys, "sweep", "--vary", "phi=0.1:0.5:20000", "--output", path)
    assert code == 2 and "unfinished rows of other work" in err
    code, _, err = run(capsys, "sweep", *axes, "--output", path)
    done = int(re.search("20000 scenes, going on from ([0-9]+)", err)[1])
    assert code == 0 and 0 < done < 20000
    voltages = np.loadtxt(path, delimiter=",", skiprows=1, usecols=0)
    np.testing.assert_array_equal(voltages, np.linspace(0.1, 0.6, 20000))


def test_a_bad_value_of_a_sweep_is_said_before_anything_is_written(capsys, tmp_path):
    code, _, err = run(capsys, "sweep", "--vary", "phi=0:1e6:5000", "--output", tmp_path / "sweep.csv")
    assert code == 2 and "phi in row" in err and not list(tmp_path.iterdir())


def test_a_response_has_no_rows_of_other_work(capsys, tmp_path):
    path = tmp_path / "out.csv"
    (tmp_path / "out.csv.unfinished").write_text("# of a sweep that was stopped\nphi\n0.1\n0.2\n")
    assert run(capsys, "run", "--stop-time", 1, "--csv", path)[0] == 0
    assert len(path.read_text().splitlines()) == 12
    assert "stopped" in (tmp_path / "out.csv.unfinished").read_text()


@pytest.mark.parametrize("words", [("run", "--stop-time", 1, "--csv"), ("sweep", "--vary", "phi=0:0.1:2", "--output")])
def test_links_and_pipes_stay_what_they_are(capsys, tmp_path, words):
    target, link, pipe = (tmp_path / name for name in ("target.csv", "link.csv", "pipe"))
    link.symlink_to(target)
    assert run(capsys, *words, link)[0] == 0
    assert link.is_symlink() and len(target.read_text().splitlines()) > 2
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    assert run(capsys, *words, pipe)[0] == 0
    assert pipe.is_fifo() and os.read(reader, 100_000).decode() == target.read_text()
    os.close(reader)


@pytest.mark.parametrize("option", ["--csv", "--plot"])
def test_a_folder_is_refused_before_the_run(capsys, tmp_path, option):
    code, out, err = run(capsys, "run", option, tmp_path)
    assert code == 1 and "is a folder; name a file in it" in err and not out


def test_a_table_without_rows_is_taken_over(tmp_path):
    with KeptTable(tmp_path / "a.csv", "one"):
        pass
    with KeptTable(tmp_path / "a.csv", "other") as table:
        table.add({"x": np.arange(2)})
        assert table.complete().read_text() == "x\n0\n1\n"


def test_a_fit_of_a_file(capsys, tmp_path):
    time = np.arange(0.0, 100.0, 0.5)
    voltage = np.where(time < 50, 0.5, 0.2)
    stretch, _ = native.sensitivities({"gamma_s": 0.07}, time, voltage, interpolation="hold")
    data = tmp_path / "data.csv"
    np.savetxt(data, np.column_stack([time, voltage, stretch]), delimiter=",", header="t,V,lambda", comments="")
    words = ["--free", "gamma_s", "--time", "t", "--voltage", "V", "--stretch", "lambda", "--hold"]
    code, out, err = run(capsys, "fit", data, *words)
    run(capsys, "fit", data, *words, "--preset", tmp_path / "found.json")
    assert code == 0, err
    before = run(capsys, "fit", "--tau_s", "0.0", data, *words)
    assert before == run(capsys, "fit", data, *words, "--tau_s=0") and before[:2] == (0, out)
    assert "gamma_s" in out and presets.load(tmp_path / "found.json").start_values["gamma_s"] == pytest.approx(0.07)


def test_a_fit_in_volts_and_micrometres(capsys, tmp_path):
    time = np.arange(0.0, 4e-5, 1e-7)
    voltage = np.where(time % 8e-6 < 4e-6, 550.0, 200.0)
    stretch, _ = device.sensitivities({"mu": 2.8e5}, time, voltage, interpolation="hold")
    data = tmp_path / "data.csv"
    table = np.column_stack([time * 1e6, voltage, 100 * stretch])
    np.savetxt(data, table, delimiter=",", header="t,U,edge", comments="")
    words = ["fit", data, "--si", "--free", "mu", "--time", "t", "--voltage", "U", "--stretch", "edge", "--hold"]
    units = ["--observed", "edge_distance", "--units", "us,V,um"]
    code, out, err = run(capsys, *words, *units, "--preset", tmp_path / "found.json")
    assert code == 0, err
    found = presets.load(tmp_path / "found.json")
    assert "mu" in out and found.start_values["mu"] == pytest.approx(2.8e5, rel=1e-8) and found.model == "si"
    assert "no unit of length 'µm'; did you mean" in run(capsys, *words, *units[:3], "us,V,µm")[2]
    assert "no unit of time 'V'" in run(capsys, *words, *units[:3], "V,us,um")[2]
    assert "no unit of stretch 'um'" in run(capsys, *words, "--units", "us,V,um")[2]
    # what is wrong is called as the file calls it
    for row, bad in ((3, "0.2,nan,100"), (4, "0.1,200,100")):
        lines = data.read_text().splitlines()
        lines[row] = bad
        (tmp_path / "bad.csv").write_text("\n".join(lines))
        words[1] = tmp_path / "bad.csv"
        code, _, err = run(capsys, *words)
        assert code == 2 and (f"U in row {row} is nan" if "nan" in bad else f"t in row {row} is 0.1 after 0.2") in err
