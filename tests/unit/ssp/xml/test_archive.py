"""Archives of strangers do no harm, ours have the same bytes every time."""

import stat
import zipfile

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.ssp import check_file, pack, read_system
from shipcosim.ssp.xml.archive import unpack, write_archive


def archive(path, **entries):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in entries.items():
            file.writestr(name, data)
    return path


@pytest.mark.parametrize(
    "name",
    ["../outside.txt", "/outside.txt", "a/../../outside.txt", "..\\outside.txt", "C:\\x.txt"],
)
def test_an_entry_that_would_land_outside_is_refused(tmp_path, name):
    path = archive(tmp_path / "evil.ssp", **{name: "x"})
    with pytest.raises(ShipcosimError, match="would land outside the folder"):
        unpack(path, tmp_path / "in")
    assert {file.name for file in tmp_path.rglob("*")} == {"evil.ssp"}


def test_a_symbolic_link_is_refused(tmp_path):
    entry = zipfile.ZipInfo("link")
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "evil.ssp", "w") as file:
        file.writestr(entry, "/etc")
    with pytest.raises(ShipcosimError, match="symbolic link"):
        unpack(tmp_path / "evil.ssp", tmp_path / "in")


def test_a_bomb_is_refused_before_it_is_unpacked(tmp_path):
    path = archive(tmp_path / "bomb.ssp", zeros=b"\0" * (100 * 2**20))
    with pytest.raises(ShipcosimError, match="times its size"):
        unpack(path, tmp_path / "in")
    assert not (tmp_path / "in").exists()


def test_too_many_entries_are_refused(tmp_path):
    path = archive(tmp_path / "many.ssp", **{str(number): "" for number in range(20_001)})
    with pytest.raises(ShipcosimError, match="20001 entries"):
        unpack(path, tmp_path / "in")


def test_a_truncated_archive_is_refused(shop, tmp_path):
    shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one", "output y"))
    pack(shop.folder, (), tmp_path / "whole.ssp")
    data = (tmp_path / "whole.ssp").read_bytes()
    for share in (0.0, 0.3, 0.9, 0.999):
        cut = tmp_path / "cut.ssp"
        cut.write_bytes(data[: int(share * len(data))])
        with pytest.raises(ShipcosimError, match="Damaged or incomplete archive"):
            read_system(cut)


def test_a_changed_byte_in_the_archive_is_never_a_crash(shop, tmp_path):
    shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one", "output y"))
    pack(shop.folder, (), tmp_path / "whole.ssp")
    data = (tmp_path / "whole.ssp").read_bytes()
    for position in range(0, len(data), 7):
        changed = tmp_path / "changed.ssp"
        changed.write_bytes(data[:position] + bytes([data[position] ^ 0x55]) + data[position + 1 :])
        for problem in check_file(changed):
            assert problem.found


def test_an_archive_without_a_structure_says_what_there_is(tmp_path):
    path = archive(tmp_path / "x.ssp", **{"Other.ssd": "<x/>"})
    with pytest.raises(
        ShipcosimError, match="has no SystemStructure.ssd at its top. It has: Other.ssd"
    ):
        read_system(path)


def test_a_packed_system_reads_like_its_folder_and_packs_to_the_same_bytes(shop, tmp_path):
    shop.fmu("one", "output y Real km")
    shop.fmu("two", "input u Real m")
    store = tmp_path / "store"
    store.mkdir()
    for name in ("one", "two"):
        (shop.folder / f"resources/{name}.fmu").rename(store / f"{name}.fmu")
    shop.ssv("")
    elements = shop.component("a", "one", "output y") + shop.component("b", "two", "input u")
    shop.ssd(elements, shop.connection("a.y", "b.u"))
    pack(shop.folder, [store], tmp_path / "out" / "one.ssp")
    (shop.folder / "resources/numbers.ssv").touch()
    pack(shop.folder, [store], tmp_path / "two.ssp")
    assert (tmp_path / "out" / "one.ssp").read_bytes() == (tmp_path / "two.ssp").read_bytes()
    system = read_system(tmp_path / "two.ssp")
    assert system.connections[0].factor == 1000.0
    assert system.components["a"].fmu.path.is_file()
    with zipfile.ZipFile(tmp_path / "two.ssp") as file:
        assert "resources/one.fmu" in file.namelist()


def test_another_structure_of_an_archive_is_chosen_by_name(shop, tmp_path):
    shop.fmu("one", "output y Real km")
    shop.ssd(shop.component("a", "one", "output y"))
    shop.path.with_name("Variant.ssd").write_text(
        shop.path.read_text().replace('<ssd:Component name="a"', '<ssd:Component name="z"')
    )
    pack(shop.folder, (), tmp_path / "both.ssp")
    assert list(read_system(tmp_path / "both.ssp").components) == ["a"]
    assert list(read_system(f"{tmp_path / 'both.ssp'}#Variant.ssd").components) == ["z"]


def test_a_broken_system_is_not_packed(shop, tmp_path):
    shop.ssd(shop.component("a", "one", "output y"))
    with pytest.raises(ShipcosimError, match="does not exist"):
        pack(shop.folder, (), tmp_path / "x.ssp")
    assert not (tmp_path / "x.ssp").exists()


def test_an_archive_that_cannot_be_written_leaves_nothing(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ShipcosimError, match="Cannot be written"):
        write_archive(tmp_path / "file" / "x.ssp", {"a": b""})


@pytest.mark.parametrize(
    "source", ["../secret.fmu", "/etc/passwd", "http://example.org/x.fmu", "file:///etc/passwd", ""]
)
def test_addresses_outside_the_package_are_refused(shop, source):
    shop.fmu("one", "output y Real m")
    shop.ssd(shop.component("a", "one").replace("resources/one.fmu", source))
    message = shop.refused()
    assert "outside the package" in message or "is no address within the package" in message
