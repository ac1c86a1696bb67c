"""However badly a collinear strut is drawn, no model closes it to another assembly than the other does."""

from collections import Counter

from badly_drawn_struts import ONE, OTHER_PLACE, SAME_PLACE, badly_drawn, outcome

COUNT = 80


def test_badly_drawn_struts_close_to_the_same_assembly_in_both_models_or_are_refused() -> None:
    found = Counter(outcome(badly_drawn(number)) for number in range(COUNT))
    assert found[OTHER_PLACE] == 0
    # Of 3,000, 6.9 in a hundred that pointcoord closes are refused; 80 are off by 2.8 more at 68 %.
    assert found[ONE] <= 0.12 * (found[SAME_PLACE] + found[ONE])
    assert found[SAME_PLACE] >= 0.6 * COUNT
