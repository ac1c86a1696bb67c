"""The JSON Schema of every document that the program writes.

`schema.json` describes the documents. Its objects have all keys of their `properties` and no others, unless
`required` or `additionalProperties` say otherwise. The results in them describe themselves: their schemas are
derived from their classes.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue

from validate.comparison.compare import Explanation
from validate.comparison.examined import Failure
from validate.comparison.findings import Finding
from validate.cost.table import Row
from validate.fitting.fit import Combination, Fitted
from validate.formulations.refusals import Refusal
from validate.hard.answer import Answer
from validate.paper.tables import PaperRow

RESULTS: tuple[Any, ...] = (
    Explanation,
    Failure,
    Finding,
    Row,
    Combination,
    Fitted,
    Refusal,
    Answer,
    PaperRow,
)


class Generator(GenerateJsonSchema):
    """Schemas of results as they are written: with every key, and null for a number that does not exist."""

    def float_schema(self, schema: Any) -> JsonSchemaValue:
        """A number or null."""
        return {"type": ["number", "null"]}

    def field_is_required(self, field: Any, total: bool) -> bool:
        """Every field is written."""
        return True

    def default_schema(self, schema: Any) -> JsonSchemaValue:
        """The schema of a field without its default."""
        return self.generate_inner(schema["schema"])


def schema_text() -> str:
    """The JSON Schema of every document that the program writes."""
    text = Path(__file__).with_name("schema.json").read_text(encoding="utf-8")
    every: list[Any] = [(one, "serialization", TypeAdapter(one)) for one in RESULTS]
    _, found = TypeAdapter.json_schemas(every, schema_generator=Generator)
    schema = _closed(json.loads(text))
    schema["$defs"] |= found["$defs"]
    return json.dumps(schema, indent=1) + "\n"


def _closed(schema: Any) -> Any:
    """A part of `schema.json`, with `required` and `additionalProperties` added where they are missing."""
    if isinstance(schema, list):
        return [_closed(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    usual: dict[str, Any] = {"required": [*schema["properties"]]} if "properties" in schema else {}
    if usual and schema.get("type") == "object":
        usual["additionalProperties"] = False
    return {key: _closed(value) for key, value in (usual | schema).items()}
