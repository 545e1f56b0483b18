"use strict";
// What the figures of all pages share: the colours of the style sheet, light or dark; axes; and drawing as they come
// into view, the rest when the browser is idle.
const report = (() => {
  const shared = {};

  // ---- what the page brings, compressed

  function unpacked(id) {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
  }

  async function start(page) {
    if (!window.DecompressionStream) {
      document.body.insertAdjacentText("afterbegin", "The figures need a browser of 2023 or later.");
      return;
    }
    shared.data = await unpacked("data").json();
    for (const library of ["plotly", "openbridge"].filter((id) => document.getElementById(id))) {
      const script = document.createElement("script");
      script.textContent = await unpacked(library).text();
      document.head.append(script);
    }
    await page();
    schedule();
  }

  // Numbers that Python's `packed_series` made small; a single number stands for `length` of them.
  function series(packed, length) {
    if (typeof packed === "number") return new Float64Array(length).fill(packed);
    if (Array.isArray(packed)) return Float64Array.from(packed, (v) => v ?? NaN);
    const inverse = Math.round(1 / packed.step);
    let count = 0;
    return Float64Array.from(packed.steps, (n) => (n === null ? NaN : ((count += n), packed.step < 1 ? count / inverse : count * packed.step)));
  }

  // ---- colours and texts

  function colour(name) {  // "blue", or "blue/0.2" for a transparent one
    const [token, opacity] = name.split("/");
    const found = getComputedStyle(document.documentElement).getPropertyValue(`--${token}`).trim();
    return opacity ? found + Math.round(255 * opacity).toString(16).padStart(2, "0") : found;
  }

  // Our texts are plain; plotly reads some HTML in them.
  const markup = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;").replace(/\n/g, "<br>");

  function painted(value) {  // "@blue" becomes what the style sheet says that blue is
    if (typeof value === "string") return /^@[a-z]+(\/[\d.]+)?$/.test(value) ? colour(value.slice(1)) : markup(value);
    if (Array.isArray(value)) return value.length && typeof value[0] === "number" ? value : value.map(painted);
    if (value && typeof value === "object") return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, painted(v)]));
    return value;
  }

  // Traces of plotly; `named: false` is ours: no box with the name of the trace at the pointer.
  const traces = (all) => painted(all).map(({ named = true, ...trace }) => (named ? trace : { ...trace, hovertemplate: `${trace.hovertemplate}<extra></extra>` }));

  function axis(own = {}) {
    return { gridcolor: colour("grid"), zerolinecolor: colour("faint"), linecolor: colour("faint"), tickcolor: colour("faint"), ticks: "outside", ticklen: 4, automargin: true, ...own };
  }

  function layout(own = {}) {
    return {
      font: { family: getComputedStyle(document.body).fontFamily, size: 12, color: colour("ink") }, paper_bgcolor: colour("card"), plot_bgcolor: colour("card"),
      hoverlabel: { bgcolor: colour("card"), bordercolor: colour("faint"), font: { size: 12, color: colour("ink") } }, ...own,
    };
  }

  // A legend takes rows where a figure is narrow: more height, as the curves need theirs.
  const narrow = (place) => place.clientWidth < 600;

  function makeRoom(place, figure) {
    const named = figure.data.filter((trace) => trace.showlegend !== false).length;
    if (narrow(place) && named > 2) place.style.height = `${place.clientHeight + 17 * (named - 2)}px`;
  }

  // ---- drawing

  const waiting = new Map();  // place -> what to do with it
  const drawings = new Map();  // place -> how to draw it again

  function inView(place) {
    const box = place.getBoundingClientRect();
    return box.bottom > -300 && box.top < innerHeight + 300;
  }

  let seen = null;  // when all that is in view was drawn first

  function work(all) {
    const next = all || [...waiting.keys()].filter(inView);
    for (const place of next.length ? next : [...waiting.keys()].slice(0, 1)) {
      const task = waiting.get(place);
      waiting.delete(place);
      if (task && place.isConnected) task();
    }
    if (!seen && ![...waiting.keys()].some(inView)) seen = performance.mark("in view");
    if (waiting.size) schedule();
    else document.body.dataset.drawn = "all";
  }

  let scheduled = false;
  function schedule() {
    if (scheduled) return;
    scheduled = true;
    delete document.body.dataset.drawn;
    setTimeout(() => { scheduled = false; work(); }, 0);
  }

  function later(place, task) {
    waiting.set(place, task);
    schedule();
  }

  function draw(place, how, now) {
    drawings.set(place, how);
    if (now) how();
    else later(place, how);
  }

  addEventListener("scroll", schedule, { passive: true });
  addEventListener("beforeprint", () => {  // paper has a width of its own, see @page; plotly would resize too late
    document.body.classList.add("printing");
    work([...waiting.keys()]);
    for (const place of document.querySelectorAll(".js-plotly-plot")) Plotly.relayout(place, { width: place.clientWidth, height: place.clientHeight });
  });
  addEventListener("afterprint", () => {
    document.body.classList.remove("printing");
    for (const place of document.querySelectorAll(".js-plotly-plot")) Plotly.relayout(place, { width: null, height: null, autosize: true });
  });
  addEventListener("scheme", () => drawings.forEach((how, place) => later(place, how)));
  return Object.assign(shared, { start, unpacked, series, colour, markup, painted, traces, axis, layout, narrow, makeRoom, draw, later });
})();
