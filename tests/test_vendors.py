"""Lists as vendors write them: heads, units, decimal commas, constants for what they leave out."""

import re

import pytest

from equipoise.hardware import read_catalogue
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.hardware.stock.vendors import FORMS, read_with, write_as
from equipoise.model.errors import InputError


@pytest.mark.parametrize("form", FORMS)
def test_what_is_written_is_read_with_the_options_that_are_said(tmp_path, form: str) -> None:
    springs = made_up_catalogue(30, 1, "extension")
    write_as(springs, tmp_path / "list.csv", form)
    columns = dict(re.findall(r'--column "?([a-z_]+)=([^"]+?)"?(?= --|$)', read_with(form)))
    read = read_catalogue(tmp_path / "list.csv", columns)
    for one, other in zip(read, springs, strict=True):
        for name in ("rate", "max_force", "free_length", "outer_diameter", "wire_diameter", "mass", "initial_tension"):
            assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-5, abs=1e-9)
        assert (one.part, one.kind, one.price) == (other.part, "extension", other.price)


def test_decimal_commas_units_in_cells_and_constants(tmp_path) -> None:
    path = tmp_path / "list.csv"
    path.write_text("Nr;R [N/mm];L;F;De;d\nA;0,59;120,5 mm;1.155,5;20 mm;1,5 mm\nB;1,2;4 in;20 lbf;0,8 in;2 mm\n")
    columns = {"part": "Nr", "rate": "R", "free_length": "L", "max_force": "F", "outer_diameter": "De"}
    columns |= {"wire_diameter": "d", "kind": "Extension springs", "mass": "10 g"}
    a, b = read_catalogue(path, columns)
    assert (a.rate, a.free_length, a.max_force, a.kind) == pytest.approx((590, 0.1205, 1155.5, "extension"))
    assert (b.free_length, b.max_force, b.mass) == pytest.approx((0.1016, 88.964432305, 0.01))


def test_a_head_with_brackets_is_a_head_and_a_missing_one_says_what_to_do(tmp_path) -> None:
    path = tmp_path / "list.csv"
    path.write_text(
        "part,Spring rate [lb/in],max_force,free_length,outer_diameter,wire_diameter\nA,2,10,0.1,0.01,0.001\n"
    )
    columns = {"rate": "Spring rate [lb/in]", "kind": "extension", "mass": "10 g"}
    assert read_catalogue(path, columns)[0].rate == pytest.approx(350.2536704929)
    with pytest.raises(InputError, match='--column "kind=extension"'):
        read_catalogue(path, {"rate": "Spring rate", "mass": "10 g"})
    with pytest.raises(InputError, match='--column "mass=10 g"'):
        read_catalogue(path, {"rate": "Spring rate", "kind": "extension"})
    with pytest.raises(InputError, match="no column 'ten grams'"):
        read_catalogue(path, columns | {"mass": "ten grams"})


def test_gas_and_torsion_springs(tmp_path) -> None:
    path = tmp_path / "list.csv"
    head = "part,kind,force,progression,free_length [mm],min_length [mm],mass [g],torsional_rate [N mm/rad],max_torque"
    path.write_text(f"{head}\nG,gas,100,1.3,250,150,90,,\nT,torsion,,,,,12,500,2\n")
    gas, torsion = read_catalogue(path)
    assert (gas.max_force, gas.rate, gas.stroke) == pytest.approx((130, 300, 0.1))
    assert (torsion.torsional_rate, torsion.max_torque) == pytest.approx((0.5, 2))
    path.write_text(path.read_text().replace("100,1.3,250", "100,,250"))
    with pytest.raises(InputError, match="needs max_force or progression"):
        read_catalogue(path)
