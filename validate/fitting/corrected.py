"""The corrected scene as a file."""

from __future__ import annotations

from validate.fitting.fit import Fit
from validate.fitting.words import counted
from validate.plain_text import shown
from validate.toml_written import written


def corrected_text(fit: Fit, name: str, source: str) -> str:
    """A scene file (TOML) of the corrected car, with what was done to it in comments."""
    content = fit.scene.model_dump(exclude_none=True)
    before = [f"# {shown(name)}, its hardpoints fitted to {shown(source)}."]
    for unit in dict.fromkeys(column.unit for column in fit.columns):
        first, last, _ = fit.rms(unit)
        before.append(f"# r.m.s. difference {first:.4g} {unit} before, {last:.4g} {unit} after.")
    if not fit.unique:
        before.append(f"# Not unique: the data do not see {counted(len(fit.unseen))} of coordinates.")
    before += [
        f"# {one} moved by {amount:+z.4f} mm, "
        + (
            "which is its bound."
            if one in fit.on_bounds
            else f"standard deviation {fit.deviations[one]:.2g} mm."
        )
        for one, amount in fit.corrections.items()
    ]
    return "\n".join([*before, *written(content)]) + "\n"
