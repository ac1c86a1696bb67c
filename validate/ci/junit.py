"""A run as JUnit XML, which services for continuous integration show as test results.

A suite is a comparison of a scene; a case is one quantity of one point, body or angle. The `system-out` of a
case has a line each for difference, tolerance, difference / tolerance and instant, also if the case passes.

| in the run | in the file |
|---|---|
| agrees | a case that passes |
| disagrees, moved since the baseline, or given in the baseline and not now | `failure` |
| not tested, not given, new since the baseline, not run | `skipped`, with the reason |
| gone with a formulation that this run does not use | `skipped` |
| given data that cannot be used, or that test nothing | `error` |
| a scene that cannot be read, is refused, or fails | `error` |
| another car or another formulation than in the baseline | `error` |

Elements, attributes and their order follow the schema `junit-10.xsd` of Jenkins' xUnit plugin. The schema
requires no times, and none are written: equal runs give equal bytes.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from validate.ci.baseline import UNTOLD, WHY, Move, Since
from validate.ci.record import Record
from validate.comparison.compare import Comparison, Outcome
from validate.comparison.examined import Examined
from validate.output.report import about, told_row, when
from validate.plain_text import shown

UNUSABLE = "cannot be used"
KINDS = {"failures": "failure", "errors": "error", "skipped": "skipped"}


@dataclass(frozen=True)
class _Case:
    """A test case. `kind` is "" if the case passes; `out` is its output, line by line."""

    name: str
    kind: str = ""
    type: str = ""
    message: str = ""
    out: tuple[str, ...] = ()


Suite = tuple[str, Mapping[str, str], Sequence[_Case]]


def junit(record: Record) -> bytes:
    """The XML of a run."""
    root = ElementTree.Element("testsuites", {"name": "pointcoord validate"})
    for suite in _suites(record):
        root.append(_element(*suite))
    for total in ("tests", "failures", "errors"):
        root.set(total, str(sum(int(suite.attrib[total]) for suite in root)))
    ElementTree.indent(root, " ")
    text: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _suites(record: Record) -> Iterator[Suite]:
    factor = {"tolerance_factor": repr(record.factor)}
    for examined in record.examined:
        scene = {"scene": examined.name}
        for outcome in examined.outcomes:
            first, second = (solution.formulation for solution in outcome.solutions)
            pair = {"first": first, "second": second, "instants": str(outcome.compared)}
            cases = [*(_compared(row, outcome) for row in outcome.rows), *_unusable(outcome)]
            yield f"{examined.name}: {first} and {second}", {**scene, **pair, **factor}, cases
        if faults := [*_faults(examined)]:
            yield examined.name, scene, faults
    baseline = {"baseline": "" if record.baseline is None else record.baseline.target}
    for since in (*record.since, *record.gone):
        properties = {"scene": since.scene, **baseline, **factor}
        yield f"{since.scene}: since the baseline", properties, [*_since(since)]
    for name in record.not_run:
        yield name, {"scene": name}, [_Case("run", "skipped", "not run", f"not run: {record.stopped}")]


def _element(name: str, properties: Mapping[str, str], cases: Sequence[_Case]) -> ElementTree.Element:
    name, kinds = shown(name), Counter(case.kind for case in cases)
    counts = {key: str(kinds[kind]) for key, kind in KINDS.items()}
    suite = ElementTree.Element("testsuite", {"name": name, "tests": str(len(cases)), **counts})
    listed = ElementTree.SubElement(suite, "properties")
    for key, value in properties.items():
        ElementTree.SubElement(listed, "property", {"name": key, "value": shown(value)})
    for case in cases:
        element = ElementTree.SubElement(suite, "testcase", {"classname": name, "name": shown(case.name)})
        lines = "\n".join(map(shown, case.out))
        if case.kind:
            ends = {"type": shown(case.type), "message": shown(case.message)}
            ElementTree.SubElement(element, case.kind, ends).text = lines or shown(case.message)
        if lines:
            ElementTree.SubElement(element, "system-out").text = lines
    return suite


def _compared(row: Comparison, outcome: Outcome) -> _Case:
    name = about(row.quantity, row.name)
    if row.why in outcome.faults:
        return _Case(name, "error", UNUSABLE, f"{UNUSABLE}: {row.why}")
    if row.verdict == "not given":
        return _Case(name, "skipped", row.verdict, f"not given: {row.why}")
    out = _numbers(row, "difference", "tolerance")
    out = (*out, f"tolerance limited by: {row.rests_on} ({row.part:.0%} of it)")
    if row.verdict == "not tested":
        return _Case(name, "skipped", row.verdict, f"not tested: {row.why}", out)
    if row.verdict == "agrees":
        return _Case(name, out=out)
    message = f"{row.first} and {row.second} disagree: {told_row(row)}"
    why = tuple(f"possible explanation: {words}" for words in outcome.explained(row))
    return _Case(name, "failure", row.verdict, "; ".join((message, *why[:1])), (*out, *why))


def _unusable(outcome: Outcome) -> Iterator[_Case]:
    """Cases for given data that belong to no compared number, and for a scene without a verdict."""
    reported = {row.why for row in outcome.rows}
    rest = [fault for fault in outcome.faults if fault not in reported]
    yield from (_Case(f"given data, {i}", "error", UNUSABLE, one) for i, one in enumerate(rest, 1))
    if outcome.why_no_verdict and not outcome.faults:
        yield _Case("verdict", "error", "no verdict", f"no verdict: {outcome.why_no_verdict}")


def _numbers(row: Comparison, gap: str, bound: str) -> tuple[str, ...]:
    values = (
        (gap, row.difference, row.unit),
        (bound, row.tolerance, row.unit),
        (f"{gap} / {bound}", row.share, ""),
    )
    lines = [
        f"{what}: {f'{value:.6g} {unit}'.rstrip() if math.isfinite(value) else 'not a number'}"
        for what, value, unit in values
    ]
    return (*lines, f"instant: {when(row)}")


def _faults(examined: Examined) -> Iterator[_Case]:
    """Cases for the reasons why a scene has no verdict."""
    if examined.problem is not None:
        yield _Case("read", "error", "SceneError", examined.problem)
    for refusal in examined.refusals:
        name = f"solved by {refusal.formulation}"
        yield _Case(name, "error", refusal.error, refusal.message, (f"reason: {refusal.reason}",))
    for failure in examined.failures:
        yield _Case(f"solved by {failure.formulation}", "error", failure.error, failure.message)


def _since(since: Since) -> Iterator[_Case]:
    if since.words:
        standing = "another formulation" if since.replaced else since.standing
        yield _Case("in the baseline", "skipped" if standing in UNTOLD else "error", standing, since.words)
    for move in since.moves:
        yield _moved(move, move in since.lost)


def _moved(move: Move, lost: bool) -> _Case:
    row, verdict = move.row, move.verdict
    name = f"{move.formulation}: {about(row.quantity, row.name)}"
    out = () if verdict in ("new", "gone") else _numbers(row, "moved", "bound")
    if verdict == "agrees":
        return _Case(name, out=out)
    more = f": {told_row(row)}" if verdict == "moved" else ""
    kind = "failure" if lost or verdict == "moved" else "skipped"
    return _Case(name, kind, verdict, f"{verdict}: {WHY[verdict]}{more}", out)
