"""The mutants of a module: one small change each, made by Cosmic Ray's operators and a few of our own.

A change is named by what it does to a statement: the function that the statement is in, and its text before
and after, both as Python itself writes code. Neither comments nor the layout of the source nor its line
numbers change that name. Annotations, decorators and the text of messages are left as they are.
"""

from __future__ import annotations

import ast
import hashlib
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from validate.extras import MissingPackage

# Of Cosmic Ray's 200 operators those that are errors of mathematics that somebody may make: one or two for
# each sign. All pairs would be ten times as many and tell little more.
OPERATORS = (
    *(f"ReplaceBinaryOperator_{pair}" for pair in ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul")),
    *(f"ReplaceBinaryOperator_{pair}" for pair in ("FloorDiv_Mul", "Mod_FloorDiv")),
    *(f"ReplaceBinaryOperator_{pair}" for pair in ("BitOr_BitAnd", "BitAnd_BitOr")),
    *(f"ReplaceUnaryOperator_Delete_{sign}" for sign in ("USub", "Invert", "Not")),
    *(f"ReplaceComparisonOperator_{pair}" for pair in ("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is")),
    *(f"ReplaceComparisonOperator_{pair}" for pair in ("Lt_LtE", "LtE_Lt", "Gt_GtE", "GtE_Gt")),
    *(f"ReplaceComparisonOperator_{pair}" for pair in ("Lt_GtE", "LtE_Gt", "Gt_LtE", "GtE_Lt")),
    *("ReplaceAndWithOr", "ReplaceOrWithAnd", "ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "AddNot"),
    *("ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "ZeroIterationForLoop", "NumberReplacer"),
)
# What Cosmic Ray has no operators for: assignments that add to what is there, and functions that are easily
# taken for each other.
ASSIGNMENTS = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|="}
FUNCTIONS = {"sin": "cos", "minimum": "maximum", "min": "max", "any": "all", "argmin": "argmax"}
FUNCTIONS |= {"floor": "ceil", "zeros": "ones"}
FUNCTIONS |= {other: name for name, other in FUNCTIONS.items()}
# Directions of a car, where code names them: the opposite as a word, another one as an attribute.
DIRECTIONS = {"up": "down", "inboard": "outboard", "forward": "rearward"}
DIRECTIONS |= {other: name for name, other in DIRECTIONS.items()}
ATTRIBUTES = {"up": "outboard", "outboard": "forward", "forward": "up"}

# Parts of the grammar that say something to people or to Python, and no mathematics.
WORDS = ("fstring", "decorator")
OF_TYPES = ("TYPE_CHECKING", "Literal[")


@dataclass(frozen=True)
class Change:
    """What tells a mutant from the module that it is made of, in words that outlive other edits.

    Attributes:
        module: the dotted name. function: the qualified name in it; empty for the module's own statements.
        before, after: the line of the statement that differs, as `ast.unparse` writes it.
        place: which of several that are the same in all this, from 1.
    """

    module: str
    function: str
    before: str
    after: str
    place: int = 1

    def __str__(self) -> str:
        where = f"{self.module}:{self.function}" if self.function else self.module
        again = f" (the {self.place}th of these)" if self.place > 1 else ""
        return f"{where}: {self.before}  ->  {self.after}{again}"


@dataclass(frozen=True)
class Mutant:
    """A change, the source of the whole module with it, and the lines of the statement that it is in."""

    change: Change
    source: str
    lines: range


def mutants(module: str, source: str) -> tuple[Mutant, ...]:
    """All mutants of a module.

    Raises:
        MissingPackage: Cosmic Ray is not installed.
    """
    count: Counter[Change] = Counter()
    found = []
    # Statement by statement: the cost of each change is that of reading the piece of source that it is in.
    for first, piece, before, after in _pieces(source):
        for name, old, new, text, lines in _of_piece(piece):
            change = Change(module, name, old, new)
            count[change] += 1
            where = range(lines.start + first, lines.stop + first)
            found.append(Mutant(replace(change, place=count[change]), before + text + after, where))
    return tuple(found)


def sampled(found: Sequence[Mutant], count: int | None) -> tuple[Mutant, ...]:
    """So many mutants of a module, drawn by their names: one that is drawn stays drawn for any larger count.

    Other edits of the module draw no other ones, but for those that they make or take away.
    """
    if count is None or count >= len(found):
        return tuple(found)
    drawn = sorted(found, key=lambda mutant: hashlib.sha256(str(mutant.change).encode()).digest())[:count]
    return tuple(mutant for mutant in found if mutant in set(drawn))


def _pieces(source: str) -> Iterator[tuple[int, str, str, str]]:
    """Each statement of a module: how many lines are before it, its source, and that before and after it."""
    lines = source.splitlines(keepends=True)
    for node in ast.parse(source).body:
        first = min((one.lineno for one in getattr(node, "decorator_list", ())), default=node.lineno) - 1
        last = node.end_lineno or node.lineno
        yield first, "".join(lines[first:last]), "".join(lines[:first]), "".join(lines[last:])


def _of_piece(piece: str) -> Iterator[tuple[str, str, str, str, range]]:
    """Each change: its function, the line before and after, the piece with it, the lines of the statement."""
    original = _plain(piece)
    lines, functions, statements = original.split("\n"), _functions(original), _statements(piece)
    seen = {original}
    for line, text in _changed_sources(piece):
        try:
            plain = _plain(text)
        except SyntaxError:
            continue
        # Of annotations only, or the same as another operator made.
        if plain in seen:
            continue
        seen.add(plain)
        pairs = list(zip(lines, plain.split("\n"), strict=True))
        row = next(i for i, (before, after) in enumerate(pairs) if before != after)
        before, after = (part.strip() for part in pairs[row])
        if not any(word in before for word in OF_TYPES):
            yield functions.get(row + 1, ""), before, after, text, statements.get(line, range(line, line + 1))


def _changed_sources(source: str) -> Iterator[tuple[int, str]]:
    """Line and whole source of each change that an operator can make."""
    parse, nodes_of, operators = _cosmic_ray()
    for k, node in enumerate(nodes_of(parse(source))):
        if node.search_ancestor(*WORDS):
            continue
        for operator in operators:
            for i, (start, _) in enumerate(operator.mutation_positions(node)):
                # Operators change nodes in place.
                tree = parse(source)
                target = next(other for j, other in enumerate(nodes_of(tree)) if j == k)
                parent = target.parent
                changed = operator.mutate(target, i)
                if changed is not target:
                    parent.children[[id(child) for child in parent.children].index(id(target))] = changed
                yield start[0], tree.get_code()


def _plain(source: str) -> str:
    """The code as Python writes it, without annotations of arguments, results and variables."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.returns = None
        elif isinstance(node, ast.arg):
            node.annotation = None
        elif isinstance(node, ast.AnnAssign):
            node.annotation = ast.Constant(...)
    return ast.unparse(tree)


def _functions(source: str) -> dict[int, str]:
    """The qualified name of the innermost function or class that each line is in."""
    names = {}

    def walk(node: ast.AST, inside: str) -> None:
        for child in ast.iter_child_nodes(node):
            name = inside
            if isinstance(child, ast.FunctionDef | ast.ClassDef):
                name = f"{inside}.{child.name}".lstrip(".")
                names.update(dict.fromkeys(range(child.lineno, (child.end_lineno or child.lineno) + 1), name))
            walk(child, name)

    walk(ast.parse(source), "")
    return names


def _statements(source: str) -> dict[int, range]:
    """For each line the lines of the innermost statement there; of a compound one those of its head."""
    found: dict[int, range] = {}
    for node in ast.walk(ast.parse(source)):  # outer ones first
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            end = body[0].lineno - 1 if body else node.end_lineno or node.lineno
            where = range(node.lineno, max(end, node.lineno) + 1)
            found.update(dict.fromkeys(where, where))
    return found


class ReplaceText:
    """An operator in Cosmic Ray's form: another text for some signs or names."""

    def __init__(self, kind: str, table: dict[str, str], after: str = "") -> None:
        self.kind, self.table, self.after = kind, table, after

    def mutation_positions(self, node: Any) -> Iterator[Any]:
        """The node itself, if it is one of them."""
        if node.type != self.kind or node.value not in self.table:
            return
        if not self.after or node.get_previous_leaf() == self.after:
            yield node.start_pos, node.end_pos

    def mutate(self, node: Any, index: int) -> Any:
        """The node with the other text."""
        node.value = self.table[node.value]
        return node


@cache
def _cosmic_ray() -> tuple[Any, Any, tuple[Any, ...]]:
    """Cosmic Ray's parser, its walk over nodes, and the operators."""
    try:
        from cosmic_ray.ast import ast_nodes, get_ast
        from cosmic_ray.operators.provider import OperatorProvider
    except ImportError as error:
        raise MissingPackage("mutants", error, "mutants") from error
    given = OperatorProvider()
    words = {f'"{word}"': f'"{other}"' for word, other in DIRECTIONS.items()}
    own = (
        ReplaceText("operator", ASSIGNMENTS),
        ReplaceText("name", FUNCTIONS),
        ReplaceText("string", words),
        ReplaceText("name", ATTRIBUTES, after="."),
    )
    return get_ast, ast_nodes, (*(given[name]() for name in OPERATORS), *own)


def source_of(root: Path, module: str) -> Path:
    """The file of a module in a folder of packages."""
    place = root.joinpath(*module.split("."))
    return place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
