"""A car as an MJCF file: the model that `in_mujoco` builds, in m, with x rearward, y right and z up.

The text is written by `mjSpec`, which prints six digits; positions, axes and texts are then replaced in
full.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeVar
from xml.etree import ElementTree

import mujoco
import numpy as np

from validate.peers.in_mujoco import spec_of
from validate.plain_text import shown
from validate.spanning_tree.cut import cut
from validate.spanning_tree.tree import CHASSIS, Joint, Place, SpanningTree

PlaceOrJoint = TypeVar("PlaceOrJoint", Place, Joint)

MM = 1e-3  # m
# Shares of the car's size: the radius of a point's ball and of a link.
BALL, LINK = 0.008, 0.003
LINK_COLOUR, POINT_COLOUR = [0.45, 0.5, 0.55, 1.0], [0.85, 0.3, 0.15, 1.0]
# N/m and N s/m, or N m/rad and N m s/rad, on bodies of 1 kg and 1 kg m^2: slow against MuJoCo's step of 2 ms.
STIFFNESS, DAMPING = 1000.0, 60.0
NOTE = """
 {title}

 Lengths in m; x rearward, y right, z up. In the home pose, where all joints are 0, the car is as drawn.
 Sites are its points. A rod is a body on a ball joint, and `connect` closes loops. Bodies have 1 kg and
 no weight: this is a model of motion, not of forces. Driven: {driven}.
 Texts name the roles of points, from which pointcoord import makes camber and other angles.
"""


def mjcf_of(plain: Mapping[str, Any], title: str) -> str:
    """The MJCF file of a flat mechanism; inputs that are joints of it have actuators.

    Raises:
        NoAnswer: it is not a mechanism.
    """
    tree = _in_metres(_with_joints_driven(_z_up(plain)))
    spec = spec_of(tree, tree.points)
    spec.modelname = title
    _drawn(spec, tree)
    actuators: dict[str, str] = {}
    for driven in tree.driven:
        name = driven.input if driven.input not in actuators else f"{driven.input} of {driven.body}"
        actuators[name] = driven.body
        # A spring and a damper that follow the viewer's slider.
        spec.add_actuator(
            name=name,
            target=driven.body,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            gainprm=[STIFFNESS, *[0.0] * 9],
            biasprm=[0.0, -STIFFNESS, -DAMPING, *[0.0] * 7],
        )
    for role, named in {"side": plain["side"], **plain["roles"]}.items():
        # Blanks separate the names of a text: a name with blanks gets the word that the import makes of it.
        names = (re.sub(r"\W*\s\W*", "_", one) for one in ([named] if isinstance(named, str) else named))
        spec.add_text(name=role, data=" ".join(names))
    spec.compile()
    others = ", ".join(name for name in plain["inputs"] if name not in actuators)
    driven_words = ", ".join(f"{name} (joint {joint})" for name, joint in actuators.items()) or "nothing"
    free = f"; no joint of it, and free here: {others}" if others else ""
    return _text(spec, NOTE.format(title=shown(title), driven=driven_words + free))


def _z_up(plain: Mapping[str, Any]) -> dict[str, Any]:
    """The mechanism in a car with x rearward, y right and z up."""
    up, right = np.array(plain["up"], dtype=float), np.array(plain["right"], dtype=float)
    turn = np.array([np.cross(right, up), right, up])
    points = {name: (turn @ np.array(place)).tolist() for name, place in plain["points"].items()}
    return {**plain, "points": points, "up": [0.0, 0.0, 1.0], "right": [0.0, 1.0, 0.0]}


def _with_joints_driven(plain: Mapping[str, Any]) -> SpanningTree:
    """The tree of the mechanism with only those inputs that drive a joint of the mechanism itself."""
    own = {joint.body for joint in cut({**plain, "inputs": {}}).joints}
    kept = {driven.input for driven in cut(plain).driven if driven.body in own}
    return cut({**plain, "inputs": {name: plain["inputs"][name] for name in kept}})


def _in_metres(tree: SpanningTree) -> SpanningTree:
    """The tree in m, from the origin of the car's coordinates."""

    def moved(one: PlaceOrJoint) -> PlaceOrJoint:
        return replace(one, at=np.asarray(MM * (tree.origin + tree.unit * one.at)))

    loops = tuple(replace(one, first=moved(one.first), second=moved(one.second)) for one in tree.loops)
    points = {name: moved(one) for name, one in tree.points.items()}
    return replace(tree, joints=tuple(map(moved, tree.joints)), loops=loops, points=points)


def _drawn(spec: mujoco.MjSpec, tree: SpanningTree) -> None:
    """Balls at points, and links from each body's origin to its points and loops; none of them collides."""
    size = float(np.ptp([place.at for place in tree.points.values()], axis=0).max())
    looks = {"contype": 0, "conaffinity": 0, "mass": 0.0}
    ends = [end for loop in tree.loops for end in (loop.first, loop.second)]
    every = {(one.body, *np.round(one.at, 9)): one for one in (*tree.points.values(), *ends)}
    for place in tree.points.values():
        spec.body(place.body).add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[BALL * size, 0.0, 0.0],
            pos=tree.local(place),
            rgba=POINT_COLOUR,
            **looks,
        )
    for place in every.values():
        end = tree.local(place)
        if place.body != CHASSIS and np.linalg.norm(end) > LINK * size:
            spec.body(place.body).add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                size=[LINK * size, 0.0, 0.0],
                fromto=[0.0, 0.0, 0.0, *end],
                rgba=LINK_COLOUR,
                **looks,
            )


def _text(spec: mujoco.MjSpec, note: str) -> str:
    """The file, with all digits of the positions and axes of bodies, joints and sites."""
    root = ElementTree.fromstring(spec.to_xml())
    for kind, keys in (("body", ("pos", "quat")), ("joint", ("axis",)), ("site", ("pos",))):
        for element in root.iter(kind):
            one = getattr(spec, kind)(element.get("name"))
            for key in keys if element.get("type") != "ball" else ():
                element.set(key, " ".join(repr(float(number)) for number in getattr(one, key)))
    for element in root.iter("text"):
        # MuJoCo writes a text with & < > " where it does not read it.
        element.text = None
        element.set("data", spec.text(element.get("name")).data)
    # Two hyphens would end the comment.
    root.insert(0, ElementTree.Comment(note.replace("--", "- -")))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"
