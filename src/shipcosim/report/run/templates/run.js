// The page of a run: panels over time that share one time window and follow the scene, and signals to choose from.
(() => {
  const { data, axis, colour, draw, later, layout, markup, painted, series, traces } = report;
  const time = series(data.time), decoded = {};
  const values = (name) => (decoded[name] ??= series(data.signals[name].values, time.length));
  const touch = matchMedia("(pointer: coarse)").matches;  // a finger on a plot scrolls the page
  const config = { responsive: true, displaylogo: false, scrollZoom: false, displayModeBar: touch ? false : "hover", modeBarButtons: [["zoom2d", "pan2d", "resetScale2d", "toImage"]] };
  const whole = [time[0], time[time.length - 1]];
  let shownWindow = whole;

  // ---- panels over time

  function bandTraces(panel) {
    return panel.bands.map((band) => {
      const shade = band.passed ? data.colours.passed : data.colours.failed;
      return {
        type: "scatter", mode: "lines", name: band.passed ? "limit, held" : "limit, missed",
        x: [...band.time, ...band.time.slice().reverse()], y: [...band.upper, ...band.lower.slice().reverse()],
        fill: "toself", fillcolor: painted(`${shade}/0.22`), line: { color: painted(shade), width: 1 }, hoverinfo: "skip", showlegend: false,
      };
    });
  }

  function lineTraces(panel) {
    const unit = panel.unit ? " " + panel.unit : "";
    return panel.lines.map((line) => ({
      type: "scatter", mode: "lines", name: markup(line.label), x: time, y: values(line.signal),
      line: { color: painted(line.colour), dash: line.dash, width: line.width }, hovertemplate: markup(`%{y:.4~g}${unit}`),
    }));
  }

  function stateTraces(panel) {
    const rank = (k) => panel.lines.length - 1 - k;
    return panel.lines.flatMap((line, k) => [
      { type: "scatter", mode: "lines", x: whole, y: [rank(k), rank(k)], line: { width: 0 }, hoverinfo: "skip", showlegend: false },
      {
        type: "scatter", mode: "lines", name: markup(line.label), x: time, y: values(line.signal).map((v) => rank(k) + 0.8 * v), line: { color: painted(line.colour), width: 1, shape: "hv" },
        fill: "tonexty", fillcolor: painted(`${line.colour}/0.4`), text: Array.from(values(line.signal), (v) => (v ? "yes" : "no")), hovertemplate: "%{text}", showlegend: false,
      },
    ]);
  }

  function headroom(place, panel) {  // for the title, and a legend of one or more rows. [px]
    const entry = 50 + 6.5 * Math.max(...panel.lines.map((line) => line.label.length));
    const inRow = Math.max(1, Math.floor((place.clientWidth - 80) / entry));
    return Math.max(54, 30 + 18 * Math.ceil(panel.lines.length / inRow));
  }

  function layoutOf(place, panel) {
    const title = { text: `<b>${markup(panel.title)}</b>` + markup(panel.unit ? ` [${panel.unit}]` : ""), x: 0, xanchor: "left", y: 0.98, yanchor: "top", font: { size: 13 } };
    const yaxis = panel.states
      ? axis({ tickvals: panel.lines.map((_, k) => panel.lines.length - 0.6 - k), ticktext: panel.lines.map((l) => markup(l.label)), range: [-0.1, panel.lines.length], showgrid: false, zeroline: false })
      : axis();
    const event = (t) => ({ type: "line", x0: t, x1: t, y0: 0, y1: 1, yref: "paper", layer: "below", line: { color: colour("faint"), width: 1, dash: "dot" } });
    const zone = ({ lower, upper }) => ({ type: "rect", xref: "paper", x0: 0, x1: 1, y0: lower, y1: upper, layer: "below", fillcolor: painted("@vermillion/0.16"), line: { width: 0 } });
    return layout({
      title, yaxis, margin: { l: 56, r: 24, t: panel.states ? 54 : headroom(place, panel), b: 34 }, hovermode: "x unified", dragmode: touch ? false : "zoom", uirevision: "keep",
      legend: { orientation: "h", x: 1, xanchor: "right", y: 1.0, yanchor: "bottom", font: { size: 11 } },
      xaxis: axis({ automargin: false, range: shownWindow.slice(), ticksuffix: " s", showticksuffix: "last", hoverformat: ".6~g", unifiedhovertitle: { text: "%{x} s" } }),
      shapes: [...panel.zones.map(zone), ...data.events.filter((t) => t > whole[0]).map(event)],
    });
  }

  function drawPanel(place, panel) {
    if (panel.states) place.style.height = `max(250px, ${88 + 19 * panel.lines.length}px)`;  // a line of text for each state
    const traces = panel.states ? stateTraces(panel) : [...bandTraces(panel), ...lineTraces(panel)];
    Plotly.newPlot(place, traces, layoutOf(place, panel), config);
    place.on("plotly_relayout", (change) => follow(place, change));
    const timeOf = (event) => +(event.xvals ? event.xvals[0] : event.points[0].x);
    place.on("plotly_hover", (event) => tell("scene-ghost", timeOf(event)));
    place.on("plotly_unhover", () => tell("scene-ghost", null));
    place.on("plotly_click", (event) => tell("scene-go", timeOf(event)));
    place.on("plotly_afterplot", () => cursor(place));
    place.drawn = shownWindow;
    seen.observe(place);
    cursor(place);
  }

  function zoom(place) {
    if (place.drawn === shownWindow) return;
    place.drawn = shownWindow;
    Plotly.relayout(place, { "xaxis.range": shownWindow.slice() });
  }

  // ---- one time window for all panels

  function follow(source, change) {
    let window;
    if (change["xaxis.autorange"]) window = whole;
    else if (change["xaxis.range"]) window = change["xaxis.range"];
    else if ("xaxis.range[0]" in change) window = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
    else return;
    if (window[0] === shownWindow[0] && window[1] === shownWindow[1]) return;
    show(window);
  }

  function show(window) {
    shownWindow = window;
    document.getElementById("reset").hidden = window === whole;
    for (const place of document.querySelectorAll(".js-plotly-plot.panel")) later(place, () => zoom(place));
  }

  document.getElementById("reset").addEventListener("click", () => show(whole));

  // ---- the time of the scene

  let now = null;

  function cursor(place) {
    if (now === null || !place._fullLayout) return;
    const { xaxis, _size } = place._fullLayout, line = (place.cursor ??= place.appendChild(Object.assign(document.createElement("div"), { className: "now" })));
    const x = xaxis.l2p(now), inside = x >= -1 && x <= _size.w + 1;
    line.hidden = !inside;
    if (inside) Object.assign(line.style, { top: `${_size.t}px`, height: `${_size.h}px`, transform: `translateX(${_size.l + x}px)` });
  }

  const inView = new Set(), seen = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) { inView[isIntersecting ? "add" : "delete"](target); if (isIntersecting) cursor(target); }
  });
  addEventListener("scene-time", (event) => { now = event.detail; inView.forEach(cursor); });
  const tell = (name, t) => dispatchEvent(new CustomEvent(name, { detail: t }));

  // ---- moments to go to

  for (const button of document.querySelectorAll("#moments button")) {
    button.addEventListener("click", () => {
      tell("scene-go", +button.dataset.time);
      document.getElementById("scene")?.scrollIntoView({ block: "nearest" });
    });
  }

  // ---- signals to choose from

  const chosen = new Set();

  function choices() {
    const groups = {};
    for (const name of data.choice) (groups[name.includes(".") ? name.slice(0, name.lastIndexOf(".")) : ""] ??= []).push(name);
    for (const [component, names] of Object.entries(groups)) {
      const group = document.createElement("div"), heading = document.createElement("h3");
      heading.textContent = component || "outermost system";
      group.append(heading, ...names.map(choice));
      document.getElementById("choices").append(group);
    }
  }

  function choice(name) {
    const { unit, label } = data.signals[name];
    const row = document.createElement("label"), box = document.createElement("input"), small = document.createElement("small");
    Object.assign(box, { type: "checkbox", value: name });
    box.addEventListener("change", () => { chosen[box.checked ? "add" : "delete"](name); drawChosen(); });
    small.textContent = unit ? ` ${unit}` : "";
    row.title = label;
    row.append(box, " ", name.slice(name.lastIndexOf(".") + 1), small);
    return row;
  }

  const chosenPlaces = {};  // by unit

  function drawChosen() {
    const units = {}, cycle = data.colours.cycle;
    for (const name of chosen) (units[data.signals[name].unit] ??= []).push(name);
    for (const unit of Object.keys(chosenPlaces)) if (!units[unit]) { chosenPlaces[unit].remove(); delete chosenPlaces[unit]; }
    for (const [unit, names] of Object.entries(units)) {
      const lines = names.map((signal, k) => ({ signal, label: signal, colour: cycle[k % cycle.length], dash: "solid", width: 1.5 }));
      const panel = { title: names.length > 1 ? "Chosen signals" : names[0], unit, lines, bands: [], zones: [], states: false };
      const place = (chosenPlaces[unit] ??= newPlace());
      draw(place, () => drawPanel(place, panel), true);
    }
  }

  function newPlace() {
    const place = document.createElement("div");
    place.className = "panel";
    document.getElementById("chosen").append(place);
    return place;
  }

  document.getElementById("filter").addEventListener("input", (event) => {
    const words = event.target.value.toLowerCase().split(/\s+/);
    for (const group of document.querySelectorAll("#choices div")) {
      for (const row of group.querySelectorAll("label")) {
        const text = row.querySelector("input").value.toLowerCase() + " " + row.title.toLowerCase();
        row.hidden = !words.every((word) => text.includes(word));
        row.style.display = row.hidden ? "none" : "";
      }
      group.style.display = group.querySelector("label:not([hidden])") ? "" : "none";
    }
  });

  // ---- go

  if (scene) scene.opened();
  data.panels.forEach((panel, k) => {
    const place = document.getElementById(`panel-${k}`);
    draw(place, () => drawPanel(place, panel));
  });
  choices();
  const first = data.chosen || data.choice.slice(0, 6);
  if (!data.panels.length) for (const box of document.querySelectorAll("#choices input")) if (first.includes(box.value)) box.click();
})();
