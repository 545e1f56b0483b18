"""Files of other programs are refused with what they are and what makes a table of them."""

import io
import time
import zipfile

import pytest

from shipcosim.diagnose.log.reader import read_log
from shipcosim.errors import ShipcosimError


def zipped(*names, kind=""):
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w") as archive:
        if kind:
            archive.writestr("mimetype", kind)
        for name in names:
            archive.writestr(name, "x")
    return written.getvalue()


ODS = zipped("content.xml", kind="application/vnd.oasis.opendocument.spreadsheet")
CASES = {
    "old.xls": (
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600),
        "Excel before 2007.*libreoffice .* old.xls",
    ),
    "named.csv": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), "Excel before 2007"),
    "sheet.ods": (ODS, "LibreOffice.*Save it as .xlsx"),
    "sheet.csv": (ODS, "LibreOffice"),
    "book.csv": (zipped("xl/workbook.xml"), "cannot be read"),
    "logs.csv": (zipped("monday.csv"), "an archive.*Unpack"),
    "log.mat": (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(600), "MATLAB.*writetable"),
    "log.txt": (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(600), "MATLAB"),
    "run.bag": (b"#ROSBAG V2.0\n", "bag of ROS.*rostopic"),
    "run.db3": (b"SQLite format 3\x00", "ROS 2"),
    "flight.ulg": (b"ULog\x01\x12", "ulog2csv flight.ulg"),
    "table.h5": (b"\x89HDF\r\n\x1a\n", "HDF5"),
    "table.pkl": (b"\x80\x04", "pickle"),
    "table.json": (b"\x00\x01", "zero bytes"),
    "report.html": (b"<!DOCTYPE html><title>a run</title>", "page in HTML.*as .csv"),
    "saved.csv": (b"<html><body>Please log in</body></html>", "page in HTML"),
    "report.pdf": (b"%PDF-1.7 ...", "PDF"),
    "large.csv": (
        b"version https://git-lfs.github.com/spec/v1\noid sha256:2b5c5d4c\n",
        "git lfs pull",
    ),
    "large.nc": (b"version https://git-lfs.github.com/spec/v1\noid sha256:2b5c5d4c\n", "Git LFS"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_file_of_another_program_is_refused_with_what_would_do(name, tmp_path):
    content, words = CASES[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ShipcosimError, match=words) as raised:
        read_log(tmp_path / name)
    assert len(raised.value.problems) == 1


@pytest.mark.parametrize("line", ["time,heading," + "x" * 20_000_000, "time" + ",1" * 10_000_000])
def test_a_line_that_no_table_has_is_refused_at_once(tmp_path, line):
    """A header of 90 MB took more than a minute."""
    path = tmp_path / "log.csv"
    path.write_text(f"% of a logger\n{line}\n0,1,2\n1,1,2\n")
    begun = time.process_time()
    with pytest.raises(ShipcosimError, match=r"log\.csv, line 2: is longer than 1 MB"):
        read_log(path)
    assert time.process_time() - begun < 5.0
    path.write_text(f"time,heading,note\n0,1,{'x' * 900_000}\n1,1,2\n2,1,2\n")
    assert read_log(path).sizes["time"] == 3
