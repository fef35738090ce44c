"""JUnit XML, as continuous integration servers read it: a suite for each garment test, a case for each assertion."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as xml

from garmentcad.io.atomic import write_atomic
from garmentcad.io.garment_test_file import distinct_names
from garmentcad.regression.trial import Judgement

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # characters that XML 1.0 cannot hold


def write_junit(path: Path, judgements: Sequence[Judgement]) -> Path:
    """Write the outcome of tests. The drape's time stands at the suite and at its first case."""
    root = xml.Element("testsuites", name="garmentcad test")
    totals = {"tests": 0, "failures": 0, "errors": 0}
    for test, judged in zip(distinct_names([judged.case for judged in judgements]), judgements):
        suite = xml.SubElement(root, "testsuite", name=_text(test), file=_text(str(judged.case.file)), time=f"{judged.wall_s:.3f}")
        counts = {"tests": len(judged.verdicts), "failures": sum(not verdict.passed for verdict in judged.verdicts), "errors": 0}
        for index, verdict in enumerate(judged.verdicts):
            case = _case(suite, test, verdict.key, judged.wall_s if index == 0 else 0.0)
            if not verdict.passed:
                xml.SubElement(case, "failure", message=_text(f"expected {verdict.expected}, came {verdict.came}"), type="assertion")
        if judged.refusal is not None:
            counts |= {"tests": counts["tests"] + 1, "errors": 1}
            xml.SubElement(_case(suite, test, "drape", judged.wall_s), "error", message=_text(judged.refusal), type="refused")
        if judged.files:
            xml.SubElement(suite, "system-out").text = _text("\n".join(str(file) for file in judged.files))
        for name, count in counts.items():
            suite.set(name, str(count))
            totals[name] += count
    for name, count in totals.items():
        root.set(name, str(count))
    root.set("time", f"{sum(judged.wall_s for judged in judgements):.3f}")
    xml.indent(root)
    return write_atomic(path, xml.tostring(root, encoding="utf-8", xml_declaration=True))


def _case(suite: xml.Element, test: str, name: str, wall_s: float) -> xml.Element:
    return xml.SubElement(suite, "testcase", classname=_text(test), name=_text(name), time=f"{wall_s:.3f}")


def _text(text: str) -> str:
    return _NOT_XML.sub("?", text)
