"""What the schema `junit-10.xsd` of Jenkins' xUnit plugin allows, as far as it is used here."""

from xml.etree.ElementTree import Element, fromstring

TEXT = {"type", "message"}
# By element: attributes that it must have, those that it may have, and its children in their order.
RULES: dict[str, tuple[set[str], set[str], tuple[str, ...]]] = {
    "testsuites": (set(), {"name", "time", "tests", "failures", "errors"}, ("testsuite",)),
    "testsuite": (
        {"name", "tests", "failures", "errors"},
        {"skipped", "time", "timestamp", "hostname", "id", "package"},
        ("properties", "testcase", "system-out", "system-err"),
    ),
    "properties": (set(), set(), ("property",)),
    "property": ({"name", "value"}, set(), ()),
    "testcase": (
        {"name"},
        {"classname", "time"},
        ("skipped", "error", "failure", "system-out", "system-err"),
    ),
    "failure": (set(), TEXT, ()),
    "error": (set(), TEXT, ()),
    "skipped": (set(), TEXT, ()),
    "system-out": (set(), set(), ()),
}
KINDS = {"failures": "failure", "errors": "error", "skipped": "skipped"}


def checked(data: bytes) -> Element:
    """The document, which keeps to the rules and whose counts are those of its cases."""
    root = fromstring(data)
    assert root.tag == "testsuites"
    for element in root.iter():
        must, may, children = RULES[element.tag]
        assert must <= {*element.keys()} <= must | may, element.attrib
        tags = [child.tag for child in element]
        assert set(tags) <= set(children)
        assert tags == sorted(tags, key=children.index), tags
    for suite in root.iter("testsuite"):
        cases = suite.findall("testcase")
        assert suite.get("tests") == str(len(cases))
        for count, kind in KINDS.items():
            assert suite.get(count) == str(sum(case.find(kind) is not None for case in cases))
        names = [case.get("name") for case in cases]
        assert len(set(names)) == len(names)
        assert all(sum(case.find(kind) is not None for kind in KINDS.values()) <= 1 for case in cases)
    for count in ("tests", "failures", "errors"):
        assert root.get(count) == str(sum(int(suite.get(count, "")) for suite in root))
    return root
