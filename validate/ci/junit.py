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
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from validate.ci.baseline import UNTOLD, WHY, Move, Since
from validate.ci.record import Record
from validate.comparison.compare import Comparison, Outcome
from validate.comparison.examined import Examined
from validate.output.report import about, told_row, when
from validate.plain_text import shown

UNUSABLE = "cannot be used"


def junit(record: Record) -> bytes:
    """The XML of a run."""
    root = Element("testsuites", {"name": "pointcoord validate"})
    root.extend(_suites(record))
    for total in ("tests", "failures", "errors"):
        root.set(total, str(sum(int(suite.attrib[total]) for suite in root)))
    ElementTree.indent(root, " ")
    text: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _suites(record: Record) -> Iterator[Element]:
    factor = {"tolerance_factor": repr(record.factor)}
    for examined in record.examined:
        scene = {"scene": examined.name}
        for outcome in examined.outcomes:
            first, second = (solution.formulation for solution in outcome.solutions)
            pair = {"first": first, "second": second, "instants": str(outcome.compared)}
            cases = [*(_compared(row, outcome) for row in outcome.rows), *_unusable(outcome)]
            yield _suite(f"{examined.name}: {first} and {second}", {**scene, **pair, **factor}, cases)
        if faults := [*_faults(examined)]:
            yield _suite(examined.name, scene, faults)
    baseline = {"baseline": "" if record.baseline is None else record.baseline.target}
    for since in (*record.since, *record.gone):
        properties = {"scene": since.scene, **baseline, **factor}
        yield _suite(f"{since.scene}: since the baseline", properties, [*_since(since)])
    for name in record.not_run:
        case = _case("run", "skipped", "not run", f"not run: {record.stopped}")
        yield _suite(name, {"scene": name}, [case])


def _suite(name: str, properties: Mapping[str, str], cases: Sequence[Element]) -> Element:
    name, kinds = shown(name), Counter(child.tag for case in cases for child in case)
    counts = {"failures": kinds["failure"], "errors": kinds["error"], "skipped": kinds["skipped"]}
    suite = Element("testsuite", {"name": name, "tests": str(len(cases))})
    suite.attrib |= {what: str(count) for what, count in counts.items()}
    listed = SubElement(suite, "properties")
    for key, value in properties.items():
        SubElement(listed, "property", {"name": key, "value": shown(value)})
    for case in cases:
        case.set("classname", name)
        suite.append(case)
    return suite


def _case(name: str, kind: str = "", type: str = "", message: str = "", out: Sequence[str] = ()) -> Element:
    """A test case. `kind` is empty if the case passes; `out` is its output, line by line."""
    case, lines = Element("testcase", {"classname": "", "name": shown(name)}), "\n".join(map(shown, out))
    if kind:
        attributes = {"type": shown(type), "message": shown(message)}
        SubElement(case, kind, attributes).text = lines or shown(message)
    if lines:
        SubElement(case, "system-out").text = lines
    return case


def _compared(row: Comparison, outcome: Outcome) -> Element:
    name = about(row.quantity, row.name)
    if row.why in outcome.faults:
        return _case(name, "error", UNUSABLE, f"{UNUSABLE}: {row.why}")
    if row.verdict == "not given":
        return _case(name, "skipped", row.verdict, f"not given: {row.why}")
    out = _numbers(row, "difference", "tolerance")
    out = (*out, f"tolerance limited by: {row.rests_on} ({row.part:.0%} of it)")
    if row.verdict == "not tested":
        return _case(name, "skipped", row.verdict, f"not tested: {row.why}", out)
    if row.verdict == "agrees":
        return _case(name, out=out)
    message = f"{row.first} and {row.second} disagree: {told_row(row)}"
    why = tuple(f"possible explanation: {words}" for words in outcome.explained(row))
    return _case(name, "failure", row.verdict, "; ".join((message, *why[:1])), (*out, *why))


def _unusable(outcome: Outcome) -> Iterator[Element]:
    """Cases for given data that belong to no compared number, and for a scene without a verdict."""
    reported = {row.why for row in outcome.rows}
    rest = [fault for fault in outcome.faults if fault not in reported]
    yield from (_case(f"given data, {i}", "error", UNUSABLE, one) for i, one in enumerate(rest, 1))
    if outcome.why_no_verdict and not outcome.faults:
        yield _case("verdict", "error", "no verdict", f"no verdict: {outcome.why_no_verdict}")


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


def _faults(examined: Examined) -> Iterator[Element]:
    """Cases for the reasons why a scene has no verdict."""
    if examined.problem is not None:
        yield _case("read", "error", "SceneError", examined.problem)
    for refusal in examined.refusals:
        name = f"solved by {refusal.formulation}"
        yield _case(name, "error", refusal.error, refusal.message, (f"reason: {refusal.reason}",))
    for failure in examined.failures:
        yield _case(f"solved by {failure.formulation}", "error", failure.error, failure.message)


def _since(since: Since) -> Iterator[Element]:
    if since.words:
        standing = "another formulation" if since.replaced else since.standing
        yield _case("in the baseline", "skipped" if standing in UNTOLD else "error", standing, since.words)
    for move in since.moves:
        yield _moved(move, move in since.lost)


def _moved(move: Move, lost: bool) -> Element:
    row, verdict = move.row, move.verdict
    name = f"{move.formulation}: {about(row.quantity, row.name)}"
    out = () if verdict in ("new", "gone") else _numbers(row, "moved", "bound")
    if verdict == "agrees":
        return _case(name, out=out)
    more = f": {told_row(row)}" if verdict == "moved" else ""
    kind = "failure" if lost or verdict == "moved" else "skipped"
    return _case(name, kind, verdict, f"{verdict}: {WHY[verdict]}{more}", out)
