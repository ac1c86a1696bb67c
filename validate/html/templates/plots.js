"use strict";
(() => {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const drawn = new Set();

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  function draw(place) {
    drawn.add(place);
    const { data, layout } = JSON.parse(place.dataset.plot);
    const ink = colour("--ink"), line = colour("--line");
    for (const name of ["xaxis", "yaxis"])
      Object.assign(layout[name], { gridcolor: line, zerolinecolor: line, linecolor: line });
    Object.assign(layout, {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { color: ink, size: 11 }, margin: { l: 50, r: 10, t: 10, b: 40 },
      legend: { orientation: "h", y: 1.15 },
    });
    Plotly.react(place, data, layout, { responsive: true, displaylogo: false, displayModeBar: false });
  }

  // A plot is drawn when it is near the window, so that a long page is there at once.
  const places = document.querySelectorAll("[data-plot]");
  const watch = new IntersectionObserver((seen) => {
    for (const one of seen)
      if (one.isIntersecting && !drawn.has(one.target)) draw(one.target);
  }, { rootMargin: "400px" });
  places.forEach((place) => watch.observe(place));
  dark.addEventListener("change", () => drawn.forEach(draw));
  addEventListener("beforeprint", () => places.forEach((place) => drawn.has(place) || draw(place)));
})();
