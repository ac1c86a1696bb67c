// What the tests ask of the page, each a function under its name; `page.py` runs them by these names.

//: settled
async (folded) => {
    for (const section of document.querySelectorAll("section"))
        section.querySelectorAll("details").forEach((one, i) => { one.open = i < folded; });
    const start = performance.now();
    // A page that is behind another one has no frames: half a second must do there.
    const frame = () => new Promise((go, stop) => {
        if (performance.now() - start > 60_000) stop(new Error("a plot is not drawn"));
        requestAnimationFrame(go);
        setTimeout(go, 500);
    });
    for (const one of document.querySelectorAll(".spatial > svg, [data-plot]")) {
        if (!one.checkVisibility()) continue;
        one.scrollIntoView();
        await frame();
        const as_wide = () => one.dataset.plot === undefined
            || Number(one.querySelector(".main-svg")?.getAttribute("width")) === one.clientWidth;
        while (!as_wide()) await frame();
    }
    scrollTo(0, 0);
    await frame();
    await frame();
}

//: covered_names
() => [...document.querySelectorAll(".spatial > svg")]
    .filter((svg) => svg.checkVisibility()).flatMap((svg) => {
    const meet = (a, b) =>
        a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    // The letters reach less high and deep than their line.
    const inner = ({ left, right, top, bottom }) =>
        ({ left, right, top: top + 3, bottom: bottom - 3 });
    const boxes = (kind) => [...svg.querySelectorAll(kind)]
        .map((one) => one.getBoundingClientRect());
    const names = boxes(":scope > text").map(inner), joints = boxes(".joint");
    return names.flatMap((one, i) =>
        [...names.slice(0, i), ...joints].filter((two) => meet(one, two)));
})

//: contrast
() => {
    const context = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    const rgb = (colour) => {
        context.clearRect(0, 0, 1, 1);
        context.fillStyle = colour;
        context.fillRect(0, 0, 1, 1);
        return [...context.getImageData(0, 0, 1, 1).data];
    };
    const light = ([r, g, b]) => [r, g, b].map((v) => v / 255)
        .map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
    const contrast = (a, b) => {
        const [low, high] = [light(a), light(b)].sort((a, b) => a - b);
        return (high + 0.05) / (low + 0.05);
    };
    const behind = (one) => {
        for (let at = one; at; at = at.parentElement) {
            const colour = rgb(getComputedStyle(at).backgroundColor);
            if (colour[3] === 255) return colour;
        }
        return [255, 255, 255];
    };
    const seen = (one) => one.checkVisibility({ visibilityProperty: true });
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const found = { text: [], line: [], cells: 0 };
    while (texts.nextNode()) {
        const one = texts.currentNode.parentElement;
        if (!texts.currentNode.data.trim() || one.closest("script, style, noscript") || !seen(one)) continue;
        const style = getComputedStyle(one);
        const colour = rgb(one instanceof SVGElement ? style.fill : style.color);
        // Behind a number of the heat map is a cell of any colour of its scale, which no style knows.
        const cells = one.closest(".heatmap-label")
            ? JSON.parse(one.closest("[data-plot]").dataset.plot).data[0].colorscale.map((at) => rgb(at[1]))
            : [behind(one)];
        const least = Math.min(...cells.map((cell) => contrast(colour, cell)));
        found.text.push([least, texts.currentNode.data.trim().slice(0, 40)]);
        found.cells += cells.length > 1;
    }
    const strokes = ".tube, .thread, .drawn, .joint, .js-line, .points path, .legendlines path, .triad line";
    for (const one of document.querySelectorAll(strokes)) {
        const style = getComputedStyle(one);
        if (!seen(one) || style.stroke === "none" || parseFloat(style.strokeWidth) === 0) continue;
        found.line.push([contrast(rgb(style.stroke), behind(one)), one.getAttribute("class")]);
    }
    return found;
}

//: cut
() => [...document.querySelectorAll("[data-plot]")].flatMap((plot) => {
    const box = plot.getBoundingClientRect();
    return [...plot.querySelectorAll("text")].filter((text) => {
        const one = text.getBoundingClientRect();
        return text.checkVisibility() && one.width && (one.left < box.left - 1 || one.right > box.right + 1
            || one.top < box.top - 1 || one.bottom > box.bottom + 1);
    }).map((text) => text.textContent);
})

//: outside
() => [...document.querySelectorAll("main *")].filter((one) => {
    const box = one.getBoundingClientRect();
    return one.checkVisibility() && box.width && !one.closest(".scroll") && !one.closest("svg svg, .plot svg")
        && box.right > document.documentElement.clientWidth + 1;
}).map((one) => one.outerHTML.slice(0, 80))

//: legend_shown
() => {
    const plot = document.querySelector("[data-plot]");
    const box = plot.querySelector(".legend .bg").getBoundingClientRect();
    return [...plot.querySelectorAll(".legendtext")].filter((one) => {
        const { top, bottom } = one.getBoundingClientRect();
        return top > box.top - 2 && bottom < box.bottom + 2;
    }).map((one) => one.textContent);
}

//: plots_within
() => [...document.querySelectorAll("[data-plot]")].map((plot) => {
    const [inner, outer] = [plot.querySelector(".main-svg"), plot]
        .map((one) => one?.getBoundingClientRect());
    return inner && inner.width <= outer.width + 1 && inner.height <= outer.height + 1;
})
