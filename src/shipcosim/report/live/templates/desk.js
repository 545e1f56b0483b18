// The desk: what one can do to the running system, its alarms, trends, and what is saved.
(() => {
  const { live } = report, { about } = live, by = (id) => document.getElementById(id);
  const element = (tag, properties = {}, ...children) => { const made = Object.assign(document.createElement(tag), properties); made.append(...children); return made; };
  const owner = (name) => (name.includes(".") ? name.slice(0, name.lastIndexOf(".")) : "system"), short = (name) => name.slice(name.lastIndexOf(".") + 1).replaceAll("_", " ");
  const digits = (value) => (Number.isFinite(value) ? +value.toPrecision(5) : "–");

  // ---- units in which one types: degrees for angles, the rest as the signals have them

  const SHOWN = { rad: ["deg", 180 / Math.PI], "rad/s": ["deg/s", 180 / Math.PI] };
  const unitOf = (signal) => SHOWN[signal.unit]?.[0] ?? (signal.unit === "1" ? "" : signal.unit), factorOf = (signal) => SHOWN[signal.unit]?.[1] ?? 1;

  // ---- the player

  const step = element("button", { type: "button", className: "plain", textContent: "Step", title: "One row further" });
  const reset = element("button", { type: "button", className: "plain", textContent: "Start again" });
  const back = element("button", { type: "button", className: "plain", textContent: "Go back to here", title: "Forget what came after the time that is shown" });
  const move = element("button", { type: "button", className: "plain", textContent: "Move set point", title: "Then click in the chart" });
  const save = element("button", { type: "button", className: "plain", textContent: "Save scenario" }), table = element("button", { type: "button", className: "plain", textContent: "Save table" });
  move.setAttribute("aria-pressed", "false");
  by("scene-play").after(step, reset, back, move, save, table);
  const speed = by("scene-speed");
  speed.prepend(new Option("0.5×", 0.5));
  speed.append(new Option("as fast as it goes", Infinity));
  speed.value = 1;
  by("scene-play").textContent = "Run";

  const go = (t) => { scene.grown(live.time.last); scene.go(t ?? live.time.last); };
  step.addEventListener("click", () => { scene.pause(); live.reach(live.time.last + 1e-6); go(); });
  reset.addEventListener("click", () => { scene.pause(); live.reset(); go(); changed(); });
  back.addEventListener("click", () => { scene.pause(); live.back(scene.time); go(); changed(); });
  addEventListener("live-failed", ({ detail }) => { const place = by("failure"); place.hidden = false; place.textContent = `The run stopped: ${detail}. Go back, or save what was done so far.`; });

  // ---- inputs that nothing feeds

  const free = Object.entries(about.signals).filter(([, signal]) => signal.free);
  const run = report.data.scene[0], aims = run.vessels[0]?.aims["set point"] || [];
  const rows = new Map();

  function groupsOf(place, signals, build) {
    const groups = new Map();
    for (const [name, signal] of signals) {
      if (!groups.has(owner(name))) { const made = element("div", {}, element("h3", { textContent: owner(name) })); groups.set(owner(name), made); place.append(made); }
      groups.get(owner(name)).append(build(name, signal));
    }
  }

  function switchOf(name, signal) {
    const button = element("button", { type: "button", textContent: short(name), title: `${name}: ${signal.text}` });
    button.setAttribute("aria-label", `${owner(name)}: ${short(name)}`);
    button.addEventListener("click", () => act(live.held(name) && Number(live.held(name)[3]) ? "reset" : "override", name, true));
    rows.set(name, () => button.setAttribute("aria-pressed", String(Boolean(live.held(name) && Number(live.held(name)[3])))));
    return button;
  }

  function fieldOf(name, signal) {
    const id = `input-${name}`, field = element("input", { id, inputMode: "decimal" }), follow = element("button", { type: "button", textContent: "Follow" });
    const label = element("label", { htmlFor: id, textContent: short(name), title: `${name}: ${signal.text}` }), row = element("div", { className: "input" }, label, field, element("span", { textContent: unitOf(signal) }), follow);
    row.dataset.words = `${name} ${signal.text}`.toLowerCase();
    follow.setAttribute("aria-label", `${name} follows its own value again`);
    field.addEventListener("change", () => {
      const typed = Number(field.value.replace(",", ".").replace("−", "-")), value = typed / factorOf(signal);
      const fits = field.value.trim() !== "" && Number.isFinite(typed) && !(value < signal.min) && !(value > signal.max);
      field.setAttribute("aria-invalid", String(!fits));
      field.title = fits ? "" : `A number${"min" in signal ? ` from ${digits(signal.min * factorOf(signal))}` : ""}${"max" in signal ? ` to ${digits(signal.max * factorOf(signal))}` : ""} ${unitOf(signal)}`;
      if (fits) act("override", name, signal.kind === "Integer" ? Math.round(value) : value);
    });
    follow.addEventListener("click", () => act("reset", name));
    rows.set(name, () => {
      const held = live.held(name), value = held ? held[3] : (live.value(name) ?? signal.start ?? 0);
      row.classList.toggle("held", Boolean(held));
      follow.disabled = !held;
      if (document.activeElement !== field) field.value = digits(value * factorOf(signal));
    });
    return row;
  }

  groupsOf(by("failures").querySelector(".groups"), free.filter(([, signal]) => signal.kind === "Boolean"), switchOf);
  const weather = new Set(run.flows.flatMap(({ what }) => free.map(([name]) => name).filter((name) => new RegExp(`(^|\\.|_)${what.replace(/s$/, "")}_(speed|from|to|height|period)$`).test(name))));
  const isMain = ([name]) => aims.includes(name) || weather.has(name), numbers = free.filter(([, signal]) => signal.kind !== "Boolean");
  const [main, rest] = by("inputs").querySelectorAll(".groups");
  groupsOf(main, numbers.filter(isMain).sort(([a], [b]) => aims.includes(b) - aims.includes(a)), fieldOf);
  groupsOf(rest, numbers.filter((one) => !isMain(one)), fieldOf);
  by("inputs").querySelector("details").hidden = !rest.childElementCount;
  by("failures").hidden = !by("failures").querySelector("button");
  by("inputs-filter").addEventListener("input", ({ target }) => {
    const words = target.value.toLowerCase().split(/\s+/);
    for (const row of rest.querySelectorAll(".input")) row.style.display = words.every((word) => row.dataset.words.includes(word)) ? "" : "none";
    for (const group of rest.children) group.style.display = [...group.querySelectorAll(".input")].some((row) => row.style.display !== "none") ? "" : "none";
  });

  function act(action, name, value) {  // what one does acts at the end of the record, so the view goes there
    live.act(action, name, value);
    changed();
  }
  function changed() { for (const write of rows.values()) write(); if (!live.stopped) by("failure").hidden = true; }
  window.desk = { act, live };  // for those who look from outside

  // ---- the set point by a click in the chart

  const canSet = aims.length && aims.slice(0, 2).every((name) => about.signals[name]);
  move.hidden = !canSet;
  move.addEventListener("click", () => move.setAttribute("aria-pressed", String(move.getAttribute("aria-pressed") !== "true")));
  by("scene-chart").addEventListener("click", (event) => {
    if (move.getAttribute("aria-pressed") !== "true") return;
    const box = event.target.getBoundingClientRect(), { north, east } = scene.place(event.clientX - box.left, event.clientY - box.top);
    act("override", aims[0], +north.toFixed(1));
    act("override", aims[1], +east.toFixed(1));
    move.setAttribute("aria-pressed", "false");
    scene.refresh();
  });

  // ---- other start values

  const starts = about.starts.filter(([, , value]) => typeof value === "number"), choice = by("start-name"), typed = by("start-value");
  starts.sort((a, b) => /seed$/.test(b[1]) - /seed$/.test(a[1]) || a[1].localeCompare(b[1]));
  for (const [place, name, , unit] of starts) choice.append(new Option(`${name}${unit && unit !== "1" ? ` [${unit}]` : ""}`, place));
  const present = () => { const found = starts.find(([place]) => place === +choice.value); typed.value = live.starts[choice.value] ?? found?.[2] ?? ""; };
  choice.addEventListener("change", present);
  by("starts").hidden = !starts.length;
  present();
  by("start-again").addEventListener("click", () => {
    const value = Number(typed.value);
    if (!Number.isFinite(value) || typed.value.trim() === "") { typed.setAttribute("aria-invalid", "true"); return; }
    typed.removeAttribute("aria-invalid");
    scene.pause();
    const before = live.starts[choice.value] ?? starts.find(([place]) => place === +choice.value)[2];
    try { live.reset({ [choice.value]: value }); }
    catch (error) { live.reset({ [choice.value]: before }); by("failure").hidden = false; by("failure").textContent = `It does not start with that: ${error.message}. The value before holds.`; go(); return; }
    go();
    changed();
  });

  // ---- alarms: flags that components raise

  const ALARM = /alarm|lost|failed|rejected|saturated|limited|dropout|unsafe/, flags = Object.entries(about.signals).filter(([name, signal]) => signal.kind === "Boolean" && signal.side === 0 && ALARM.test(name));
  let alarms = [], looked = 0;
  function look() {
    if (live.time.length < looked) { alarms = []; looked = 0; }  // it went back
    for (; looked < live.time.length; looked++) {  // every row, however fast it goes
      const t = live.time.all[looked];
      for (const [name, signal] of flags) {
        const on = live.raw.get(name).all[looked] > 0.5, open = alarms.find((one) => one.name === name && one.until === null);
        if (on && !open) alarms.push({ name, text: signal.text, since: t, until: null, seen: false });
        if (!on && open) open.until = t;
      }
    }
    const now = alarms.filter((one) => one.until === null), box = by("alarms");
    box.className = `verdict ${now.length ? "loud" : "quiet"}`;
    const words = now.length ? [`${now.length} alarm${now.length > 1 ? "s" : ""}`, now.map(({ name }) => name).join(", ")] : ["No alarm", flags.length ? "" : "No component raises one."];
    [box.querySelector("strong").textContent, box.querySelector("p").textContent] = words;
    const listed = [...alarms].reverse().slice(0, 60), place = by("alarm-list");
    place.replaceChildren(...listed.map((one) => {
      const item = element("li", {}, element("span", { textContent: `${one.since.toFixed(1)} s` }), element("span", { className: one.until === null ? "on" : "", textContent: `${one.name}: ${one.text}` }), element("span", { className: "spacer" }), element("span", { textContent: one.until === null ? "" : `over at ${one.until.toFixed(1)} s` }));
      if (!one.seen) { const button = element("button", { type: "button", textContent: "Acknowledge" }); button.addEventListener("click", () => { one.seen = true; look(); }); item.append(button); }
      return item;
    }));
    if (!listed.length) place.append(element("li", { textContent: "None so far." }));
  }

  // ---- trends

  const trends = [], names = by("trend-names");
  for (const name of live.raw.keys()) names.append(new Option(name));
  function addTrend(name) {
    if (!live.raw.has(name) || trends.some((one) => one.name === name)) return;
    const canvas = element("canvas"), signal = about.signals[name] || { unit: "" };
    canvas.setAttribute("aria-label", `${name} over the last two minutes`);
    by("trend-canvases").append(canvas);
    trends.push({ name, canvas, unit: unitOf(signal), factor: factorOf(signal) });
  }
  by("trend-add").addEventListener("click", () => { addTrend(by("trend-name").value.trim()); by("trend-name").value = ""; draw(); });
  by("trend-name").addEventListener("keydown", (event) => { if (event.key === "Enter") by("trend-add").click(); });
  for (const name of run.vessels[0].pose.slice(0, 2)) addTrend(name);

  function draw() {
    const time = live.time.values, last = scene.time, from = Math.max(last - 120, time[0] ?? 0);
    const begin = Math.max(time.findIndex((t) => t >= from), 0);
    for (const { name, canvas, unit, factor } of trends) {
      const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight, c = canvas.getContext("2d");
      Object.assign(canvas, { width: width * ratio, height: height * ratio });
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      c.font = `12px ${getComputedStyle(document.body).fontFamily}`;
      let low = Infinity, high = -Infinity;
      const values = live.raw.get(name).values;
      for (let k = begin; k < values.length && time[k] <= last + 1e-9; k++) { low = Math.min(low, factor * values[k]); high = Math.max(high, factor * values[k]); }
      if (!(high > low)) { high += 0.5; low -= 0.5; }
      const x = (t) => 8 + ((width - 16) * (t - from)) / (last - from || 1), y = (v) => height - 8 - ((height - 30) * (v - low)) / (high - low);
      c.beginPath();
      for (let k = begin; k < values.length && time[k] <= last + 1e-9; k++) c.lineTo(x(time[k]), y(factor * values[k]));
      scene.stroke(c, "blue", 1.5);
      c.fillStyle = scene.colour("soft");
      c.textAlign = "left"; c.fillText(`${name}${unit ? ` [${unit}]` : ""}`, 8, 12);
      c.textAlign = "right"; c.fillText(`${digits(low)} to ${digits(high)}`, width - 8, 12);
    }
  }

  // ---- saving

  const quoted = (text) => JSON.stringify(text), written = (value) => (typeof value === "string" ? quoted(value) : typeof value === "boolean" ? String(value) : Number.isInteger(value) ? `${value}` : String(value));
  const real = (name, value) => (about.signals[name]?.kind === "Real" && Number.isInteger(value) ? `${value}.0` : about.signals[name]?.kind === "Boolean" ? String(Boolean(value)) : written(value));
  const seconds = (value) => (Number.isInteger(value) ? `${value}.0` : String(value));

  function scenario() {
    const { set, ...head } = about.scenario, now = live.now(), lines = [];
    const values = { ...set };
    for (const [place, value] of Object.entries(live.starts)) values[about.starts[place][1]] = value;
    lines.push(`description = ${quoted(`${head.description || head.system}, as it was run in the page`)}`, `system = ${quoted(head.system)}`);
    if (head.parameters?.length) lines.push(`parameters = [${head.parameters.map(quoted).join(", ")}]`);
    const rows = Math.ceil(now / about.steps_per_row) * about.steps_per_row;
    lines.push(`stop_time = ${seconds(live.engine.seconds(Math.max(rows, about.steps_per_row)))}`, `step_size = ${seconds(head.step_size)}`);
    if (head.output_interval) lines.push(`output_interval = ${seconds(head.output_interval)}`);
    const swapped = Object.entries(head.components || {});
    if (swapped.length) lines.push("", "[components]", ...swapped.map(([name, fmu]) => `${quoted(name)} = ${quoted(fmu)}`));
    lines.push("", "[set]", ...Object.entries(values).map(([name, value]) => `${quoted(name)} = ${written(value)}`));
    for (const [step, action, name, value] of [...live.done].sort((a, b) => a[0] - b[0])) {
      lines.push("", "[[events]]", `time = ${seconds(live.engine.seconds(step))}`);
      lines.push(action === "reset" ? `reset = [${quoted(name)}]` : `${action} = { ${quoted(name)} = ${real(name, value)} }`);
    }
    return `${lines.join("\n")}\n`;
  }

  function csv() {
    const columns = [...live.raw], head = ["time [s]", ...columns.map(([name]) => `${name}${about.signals[name]?.unit ? ` [${about.signals[name].unit}]` : ""}`)];
    const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text), lines = [head.map(cell).join(",")];
    live.time.values.forEach((t, row) => lines.push([t, ...columns.map(([, column]) => column.all[row])].join(",")));
    return `${lines.join("\n")}\n`;
  }

  function keep(name, text) {
    const address = URL.createObjectURL(new Blob([text], { type: "text/plain" })), link = element("a", { href: address, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }
  save.addEventListener("click", () => keep("live.toml", scenario()));
  table.addEventListener("click", () => keep("live.csv", csv()));
  Object.assign(window.desk, { scenario, csv });

  // ---- go

  scene.writes(() => { look(); draw(); for (const write of rows.values()) write(); });
  scene.opened();
  changed();
})();
