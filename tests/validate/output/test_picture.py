"""The picture of a drawing shows every hardpoint where it is, and what closing does to it."""

import xml.etree.ElementTree as ET
from itertools import combinations

import numpy as np
from changed_scenes import scene_with

from pointcoord import Scene
from validate.closed_drawing import closed_drawing
from validate.output.picture import svg

SVG = "{http://www.w3.org/2000/svg}"


def drawn(scene: Scene) -> ET.Element:
    return ET.fromstring(svg(closed_drawing(scene)))


def words_of(root: ET.Element) -> str:
    return " ".join(text.text or "" for text in root.iter(f"{SVG}text"))


def numbers(one: ET.Element, *names: str) -> list[float]:
    return [float(one.get(name, "")) for name in names]


def test_every_point_stands_in_all_three_views_at_one_scale_with_a_number_that_can_be_read() -> None:
    scene = Scene.load("double-wishbone")
    root, order = drawn(scene), scene.mechanism.topology.points
    circles = np.array([numbers(c, "cx", "cy") for c in root.iter(f"{SVG}circle")])
    places = np.array([scene.mechanism.points[name] for name in order])
    views = circles.reshape(3, len(order), 2)  # from behind, from the left, from above
    x, y, z = (places - places[0]).T * 290.0 / np.ptp(places, axis=0).max()
    for view, across, down in zip(views, (y, x, y), (-z, -z, x), strict=True):
        # Coordinates are printed to a tenth of a pixel.
        assert np.abs(view - view[0] - np.stack([across, down], axis=1)).max() <= 0.11
    words = words_of(root)
    for name, place in scene.mechanism.points.items():
        assert f"{name}: {', '.join(f'{c:.6g}' for c in place)} mm" in words
    # Numbers are inside the frame, and no two in one place.
    labels = root.findall(f".//{SVG}text[@class='number']")
    for frame in root.findall(f".//{SVG}rect[@class='frame']"):
        low, width = numbers(frame, "x", "width")
        inside = [text for text in labels if low <= numbers(text, "x")[0] <= low + width]
        said = [number for text in inside for number in (text.text or "").split(", ")]
        assert sorted(said, key=int) == [str(i) for i in range(1, len(order) + 1)]
        ends = [numbers(text, "x", "y") for text in inside]
        assert min(max(abs(a - c), abs(b - d)) for (a, b), (c, d) in combinations(ends, 2)) >= 8.0
        for text, (x, _) in zip(inside, ends, strict=True):
            half = 3.2 * len(text.text or "")
            assert low <= x - half
            assert x + half <= low + width


def test_a_drawing_that_moves_when_it_closes_is_drawn_twice_and_says_so() -> None:
    still, moving = (drawn(Scene.load(name)) for name in ("off-axis-strut", "bounce"))
    assert not still.findall(f".//{SVG}line[@class='closed']")
    assert moving.findall(f".//{SVG}line[@class='closed']")
    assert "closing the drawing moves wheel_centre by 16.8 mm" in words_of(moving)


def test_points_that_fall_together_are_drawn_with_one_number() -> None:
    """A wheel centre so far away that all other points are one on the paper, and from above all of them."""
    root = drawn(scene_with("bounce", {"points": {"wheel_centre": (452.0, -410.0, -1e9)}}))
    labels = [text.text or "" for text in root.findall(f".//{SVG}text[@class='number']")]
    assert sorted(label.count(",") for label in labels) == [0, 0, 8, 8, 9]
