"""The shipped sheets: complete but for gaps without weight, plausible, and honest about what was measured."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.fabric.material import material_row, material_table
from garmentcad.fabric.missing import measured_fraction
from garmentcad.io.fabric_file import fabric_names, fabric_path, load_fabric, read_fabric

NAMES = fabric_names()
SHOWN = {"cotton-shirting": (110, 125), "wool-suiting": (200, 260), "silk-habotai": (45, 85)}  # g/m2


def test_six_or_more_from_silk_to_denim() -> None:
    assert len(NAMES) >= 6
    assert {"cotton-shirting", "wool-suiting", "silk-habotai", "denim"} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_reads_without_a_warning_and_says_where_every_value_comes_from(name: str) -> None:
    sheet = read_fabric(fabric_path(name))
    assert sheet.name == name
    assert len(sheet.description) > 20
    assert all(value.source or value.estimate for value in sheet.values().values())
    assert set(sheet.sources) == {value.source for value in sheet.values().values() if value.source}
    assert all(len(text) > 40 for text in sheet.sources.values())
    assert [finding for finding in load_fabric(fabric_path(name)).findings if finding.severity != "info"] == []


@pytest.mark.parametrize("name", NAMES)
def test_material_is_sane(name: str) -> None:
    row = material_row(load_fabric(fabric_path(name)).sheet)
    assert all(np.all(np.asarray(value) > 0.0) for value in row)
    assert 300.0 < row.tension_slope[1] <= row.tension_slope[0] < 20_000.0
    bend = np.sqrt(row.bending[0] * row.bending[1])
    assert 0.5 < 100 * (bend / (row.areal_mass * 9.81)) ** (1 / 3) < 3.0  # cm, Peirce's bending length of clothing fabrics
    assert 0.2 < row.areal_mass / row.thickness / 1000 < 0.7  # g/cm3, woven fabrics


@pytest.mark.parametrize("name", list(SHOWN))
def test_weights_of_the_shown_fabrics(name: str) -> None:
    low, high = SHOWN[name]
    assert low <= 1000 * material_row(load_fabric(fabric_path(name)).sheet).areal_mass <= high


def test_shown_fabrics_differ_in_the_right_order() -> None:
    table = material_table([material_row(load_fabric(fabric_path(name)).sheet) for name in ("silk-habotai", "cotton-shirting", "wool-suiting", "denim")])
    for column in (table.areal_mass, table.thickness, table.bending[:, 1]):
        assert np.all(np.diff(column) > 0)
    assert table.shear.argmin() == 0
    assert table.shear.argmax() == 3


def test_measured_numbers_as_published() -> None:
    """Matsudaira et al. 2015: W, T0, B, 2HB. Kumari and Khurana 2016, fabric A."""
    published = {
        "cotton-broad": {"W": 12.38, "T0": 0.497, "B.mean": 0.118, "2HB.mean": 0.124},
        "wool-tropical": {"W": 16.29, "T0": 0.407, "B.mean": 0.067, "2HB.mean": 0.033},
        "polyester-tropical": {"W": 11.65, "T0": 0.340, "B.mean": 0.077, "2HB.mean": 0.029},
        "polyester-faille": {"W": 10.43, "T0": 0.226, "B.mean": 0.019, "2HB.mean": 0.007},
        "denim": {"LT.mean": 0.712, "EMT.mean": 5.515, "G.mean": 2.18, "2HG.mean": 5.012, "2HG5.mean": 7.412, "B.mean": 0.172, "2HB.mean": 0.139},
    }
    for name, numbers in published.items():
        sheet = read_fabric(fabric_path(name))
        for key, number in numbers.items():
            assert sheet.number(key) == number, (name, key)
            value = sheet.get(key)
            assert value is not None
            assert value.source is not None


def test_measured_fraction_tells_measured_from_guessed() -> None:
    fractions = {name: measured_fraction(read_fabric(fabric_path(name))) for name in NAMES}
    assert fractions["denim"] > 0.6
    assert fractions["cotton-shirting"] == fractions["silk-habotai"] == 0.0
    assert fractions["cotton-broad"] == pytest.approx(6 / 24)
