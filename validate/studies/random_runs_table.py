"""What a deep run found, as a table."""

from __future__ import annotations

from collections.abc import Sequence

from validate.output.report import table
from validate.studies.chunk_store import CHUNK, Record


def table_text(record: Record, closures: Sequence[str], kinds: Sequence[str]) -> str:
    """Every outcome by kind of strut and of scene, and the largest share of each tolerance that was used."""
    blocks = [f"Struts {closure}:\n{_outcomes(record, closure, kinds)}" for closure in closures]
    shares = record.shares()
    if shares:
        lines = [(q.replace("_", " "), f"{share:.3g}", str(scene)) for q, (share, scene) in shares.items()]
        blocks.append(
            "Where both agreed:\n" + table(("quantity", "largest share of tolerance", "scene"), lines)
        )
    seconds = sum(chunk.seconds for chunk in record.chunks.values())
    blocks.append(
        f"{len(record.chunks)} chunks of {CHUNK} scenes, {len(record.findings)} scenes written down, "
        f"{record.torn} torn lines ignored, {seconds:.0f} s."
    )
    return "\n\n".join(blocks)


def _outcomes(record: Record, closure: str, kinds: Sequence[str]) -> str:
    total = record.outcomes()
    here = [key for key in total if key.startswith(f"{closure}/")]
    outcomes = sorted({key.split("/", 2)[2] for key in here}, key=_order)
    rows = []
    for outcome in outcomes:
        counts = [total[f"{closure}/{kind}/{outcome}"] for kind in kinds]
        rows.append((outcome, str(sum(counts)), *(str(count) for count in counts)))
    tried = [sum(total[key] for key in here if key.startswith(f"{closure}/{kind}/")) for kind in kinds]
    rows.append(("mechanisms tried", str(sum(tried)), *(str(n) for n in tried)))
    return table(("outcome", "all", *kinds), rows)


def _order(outcome: str) -> tuple[int, str]:
    places = ("agreed", "not", "both refuse", "only", "disagreed")
    return next((i for i, head in enumerate(places) if outcome.startswith(head)), len(places)), outcome
