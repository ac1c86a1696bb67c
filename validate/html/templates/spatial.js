"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const STEP = 0.1;
  const KEYS = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP] };
  // Rotation about the car's vertical axis, from the view from behind, then tilt towards the viewer.
  const VIEWS = { Oblique: [0.6, 0.35], Rear: [0, 0], Right: [Math.PI / 2, 0], Top: [0, Math.PI / 2] };
  const WIDE = 480, NEAR = 24, ROW = 14, PAD = 40, TRIAD = 26;
  // Possible positions of a label: on the outer or inner side of its point, and rows below it.
  const STANDS = [0, -0.8, 0.8, -1.6, 1.6, -2.4, 2.4, -3.2, 3.2].flatMap((down) => [[1, down], [-1, down]]);
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  // Boxes: left, right, top, bottom.
  const around = ([x, y], half) => [x - half, x + half, y - half, y + half];
  const meet = (a, b) => a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3];

  function add(parent, tag, attributes, text) {
    const one = parent.appendChild(document.createElementNS(SVG, tag));
    set(one, attributes);
    if (text !== undefined) one.textContent = text;
    return one;
  }

  function set(one, attributes) {
    for (const [name, value] of Object.entries(attributes))
      one.setAttribute(name, typeof value === "number" ? value.toFixed(2) : value);
  }

  function start(figure) {
    const motion = JSON.parse(figure.dataset.motion);
    const scene = figure.dataset.scene;
    const [svg, button, slider, output] = ["svg", "button", "input", "output"].map((n) => figure.querySelector(n));
    const choices = figure.querySelector("[role=group]");
    const count = motion.times.length;
    let [turn, tilt] = VIEWS.Oblique;
    let timer = null, near = null, scale = 1, size = [1, 1];

    // The first model has wide lines and the second narrow ones on top, so that both are visible where they agree.
    const ways = [["tube", "core"], ["thread"]];
    const sets = motion.models.map((model, i) => ({
      name: model.name, strokes: ways[i] ?? ["thread"], places: (frame) => model.frames[frame],
    }));
    if (motion.closed) sets.unshift({ name: "the drawing, closed", strokes: ["closed"], places: () => motion.closed });
    sets.unshift({ name: "the drawing", strokes: ["drawn"], places: () => motion.drawn });
    for (const one of sets) {
      one.group = add(svg, "g", {});
      one.lines = one.strokes.map((stroke) => motion.lines.map(() => add(one.group, "line", { class: stroke })));
    }
    // A model may not give every point: a joint is placed by the first model that gives it, or else as drawn.
    const places = (frame) => motion.drawn.map((place, i) =>
      motion.models.map((model) => model.frames[frame][i]).find((given) => given) ?? place);
    const joints = motion.points.map((name, i) => {
      const chassis = motion.chassis.includes(i);
      const shape = chassis ? add(svg, "rect", { width: 8, height: 8 }) : add(svg, "circle", { r: 3.5 });
      shape.setAttribute("class", chassis ? "joint chassis" : "joint");
      return shape;
    });
    const names = motion.points.map((name) => add(svg, "text", {}, name));
    const wide = [], stands = [];
    const triad = add(svg, "g", { class: "triad" });
    const arms = ["right", "rear", "up"].map((name) => [add(triad, "line", {}), add(triad, "text", {}, name)]);

    function choice(words, checked, changed, stroke) {
      const label = choices.appendChild(document.createElement("label"));
      const box = label.appendChild(document.createElement("input"));
      Object.assign(box, { type: "checkbox", checked });
      if (stroke) {
        const key = add(label, "svg", { class: "key", viewBox: "0 0 28 12", "aria-hidden": "true" });
        for (const one of stroke) add(key, "line", { class: one, x1: 4, y1: 6, x2: 24, y2: 6 });
      }
      label.append(words);
      box.addEventListener("change", () => changed(box.checked));
      return box;
    }

    for (const [name, angles] of Object.entries(VIEWS)) {
      const view = choices.appendChild(document.createElement("button"));
      view.type = "button";
      view.textContent = name;
      view.setAttribute("aria-label", `${name} view of ${scene}`);
      view.addEventListener("click", () => {
        [turn, tilt] = angles;
        stands.length = 0;
        draw();
      });
    }
    const still = sets.length - motion.models.length;
    for (const one of [...sets.slice(still), ...sets.slice(0, still)])
      choice(one.name, true, (shown) => { one.group.style.display = shown ? "" : "none"; }, one.strokes);
    const named = choice("names", (figure.clientWidth || innerWidth) >= WIDE, () => draw());
    named.parentElement.className = "names";

    // Centre and radius of a sphere around all points at all instants: it fits the window in every view.
    const all = [motion.drawn, ...motion.models.flatMap((model) => model.frames)].flat().filter((place) => place);
    const low = [0, 1, 2].map((i) => all.reduce((m, p) => Math.min(m, p[i]), Infinity));
    const high = [0, 1, 2].map((i) => all.reduce((m, p) => Math.max(m, p[i]), -Infinity));
    const middle = low.map((value, i) => (value + high[i]) / 2);
    const radius = all.reduce((m, p) => Math.max(m, Math.hypot(...p.map((value, i) => value - middle[i]))), 1e-9);

    function flat(vector) {
      const [right, rear, up] = motion.axes.map((axis) => dot(vector, axis));
      const across = Math.cos(turn) * right - Math.sin(turn) * rear;
      const toward = Math.sin(turn) * right + Math.cos(turn) * rear;
      return [across, -(Math.cos(tilt) * up - Math.sin(tilt) * toward)];
    }

    function project(place) {
      return flat(place.map((value, i) => value - middle[i])).map((value) => scale * value);
    }

    // A label is placed where it covers no joint and no other label, and no line if possible. It stays there as
    // long as the place is free. If there is no free place, the label is shown only under the pointer.
    function drawNames(at, corner) {
      const taken = [...at.map((place) => around(place, 4)), around(corner, 1.4 * TRIAD)];
      const lines = motion.lines.flatMap(([a, b]) => {
        const steps = Math.ceil(Math.hypot(at[b][0] - at[a][0], at[b][1] - at[a][1]) / ROW);
        return Array.from({ length: steps }, (_, k) =>
          around([0, 1].map((i) => at[a][i] + (at[b][i] - at[a][i]) * (k + 0.5) / steps), 3));
      });
      names.forEach((name, i) => {
        const shown = named.checked || i === near;
        name.style.display = shown ? "" : "none";
        if (!shown) return;
        wide[i] ??= name.getComputedTextLength();
        const out = at[i][0] < 0 ? -1 : 1;
        const tried = [...(stands[i] ? [stands[i]] : []), ...STANDS.map(([side, down]) => [out * side, down])];
        const boxes = tried.map(([side, down]) => {
          const left = Math.min(Math.max(at[i][0] + (side > 0 ? 8 : -8 - wide[i]), 3 - size[0] / 2),
            size[0] / 2 - wide[i] - 3);
          return [left, left + wide[i], at[i][1] + ROW * (down - 0.5), at[i][1] + ROW * (down + 0.5), side, down];
        });
        const free = boxes.filter((box) => !taken.some((other, j) => j !== i && meet(box, other)));
        const best = free.find((box) => !lines.some((other) => meet(box, other))) ?? free[0] ?? boxes[0];
        if (!free.length && i !== near) {
          name.style.display = "none";
          return;
        }
        stands[i] = best.slice(4);
        taken.push(best);
        set(name, { x: best[0], y: best[3] - 3 });
      });
    }

    function draw() {
      const frame = Number(slider.value);
      for (const { lines, places } of sets) {
        const at = places(frame).map((place) => place && project(place));
        for (const stroke of lines)
          motion.lines.forEach(([a, b], i) => {
            const there = at[a] && at[b];
            stroke[i].style.display = there ? "" : "none";
            if (there) set(stroke[i], { x1: at[a][0], y1: at[a][1], x2: at[b][0], y2: at[b][1] });
          });
      }
      const at = places(frame).map(project);
      joints.forEach((joint, i) => {
        const [x, y] = at[i];
        set(joint, joint.tagName === "rect" ? { x: x - 4, y: y - 4 } : { cx: x, cy: y });
      });
      const corner = [TRIAD + 14 - size[0] / 2, size[1] / 2 - TRIAD - 14];
      drawNames(at, corner);
      arms.forEach(([line, text], i) => {
        const [x, y] = flat(motion.axes[i]).map((value) => TRIAD * value);
        const seen = Math.hypot(x, y) > TRIAD / 4;
        set(line, { x1: corner[0], y1: corner[1], x2: corner[0] + x, y2: corner[1] + y });
        set(text, { x: corner[0] + 1.25 * x - 8, y: corner[1] + 1.25 * y + 4 });
        text.style.display = seen ? "" : "none";
      });
      output.textContent = motion.models.length ? `${motion.times[frame]} s` : "as drawn";
      slider.setAttribute("aria-valuetext", output.textContent);
    }

    function rotate(by) {
      turn += by[0];
      tilt = Math.min(Math.max(tilt + by[1], -Math.PI / 2), Math.PI / 2);
      draw();
    }

    // Who wants little motion sees some twenty pictures, each for a while.
    function play() {
      if (timer !== null) {
        clearInterval(timer);
        timer = null;
      } else {
        const [stride, wait] = calm.matches ? [Math.ceil(count / 20), 600] : [1, 40];
        timer = setInterval(() => {
          slider.value = (Number(slider.value) + stride) % count;
          draw();
        }, wait);
      }
      button.textContent = timer === null ? "Play" : "Stop";
      button.setAttribute("aria-label", `${button.textContent} the motion of ${scene}`);
    }

    slider.addEventListener("input", draw);
    button.addEventListener("click", play);
    svg.addEventListener("keydown", (event) => {
      if (!(event.key in KEYS) || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      rotate(KEYS[event.key]);
    });
    let held = null;
    svg.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      svg.setPointerCapture(event.pointerId);
    });
    for (const kind of ["pointerup", "pointercancel"]) svg.addEventListener(kind, () => { held = null; });
    svg.addEventListener("pointermove", (event) => {
      if (held !== null) {
        rotate([0.01 * (event.clientX - held[0]), 0.01 * (event.clientY - held[1])]);
        held = [event.clientX, event.clientY];
        return;
      }
      const box = svg.getBoundingClientRect();
      const from = [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
      const far = places(Number(slider.value)).map(project).map((p) => Math.hypot(p[0] - from[0], p[1] - from[1]));
      const nearest = far.indexOf(Math.min(...far));
      near = far[nearest] < NEAR ? nearest : null;
      if (!named.checked) draw();
    });
    svg.addEventListener("pointerleave", () => {
      near = null;
      draw();
    });
    // The drawing's units are those of the window, so that letters are as large as the page's.
    new ResizeObserver(() => {
      const { width, height } = svg.getBoundingClientRect();
      if (!width || document.documentElement.classList.contains("printed")) return;
      size = [width, height];
      stands.length = 0;
      scale = (Math.min(width, height) - PAD) / 2 / radius;
      svg.setAttribute("viewBox", `${-width / 2} ${-height / 2} ${width} ${height}`);
      draw();
    }).observe(svg);
  }

  document.querySelectorAll("[data-motion]").forEach(start);
})();
