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
from collections.abc import Iterable, Iterator, Mapping, Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from validate.ci.baseline import UNTOLD, WHY, Since
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
            yield _suite(f"{examined.name}: {first} and {second}", scene | pair | factor, _cases(outcome))
        if faults := [*_faults(examined)]:
            yield _suite(examined.name, scene, faults)
    baseline = {"baseline": "" if record.baseline is None else record.baseline.target}
    for since in (*record.since, *record.gone):
        properties = {"scene": since.scene, **baseline, **factor}
        yield _suite(f"{since.scene}: since the baseline", properties, _moves(since))
    for name in record.not_run:
        case = _case("run", "skipped", "not run", f"not run: {record.stopped}")
        yield _suite(name, {"scene": name}, [case])


def _suite(name: str, properties: Mapping[str, str], found: Iterable[Element]) -> Element:
    name, cases = shown(name), [*found]
    kinds = Counter(child.tag for case in cases for child in case)
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


def _cases(outcome: Outcome) -> Iterator[Element]:
    """A case for each row, for given data that belong to no row, and for a scene without a verdict."""
    for row in outcome.rows:
        name, out = about(row.quantity, row.name), _numbers(row, "difference", "tolerance")
        out += [f"tolerance limited by: {row.rests_on} ({row.part:.0%} of it)"]
        if row.why in outcome.faults:
            yield _case(name, "error", UNUSABLE, f"{UNUSABLE}: {row.why}")
        elif row.verdict == "disagrees":
            why = [f"possible explanation: {words}" for words in outcome.explained(row)]
            message = "; ".join((f"{row.first} and {row.second} disagree: {told_row(row)}", *why[:1]))
            yield _case(name, "failure", row.verdict, message, out + why)
        elif row.verdict == "agrees":
            yield _case(name, out=out)
        else:
            numbers = out if row.verdict == "not tested" else ()
            yield _case(name, "skipped", row.verdict, f"{row.verdict}: {row.why}", numbers)
    reported = {row.why for row in outcome.rows}
    rest = [fault for fault in outcome.faults if fault not in reported]
    yield from (_case(f"given data, {i}", "error", UNUSABLE, one) for i, one in enumerate(rest, 1))
    if outcome.why_no_verdict and not outcome.faults:
        yield _case("verdict", "error", "no verdict", f"no verdict: {outcome.why_no_verdict}")


def _numbers(row: Comparison, gap: str, bound: str) -> list[str]:
    def line(what: str, value: float, unit: str) -> str:
        return f"{what}: {f'{value:.6g} {unit}'.rstrip() if math.isfinite(value) else 'not a number'}"

    sizes = [line(gap, row.difference, row.unit), line(bound, row.tolerance, row.unit)]
    return [*sizes, line(f"{gap} / {bound}", row.share, ""), f"instant: {when(row)}"]


def _faults(examined: Examined) -> Iterator[Element]:
    """Cases for the reasons why a scene has no verdict."""
    if examined.problem is not None:
        yield _case("read", "error", "SceneError", examined.problem)
    for refusal in examined.refusals:
        name = f"solved by {refusal.formulation}"
        yield _case(name, "error", refusal.error, refusal.message, (f"reason: {refusal.reason}",))
    for failure in examined.failures:
        yield _case(f"solved by {failure.formulation}", "error", failure.error, failure.message)


def _moves(since: Since) -> Iterator[Element]:
    """A case for a scene that is not compared as it was, and for each number then or now."""
    if since.words:
        standing = "another formulation" if since.replaced else since.standing
        yield _case("in the baseline", "skipped" if standing in UNTOLD else "error", standing, since.words)
    for move in since.moves:
        row, verdict = move.row, move.verdict
        name = f"{move.formulation}: {about(row.quantity, row.name)}"
        out = [] if verdict in ("new", "gone") else _numbers(row, "moved", "bound")
        if verdict == "agrees":
            yield _case(name, out=out)
        else:
            more = f": {told_row(row)}" if verdict == "moved" else ""
            kind = "failure" if verdict == "moved" or move in since.lost else "skipped"
            yield _case(name, kind, verdict, f"{verdict}: {WHY[verdict]}{more}", out)
