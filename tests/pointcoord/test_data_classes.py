"""Data classes that cost little to define are those of the standard library in everything else."""

import dataclasses
import pickle
from collections.abc import Callable
from typing import Any

import pytest

from pointcoord.data_classes import dataclass
from pointcoord.numerics.counters import Work
from pointcoord.numerics.quadratic import Product


def pair(define: Callable[..., Any]) -> tuple[Any, Any]:
    """A class with defaults and one made from it, as one of the two makes of data classes defines them."""

    @define(frozen=True)
    class Base:
        """A base."""

        one: int
        two: float = 2.0
        three: list[int] = dataclasses.field(default_factory=list)

    @define(frozen=True, repr=False)
    class Derived(Base):
        """With a field of its own, and another default."""

        two: float = 3.0
        four: str = dataclasses.field(default="4", repr=False)

    return Base, Derived


OURS, THEIRS = pair(dataclass), pair(dataclasses.dataclass)


@pytest.mark.parametrize("which", [0, 1])
def test_fields_defaults_and_arguments_are_those_of_the_standard_library(which: int) -> None:
    ours, theirs = OURS[which], THEIRS[which]
    for args, kwargs in (((1,), {}), ((1, 5.0), {}), ((), {"one": 1, "three": [3]}), ((1, 2.0, [4]), {})):
        assert dataclasses.asdict(ours(*args, **kwargs)) == dataclasses.asdict(theirs(*args, **kwargs))
    for args, kwargs in (((), {}), ((1, 2.0, [], "4", 5), {}), ((1,), {"one": 1}), ((1,), {"five": 5})):
        for kind in (ours, theirs):
            with pytest.raises(TypeError):
                kind(*args, **kwargs)
    for attribute in ("name", "type", "default", "default_factory", "repr", "compare", "init"):
        found, right = ([getattr(f, attribute) for f in dataclasses.fields(kind)] for kind in (ours, theirs))
        assert found == right
    assert ours.__match_args__ == theirs.__match_args__
    assert ours(1).three is not ours(1).three


def test_equal_ones_are_equal_and_hash_alike_and_show_their_fields() -> None:
    (base, derived), (other, _) = OURS, THEIRS
    assert base(1) == base(1, 2.0)
    assert base(1) != base(2)
    assert base(1, 3.0) != derived(1, 3.0)
    assert repr(base(1)).rpartition(".")[2] == repr(other(1)).rpartition(".")[2]
    assert repr(dataclasses.replace(base(1), two=7.0)).endswith("(one=1, two=7.0, three=[])")
    product = Product(1.0, (0, 1), (2, 3))
    assert {product: 1}[Product(1.0, (0, 1), (2, 3))] == 1
    assert pickle.loads(pickle.dumps(product)) == product


def test_those_that_are_compared_by_identity_are_equal_to_themselves_only() -> None:
    @dataclass(frozen=True, eq=False)
    class Kept:
        """Told apart by which it is."""

        value: int

    one, other = Kept(1), Kept(1)
    assert one != other
    assert len({one, other}) == 2


@pytest.mark.parametrize("define", [dataclass, dataclasses.dataclass])
def test_what_a_class_says_itself_stays(define: Callable[..., Any]) -> None:
    @define(frozen=True)
    class Spoken:
        """With words of its own, and one number that counts when two are compared."""

        value: float
        note: str = ""

        def __repr__(self) -> str:
            return f"<{self.value}>"

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Spoken) and other.value == self.value

        def __hash__(self) -> int:
            return 7

    @define(frozen=True)
    class Compared:
        """As its own comparison says, and hashed by all fields."""

        value: float

        def __eq__(self, other: object) -> bool:
            return True

    assert repr(Spoken(1.0)) == "<1.0>"
    assert Spoken(1.0, "one") == Spoken(1.0, "other")
    assert hash(Spoken(2.0)) == 7
    assert Compared(1.0) == Compared(2.0)
    assert hash(Compared(1.0)) == hash(Compared(1.0)) != hash(Compared(2.0))


def test_none_of_them_changes() -> None:
    for thing in (OURS[0](1), OURS[1](1), Work()):
        name = dataclasses.fields(thing)[0].name
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(thing, name, 2)
        with pytest.raises(dataclasses.FrozenInstanceError):
            delattr(thing, name)
    with pytest.raises(TypeError, match="standard library"):
        dataclass(frozen=False)


def test_the_standard_library_makes_classes_from_them() -> None:
    @dataclasses.dataclass(frozen=True)
    class Further(OURS[0]):
        """With one more."""

        five: int = 5

    assert dataclasses.asdict(Further(1)) == {"one": 1, "two": 2.0, "three": [], "five": 5}


def test_a_field_may_have_any_name() -> None:
    @dataclass(frozen=True)
    class Named:
        """Names that the making of a class uses too."""

        names: int
        own: str
        value: float

    assert dataclasses.astuple(Named(1, "own", 2.0)) == (1, "own", 2.0)
