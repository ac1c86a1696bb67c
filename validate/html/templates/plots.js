"use strict";
(() => {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  // With touch, a swipe over a plot scrolls the page.
  const finger = matchMedia("(pointer: coarse)");
  const PRINTED = { width: 320, height: 200 }, LETTER = 6.2, ROW = 19;
  const places = document.querySelectorAll("[data-plot]");
  // The plots near the window; the size and colour scheme for which each plot was drawn last.
  const near = new Set(), drawn = new Map();
  let printing = false;

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  // Text wrapped to lines of at most `letters` characters.
  function folded(text, letters) {
    const lines = [""];
    for (const word of text.split(" ")) {
      const last = lines[lines.length - 1];
      if (last && last.length + word.length >= letters) lines.push(word);
      else lines[lines.length - 1] = last ? `${last} ${word}` : word;
    }
    return lines.join("<br>");
  }

  function numbers(data, letter) {
    return data.flatMap((trace) => trace[letter] ?? []).filter((value) => typeof value === "number");
  }

  // Ticks at whole decades, as many as fit; for less than 1.5 decades at 1, 2 and 5 of each. The font is smaller
  // for powers, because plotly writes them larger by a quarter.
  function decades(values) {
    const above = values.filter((value) => value > 0);
    if (!above.length) return {};
    const [low, high] = [Math.min(...above), Math.max(...above)];
    const count = Math.log10(high / low);
    if (!(count <= 1.5)) return { dtick: Math.ceil(count / 6), tickfont: { size: 9 } };
    const first = Math.floor(Math.log10(low)) - 1;
    const tickvals = Array.from({ length: Math.ceil(Math.log10(high)) - first + 2 }, (_, i) => first + i)
      .flatMap((power) => [1, 2, 5].map((digit) => Number(`${digit}e${power}`)));
    return { tickmode: "array", tickvals, ticktext: tickvals.map(told) };
  }

  // Height of the legend beyond its first line, px. The legend is above its plot, in columns as wide as the
  // longest name.
  function beyondOne(data, width) {
    const names = data.filter((trace) => trace.name && trace.showlegend !== false).map((trace) => trace.name.length);
    const columns = Math.max(1, Math.floor((width - 60) / (LETTER * Math.max(0, ...names) + 50)));
    return ROW * Math.max(0, Math.ceil(names.length / columns) - 1);
  }

  function draw(place) {
    const { data, layout } = JSON.parse(place.dataset.plot);
    // A plot that is as wide as the page has its own height, on paper too.
    const whole = place.style.getPropertyValue("--tall") !== "";
    const wide = printing && !whole ? PRINTED.width : place.clientWidth;
    const beyond = layout.showlegend === false ? 0 : beyondOne(data, wide);
    place.style.setProperty("--beyond", `${beyond}px`);
    const ink = colour("--ink"), line = colour("--line");
    const { width, height } = printing && !whole ? { ...PRINTED, height: PRINTED.height + beyond }
      : { width: wide, height: place.clientHeight };
    for (const name of Object.keys(layout).filter((name) => /^[xy]axis/.test(name))) {
      const axis = layout[name], across = name[0] === "x";
      Object.assign(axis, { gridcolor: line, zerolinecolor: line, linecolor: line, fixedrange: finger.matches });
      if (axis.type === "log") Object.assign(axis, decades(numbers(data, name[0])));
      if (axis.title) {
        const room = across ? width - 80 : height - beyond - 60;
        Object.assign(axis.title, { text: folded(axis.title.text, room / LETTER), standoff: 8, font: { size: 11 } });
      }
    }
    Object.assign(layout, {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", width, height,
      font: { color: ink, size: 11, family: getComputedStyle(place).fontFamily },
      margin: { l: 50, r: 10, t: 10, b: 40 },
        // Without maxheight plotly would limit the legend to half of the height, and hide the rest.
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", maxheight: beyond + 2 * ROW },
      dragmode: finger.matches ? false : "zoom",
      hoverlabel: { bgcolor: colour("--paper"), bordercolor: line, font: { color: ink } },
    });
    Plotly.react(place, data, layout, { displaylogo: false, displayModeBar: false });
    // For screen readers the enclosing element is the image and has the description; its parts are hidden.
    place.querySelector(".plot-container").setAttribute("aria-hidden", "true");
    // An element outside the visible page, in which plotly measures text.
    document.getElementById("js-plotly-tester")?.setAttribute("aria-hidden", "true");
  }

  // Numbers in the description of a plot for screen readers.
  function told(value) {
    return String(Number(value.toPrecision(3)));
  }

  function describe(place) {
    const { data, layout } = JSON.parse(place.dataset.plot);
    const words = data.flatMap((trace) => {
      // The numbers of a heat map are also in a table.
      if (trace.z) return [`Rows from ${trace.y[0]} to ${trace.y.at(-1)}, columns from ${trace.x[0]} to ${trace.x.at(-1)}`];
      const values = numbers([trace], "y");
      if (!values.length) return [];
      const [low, high] = [Math.min(...values), Math.max(...values)].map(told);
      return [`${trace.name ?? "curve"} from ${low} to ${high}`];
    });
    const axes = ["xaxis", "yaxis"].map((name) => layout[name]?.title?.text).filter(Boolean).join(" and ");
    const parts = [place.getAttribute("aria-label"), axes && `Axes: ${axes}`, words.join("; ")].filter(Boolean);
    place.setAttribute("aria-label", `${parts.join(". ")}.`);
  }

  // A plot is drawn when it comes near the window, so that a long page opens at once. It is drawn again if its
  // width or the colour scheme has changed.
  function refresh(place) {
    const how = `${place.clientWidth} ${dark.matches} ${printing}`;
    if (!place.clientWidth || !(printing || near.has(place)) || drawn.get(place) === how) return;
    drawn.set(place, how);
    draw(place);
  }

  const watch = new IntersectionObserver((seen) => {
    for (const one of seen) {
      if (one.isIntersecting) near.add(one.target);
      else near.delete(one.target);
      refresh(one.target);
    }
  }, { rootMargin: "400px" });
  const measure = new ResizeObserver((changed) => changed.forEach((one) => refresh(one.target)));
  places.forEach((place) => {
    describe(place);
    watch.observe(place);
    measure.observe(place);
  });
  dark.addEventListener("change", () => near.forEach(refresh));

  // For printing everything is unfolded and drawn on white.
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = [...document.querySelectorAll("details:not([open])")];
    closed.forEach((one) => { one.open = true; });
    document.documentElement.classList.add("printed");
    printing = true;
    places.forEach(refresh);
  });
  addEventListener("afterprint", () => {
    closed.forEach((one) => { one.open = false; });
    document.documentElement.classList.remove("printed");
    printing = false;
    near.forEach(refresh);
  });
})();
