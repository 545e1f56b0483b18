"""How long a run of four corners takes to save, against the run itself and against xarray's own writer."""

import shipcosim
from shipcosim.series import write_table
from speed.measure import cpu_seconds, reported

RUNS = 5
LEAST_GAIN = 4.0  # times as fast as xarray with h5netcdf, for the same file as xarray reads it


def test_netcdf_is_written_faster_than_by_xarray(root, tmp_path):
    table = shipcosim.run(root / "scenarios/four_corner.toml", until=200.0).table
    ours = [cpu_seconds(lambda: write_table(table, tmp_path / "ours.nc")) for _ in range(RUNS)]
    theirs = [
        cpu_seconds(lambda: table.to_netcdf(tmp_path / "theirs.nc", engine="h5netcdf"))
        for _ in range(RUNS)
    ]
    gains = [b / a for a, b in zip(ours, theirs, strict=True)]
    assert reported("xarray's time over ours", gains, "", f"{LEAST_GAIN}") > LEAST_GAIN


def test_saving_takes_a_second(root, tmp_path):
    """CPU time of result.nc, result.csv, predictions.csv and the page; 3.4 s before the writers were looked at."""
    run = shipcosim.run(root / "scenarios/four_corner.toml")
    run.save(tmp_path / "first")  # imports what the page needs
    seconds = [cpu_seconds(lambda: run.save(tmp_path / "again", force=True)) for _ in range(RUNS)]
    assert reported("saving four corners", seconds, "s", "0.6") < 1.5
