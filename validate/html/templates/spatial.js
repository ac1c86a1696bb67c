"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const KEYS = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  function start(figure) {
    const motion = JSON.parse(figure.dataset.motion);
    const [svg, button, slider, output] = ["svg", "button", "input", "output"].map((n) => figure.querySelector(n));
    const sets = [["drawn", () => motion.drawn]];
    motion.models.forEach((model, i) => sets.push([`model${i}`, (frame) => model.frames[frame]]));
    const groups = sets.map(([kind, places]) => {
      const lines = motion.lines.map(() => {
        const line = svg.appendChild(document.createElementNS(SVG, "line"));
        line.setAttribute("class", kind);
        return line;
      });
      return { lines, places };
    });
    // The middle of all points of all instants, and a scale that keeps them in the window from every side.
    const all = [motion.drawn, ...motion.models.flatMap((model) => model.frames)].flat();
    const low = [0, 1, 2].map((i) => all.reduce((m, p) => Math.min(m, p[i]), Infinity));
    const high = [0, 1, 2].map((i) => all.reduce((m, p) => Math.max(m, p[i]), -Infinity));
    const middle = low.map((value, i) => (value + high[i]) / 2);
    const scale = 170 / Math.max(Math.hypot(...low.map((value, i) => high[i] - value)), 1e-9);
    let turn = -0.6, tilt = 0.35, timer = null;

    function project(place) {
      const from = place.map((value, i) => value - middle[i]);
      const [right, rearward, up] = motion.axes.map((axis) => dot(from, axis));
      const across = Math.cos(turn) * right - Math.sin(turn) * rearward;
      const away = Math.sin(turn) * right + Math.cos(turn) * rearward;
      return [scale * across, -scale * (Math.cos(tilt) * up - Math.sin(tilt) * away)];
    }

    function draw() {
      const frame = Number(slider.value);
      for (const { lines, places } of groups) {
        const flat = places(frame).map(project);
        motion.lines.forEach(([a, b], i) => {
          const [from, to] = [flat[a], flat[b]];
          for (const [name, value] of [["x1", from[0]], ["y1", from[1]], ["x2", to[0]], ["y2", to[1]]])
            lines[i].setAttribute(name, value.toFixed(2));
        });
      }
      output.textContent = `${motion.times[frame]} s`;
      slider.setAttribute("aria-valuetext", output.textContent);
    }

    function rotate(by) {
      turn += by[0];
      tilt = Math.min(Math.max(tilt + by[1], -1.57), 1.57);
      draw();
    }

    function play() {
      if (timer !== null) {
        clearInterval(timer);
        timer = null;
      } else {
        timer = setInterval(() => {
          slider.value = (Number(slider.value) + 1) % motion.times.length;
          draw();
        }, 40);
      }
      button.textContent = timer === null ? "Play" : "Stop";
      button.setAttribute("aria-pressed", String(timer !== null));
    }

    slider.addEventListener("input", draw);
    button.addEventListener("click", play);
    svg.addEventListener("keydown", (event) => {
      if (!(event.key in KEYS)) return;
      event.preventDefault();
      rotate(KEYS[event.key]);
    });
    svg.addEventListener("pointerdown", (event) => svg.setPointerCapture(event.pointerId));
    svg.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) rotate([0.01 * event.movementX, 0.01 * event.movementY]);
    });
    draw();
  }

  document.querySelectorAll("[data-motion]").forEach(start);
})();
