"""Catalogue files: round trips, a vendor's own columns and units, and everything that can be wrong with one."""

from dataclasses import astuple

import pytest

from equipoise.hardware import Limits, Stock, read_catalogue, write_catalogue
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.hardware.stock.parts import COLUMNS
from equipoise.model.errors import InputError

VENDOR = """\
Art.-Nr.;Art;R [N/mm];Fn;F0;L0 [mm];De [mm];d [mm];Gewicht [g]
Z-1;extension;0.59;155;5;120.5;20;1.5;48
Z-2;extension;0.078;48;0;187;17.7;1.4;73
"""
NAMES = {
    "part": "Art.-Nr.", "kind": "Art", "rate": "R", "max_force": "Fn [N]", "initial_tension": "F0", "free_length": "L0",
    "outer_diameter": "De", "wire_diameter": "d", "mass": "Gewicht",
}  # fmt: skip


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_round_trip(tmp_path, suffix) -> None:
    springs = made_up_catalogue(60)
    write_catalogue(springs, tmp_path / f"list{suffix}")
    assert read_catalogue(tmp_path / f"list{suffix}") == springs


def test_a_vendors_columns_and_units(tmp_path) -> None:
    path = tmp_path / "vendor.csv"
    path.write_text(VENDOR)
    first, second = read_catalogue(path, NAMES)
    assert (first.part, first.kind, second.initial_tension, second.price) == ("Z-1", "extension", 0.0, 0.0)
    expected = Stock("Z-1", "extension", 590.0, 155.0, 0.1205, 0.02, 0.0015, 0.048, 5.0)
    assert astuple(first)[2:] == pytest.approx(astuple(expected)[2:])
    assert first.stroke == pytest.approx(150 / 590)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("0.59", "much", "2: rate: expected a number, found 'much'"),
        ("0.59", "-1", "2: rate: must be more than 0"),
        ("0.59", "nan", "expected a finite number"),
        ("Z-2", "Z-1", "3: part: 'Z-1' is there twice"),
        ("Z-1", "", "part: is missing"),
        (";extension;0.59", ";tension;0.59", "unknown 'tension'; did you mean 'extension'"),
        (";155;5;", ";155;156;", "initial_tension: must be less than max_force"),
        ("L0 [mm]", "L0 [kg]", "free_length: expected a number [m]"),
        ("L0 [mm]", "L1 [mm]", "free_length: the file has no column 'L0'"),
        ("Z-1;extension;0.59;155;5;120.5;20;1.5;48\n", "Z-1;extension\n", "rate: expected a number, found ''"),
    ],
)
def test_faults(tmp_path, old, new, message) -> None:
    path = tmp_path / "vendor.csv"
    path.write_text(VENDOR.replace(old, new))
    with pytest.raises(InputError) as error:
        read_catalogue(path, NAMES)
    assert message in str(error.value)
    assert str(path) in str(error.value)


def test_all_faults_at_once_and_hopeless_files(tmp_path) -> None:
    path = tmp_path / "vendor.csv"
    path.write_text(VENDOR.replace("0.59", "x").replace("0.078", "y"))
    with pytest.raises(InputError) as error:
        read_catalogue(path, NAMES)
    assert len(error.value.faults) == 2
    with pytest.raises(InputError, match="no column 'colour'"):
        read_catalogue(path, {"colour": "x"})
    path.write_text(VENDOR.splitlines()[0])
    with pytest.raises(InputError, match="has no springs"):
        read_catalogue(path, NAMES)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="UTF-8"):
        read_catalogue(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_catalogue(tmp_path / "none.csv")
    pytest.importorskip("pyarrow")
    broken = tmp_path / "list.parquet"
    broken.write_text("no parquet")
    with pytest.raises(InputError, match="is no Parquet file"):
        read_catalogue(broken)
    with pytest.raises(InputError, match="cannot be read"):
        read_catalogue(tmp_path / "none.parquet")


def test_made_up_list_is_named_so_and_within_the_limits() -> None:
    springs = made_up_catalogue(2000)
    assert len({one.part for one in springs}) == 2000
    assert all(one.part.startswith("MADE-UP-") for one in springs)
    assert made_up_catalogue(50, 1) == made_up_catalogue(50, 1) != made_up_catalogue(50, 2)
    low, high = Limits().index
    for one in springs:
        assert low <= (one.outer_diameter - one.wire_diameter) / one.wire_diameter <= high + 0.2
        assert one.max_force > one.initial_tension >= 0
    assert {one.kind for one in springs} == {"extension", "compression"}
    with pytest.raises(InputError, match="at most"):
        made_up_catalogue(10**6)


def test_every_column_is_a_field() -> None:
    assert set(COLUMNS) == set(Stock.__dataclass_fields__)
