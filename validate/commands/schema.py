"""The JSON Schema of every document that the program writes.

`schema.json` describes the documents. The results in them describe themselves: their schemas are derived from
their classes.
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
    schema = json.loads(text)
    schema["$defs"] |= found["$defs"]
    return json.dumps(schema, indent=1) + "\n"
