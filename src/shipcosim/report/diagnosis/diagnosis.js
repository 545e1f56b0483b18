"use strict";
// Draws the figures of the page as they come into view, in the colours of the style sheet, light or dark.
(() => {
  const figures = JSON.parse(document.getElementById("data").textContent);
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const config = { responsive: true, displayModeBar: false };

  function painted(value) {  // "@blue" becomes what the style sheet says that blue is
    if (typeof value === "string") return value.startsWith("@") ? colour(value.slice(1)) : value;
    if (Array.isArray(value)) return value.length && typeof value[0] === "number" ? value : value.map(painted);
    if (value && typeof value === "object") return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, painted(v)]));
    return value;
  }

  function axis(own = {}) {
    return { gridcolor: colour("grid"), zerolinecolor: colour("faint"), linecolor: colour("faint"), tickcolor: colour("faint"), ticks: "outside", ticklen: 4, automargin: true, ...own };
  }

  function layoutOf(figure, width) {
    const { xaxis, yaxis, ...own } = painted(figure.layout);
    const named = figure.data.filter((t) => t.showlegend !== false).length > 1;
    return {
      font: { family: getComputedStyle(document.body).fontFamily, size: 12, color: colour("ink") }, margin: { l: 48, r: 16, t: named ? 8 : 10, b: 36 },
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", showlegend: named, dragmode: width < 600 ? false : "zoom",
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: { size: 11 } },
      hoverlabel: { bgcolor: colour("card"), bordercolor: colour("faint"), font: { size: 12, color: colour("ink") } },
      hovermode: figure.data[0] && figure.data[0].mode === "lines" && !(yaxis && yaxis.scaleanchor) ? "x unified" : "closest",
      ...own, xaxis: axis(xaxis), yaxis: axis(yaxis),
    };
  }

  function draw(place) {
    const figure = figures[+place.dataset.figure];
    if (figure.layout.height) place.style.height = `${figure.layout.height}px`;
    const layout = layoutOf(figure, place.clientWidth);
    delete layout.height;
    Plotly.react(place, painted(figure.data), layout, config);
  }

  const waiting = new Set(document.querySelectorAll(".plot"));
  const inView = (place) => { const box = place.getBoundingClientRect(); return box.bottom > -300 && box.top < innerHeight + 300; };

  function work(all) {
    const next = all ? [...waiting] : [...waiting].filter(inView);
    for (const place of next.length ? next : [...waiting].slice(0, 1)) { waiting.delete(place); draw(place); }
    if (waiting.size) setTimeout(work, 0);
    else document.body.dataset.drawn = "all";
  }

  work();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => document.querySelectorAll(".plot").forEach(draw));
  addEventListener("beforeprint", () => work(true));
})();
