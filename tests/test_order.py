"""The order list and the page for a workshop: what is wound, what holds what, every warning, and nothing left out."""

import csv
from dataclasses import replace
from io import StringIO

import pytest
import zoo

import equipoise as eq
from equipoise.hardware import Limits, Options
from equipoise.hardware.realise.bill import bill
from equipoise.model.elements import TorsionSpring
from equipoise.model.mechanism import PointMass
from equipoise.report.order import order, order_csv
from equipoise.report.page.content import Items, Paragraph, Table
from equipoise.report.page.workshop import workshop_section


def arm() -> eq.Mechanism:
    m = zoo.pendulum()
    return replace(m, masses=(PointMass("ball", "arm", 0.5, (-0.1, 0.0, 0.0)),))


def test_it_lists_what_the_bill_winds(run, tmp_path):
    balance = eq.check(arm())
    made = bill(balance)
    (item,) = made.items
    assert item.chosen is not None
    first, *_, last = order(balance, made)
    spring = item.chosen.winding.spring
    assert (first.use, first.quantity) == ("shoulder spring", item.chosen.winding.count)
    for text in (
        f"d {1e3 * spring.d:.3g} mm",
        f"L0 {1e3 * spring.free_length:.4g} mm",
        f"R {spring.rate / 1e3:.4g} N/mm",
    ):
        assert text in first.data
    assert first.mass == spring.mass
    assert (last.use, last.data) == ("ball", "0.5 kg")
    eq.save(arm(), tmp_path / "arm.yaml")
    code, out, _ = run("export", tmp_path / "arm.yaml", "--to", "order")
    assert code == 0
    rows = list(csv.DictReader(StringIO(out)))
    assert [row["for"] for row in rows] == [line.use for line in order(balance, made)]
    assert float(rows[0]["mass_each [kg]"]) == pytest.approx(spring.mass, rel=1e-5)


def test_what_is_not_wound_has_its_numbers():
    m = arm()
    m = m.with_springs([*m.springs, TorsionSpring("=coil", (("shoulder", 1.0),), 2.0, 0.5)])
    lines = order(eq.check(m), None)
    assert [line.item for line in lines] == ["linear spring", "torsion spring", "weight"]
    assert lines[1].data.startswith("2 N m/rad, relaxed at 28.65 deg; used from -180 to 180 deg, up to ")
    assert "'=coil" in order_csv(lines)  # no formula for a spreadsheet


def test_the_page_says_what_holds_what_and_every_warning():
    balance = eq.check(arm())
    made = bill(balance, Options(limits=Limits(safety=1.0, fatigue=0.0, cycles=1e7)))
    section = workshop_section(balance, made, "2026-01-02")
    said = " ".join(
        text for one in section.blocks
        for text in ([one.text] if isinstance(one, Paragraph) else one.texts if isinstance(one, Items) else [])
    )  # fmt: skip
    use = balance.use[0]
    for text in (
        "on 2026-01-02", "from a₁ on world at (0, 0, 200) mm to b₁ on arm at (150, 0, 0) mm",
        f"50.0 to 350.0 mm long, pulls with {use.force[0]:.4g} to {use.force[1]:.4g} N",
        f"The largest force of a spring is {use.max_force:.4g} N", "m1, ball: 0.5 kg on arm at (-100, 0, 0) mm",
        *made.warnings,
    ):  # fmt: skip
        assert text in said
    assert made.warnings  # this spring breaks in the end, and the page must not hide it
    (table,) = [one for one in section.blocks if isinstance(one, Table)]
    assert len(table.rows) == len(order(balance, made))
