"""The rules for missing values agree with what laboratories measured, and the committed page says how well."""

from __future__ import annotations

import numpy as np

from garmentcad.io.kes_csv import read_kes_csv
from tools.rule_study import FOLDER, check_rules, measured, page

SHEETS, FINDINGS = read_kes_csv(FOLDER / "measured-fabrics.csv")
CHECKS = check_rules({sheet.name: measured(sheet) for sheet in SHEETS})


def test_every_measured_row_is_understood() -> None:
    assert FINDINGS == ()
    assert len(SHEETS) == 33
    assert all(sheet.source and len(sheet.source) > 20 for sheet in SHEETS)


def test_no_rule_is_contradicted() -> None:
    """The quartiles of rule over measured hold 1, or the median is off by at most 20 %."""
    for rule, ratios in CHECKS:
        low, middle, high = np.percentile(ratios, (25, 50, 75))
        assert low <= 1.0 <= high or abs(middle - 1.0) <= 0.2, (rule.key, rule.text, low, middle, high)


def test_one_ratio_by_hand() -> None:
    """Denim A of Kumari and Khurana: G 2.18, 2HG 5.012."""
    (check,) = [check for check in CHECKS if check.rule.text == "2 degrees x G"]
    assert 2 * 2.18 / 5.012 in check.ratios
    assert len(check.ratios) == 6


def test_page_is_current() -> None:
    assert (FOLDER / "fabric-rules.md").read_text(encoding="utf-8") == page(CHECKS)
