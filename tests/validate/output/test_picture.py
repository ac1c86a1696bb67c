"""The picture of a drawing shows every hardpoint where it is, and what closing does to it."""

import xml.etree.ElementTree as ET
from itertools import combinations

import numpy as np
from changed_scenes import scene_with

from pointcoord import Scene
from validate.closed_drawing import closed_drawing
from validate.output.picture import svg

SVG = "{http://www.w3.org/2000/svg}"


def test_every_point_stands_in_all_three_views_at_one_scale_with_a_number_that_can_be_read() -> None:
    scene = Scene.load("double-wishbone")
    root = ET.fromstring(svg(closed_drawing(scene)))
    circles = [(float(c.get("cx", "")), float(c.get("cy", ""))) for c in root.iter(f"{SVG}circle")]
    points = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    order = scene.mechanism.topology.points
    assert len(circles) == 3 * len(order)
    behind, left, above = (
        dict(zip(order, np.array(circles[i * len(order) : (i + 1) * len(order)]), strict=True))
        for i in range(3)
    )
    span = max(float(np.ptp([p[i] for p in points.values()])) for i in range(3))
    for one in order:
        for other in order:
            x, y, z = (points[one] - points[other]) * 290.0 / span
            # Coordinates are printed to a tenth of a pixel.
            assert np.abs(behind[one] - behind[other] - [y, -z]).max() <= 0.11
            assert np.abs(left[one] - left[other] - [x, -z]).max() <= 0.11
            assert np.abs(above[one] - above[other] - [y, x]).max() <= 0.11
    words = " ".join(text.text or "" for text in root.iter(f"{SVG}text"))
    for name, place in points.items():
        assert f"{name}: {', '.join(f'{c:.6g}' for c in place)} mm" in words
    # Numbers are inside the frame, and no two in one place.
    labels = [text for text in root.iter(f"{SVG}text") if text.get("class") == "number"]
    frames = [
        (float(f.get("x", "")), float(f.get("x", "")) + float(f.get("width", "")))
        for f in root.iter(f"{SVG}rect")
        if f.get("class") == "frame"
    ]
    for low, high in frames:
        inside = [text for text in labels if low <= float(text.get("x", "")) <= high]
        told = [number for text in inside for number in (text.text or "").split(", ")]
        assert sorted(told, key=int) == [str(i) for i in range(1, len(order) + 1)]
        places = [(float(text.get("x", "")), float(text.get("y", ""))) for text in inside]
        gaps = [max(abs(a - c), abs(b - d)) for (a, b), (c, d) in combinations(places, 2)]
        assert min(gaps) >= 8.0
        for text in inside:
            half = 3.2 * len(text.text or "")
            assert low <= float(text.get("x", "")) - half
            assert float(text.get("x", "")) + half <= high


def test_a_drawing_that_moves_when_it_closes_is_drawn_twice_and_says_so() -> None:
    still, moving = (
        ET.fromstring(svg(closed_drawing(Scene.load(name)))) for name in ("off-axis-strut", "bounce")
    )
    assert not still.findall(f".//{SVG}line[@class='closed']")
    assert moving.findall(f".//{SVG}line[@class='closed']")
    words = " ".join(text.text or "" for text in moving.iter(f"{SVG}text"))
    assert "closing the drawing moves wheel_centre by 16.8 mm" in words


def test_points_that_fall_together_are_drawn_with_one_number() -> None:
    """A wheel centre so far away that all other points are one on the paper, and from above all of them."""
    scene = scene_with("bounce", {"points": {"wheel_centre": (452.0, -410.0, -1e9)}})
    root = ET.fromstring(svg(closed_drawing(scene)))
    numbers = [text.text or "" for text in root.findall(f".//{SVG}text[@class='number']")]
    assert sorted(number.count(",") for number in numbers) == [0, 0, 8, 8, 9]
