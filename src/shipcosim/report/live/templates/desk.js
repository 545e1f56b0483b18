// The desk: what one can do to the running system, its alarms, trends, and what is saved.
(() => {
  const { live } = report, { about } = live, by = (id) => document.getElementById(id);
  const element = (tag, properties = {}, ...children) => { const made = Object.assign(document.createElement(tag), properties); made.append(...children); return made; };
  const owner = (name) => (name.includes(".") ? name.slice(0, name.lastIndexOf(".")) : "system"), short = (name) => name.slice(name.lastIndexOf(".") + 1).replaceAll("_", " ");
  const digits = (value) => (Number.isFinite(value) ? +value.toPrecision(5) : "–");

  // ---- units in which one types: degrees for angles, the rest as the signals have them

  const SHOWN = { rad: ["deg", 180 / Math.PI], "rad/s": ["deg/s", 180 / Math.PI] };
  const unitOf = (signal) => SHOWN[signal.unit]?.[0] ?? (signal.unit === "1" ? "" : signal.unit), factorOf = (signal) => SHOWN[signal.unit]?.[1] ?? 1;

  // A number as one types it, with a comma or a point; NaN for anything else.
  function numberIn(text) {
    const plain = text.trim().replace("−", "-");
    return /^[+-]?(\d+([.,]\d*)?|[.,]\d+)(e[+-]?\d+)?$/i.test(plain) ? Number(plain.replace(",", ".")) : NaN;
  }

  // The value of a signal that was typed; what is wrong with it is said at the field, until another one is typed.
  function valueIn(field, remark, signal) {
    const typed = numberIn(field.value), value = typed / factorOf(signal), whole = signal.kind === "Integer";
    const fits = Number.isFinite(value) && !(value < signal.min) && !(value > signal.max) && (!whole || (Number.isInteger(value) && Math.abs(value) < 2 ** 31));
    const bounds = ["min", "max"].filter((bound) => bound in signal).map((bound) => `${bound === "min" ? "from" : "to"} ${digits(signal[bound] * factorOf(signal))}`);
    remark.textContent = fits ? "" : [whole ? "A whole number" : "A number", ...bounds, unitOf(signal)].join(" ").trim();
    field.setAttribute("aria-invalid", String(!fits));
    return fits ? value : null;
  }

  // ---- the player

  const step = element("button", { type: "button", className: "plain", textContent: "Step", title: "One row further" });
  const reset = element("button", { type: "button", className: "plain", textContent: "Start again" });
  const back = element("button", { type: "button", className: "plain", textContent: "Continue from here", title: "Forget what came after the time that is shown" });
  const minute = element("button", { type: "button", className: "plain", textContent: "−60 s", title: "Show a minute earlier" });
  const move = element("button", { type: "button", className: "plain", textContent: "Move set point", title: "Then click in the chart" });
  const saver = (textContent, title) => element("button", { type: "button", className: "plain", textContent, title });
  const save = saver("Save scenario", "All that was done: shipcosim run repeats it"), result = saver("Save result.nc", "All signals with names and units, as NetCDF"), table = saver("Save table", "All signals as CSV");
  move.setAttribute("aria-pressed", "false");
  by("scene-play").after(step, reset, minute);
  by("scene-time").closest(".player").append(back, move, save, result, table);
  const speed = by("scene-speed");
  speed.prepend(new Option("0.5×", 0.5));
  speed.append(new Option("as fast as it goes", Infinity));
  speed.value = 1;
  by("scene-play").textContent = "Run";

  const go = () => { scene.grown(live.end); scene.go(live.end); };
  step.addEventListener("click", () => { scene.pause(); live.reach(live.time.last + 1e-6); go(); });
  reset.addEventListener("click", () => { scene.pause(); live.reset(); go(); changed(); });
  minute.addEventListener("click", () => { scene.pause(); scene.go(scene.time - 60); });
  back.addEventListener("click", () => { scene.pause(); live.back(scene.time); go(); changed(); });
  addEventListener("live-failed", ({ detail }) => { const place = by("failure"); place.hidden = false; place.textContent = `The run stopped: ${detail.replace(/\.$/, "")}. ${live.engine.gone ? "Save" : `${noWay() ? "Start again" : "Go back"}, or save`} what was done so far.`; });

  // A server that cannot go back says why. Its rows come when they are there; who looks at the end goes on looking there.
  const noWay = () => live.engine.noWayBack;
  function tellWay() { if (noWay()) back.title = `Going back is not possible. ${noWay()}`; }
  tellWay();
  addEventListener("live-arrived", ({ detail: before }) => {
    tellWay();
    const looks = !(scene.time < before - 1e-6) && !scene.playing;
    scene.grown(live.end);
    if (looks) scene.go(live.end); else scene.refresh();
  });

  // ---- inputs that nothing feeds

  // Their start value holds until something is done: nothing else changes them. A fed set point has the value of its source.
  const placeOf = new Map(about.starts.map(([place, name]) => [name, place]));
  const startOf = (name) => Number(live.starts[placeOf.get(name)] ?? about.signals[name].start ?? 0);
  function present(name) {
    const held = live.held(name), number = held && Number(held[3]);
    if (!about.signals[name].free) return held?.[1] === "override" ? number : live.value(name);
    return held ? number + (held[1] === "bias" ? startOf(name) : 0) : startOf(name);
  }

  const free = Object.entries(about.signals).filter(([, signal]) => signal.free);
  const run = report.data.scene[0], aims = (run.vessels[0]?.aims["set point"] || []).map((column) => run.recipes[column]?.signal);
  const rows = [];  // what writes the present value of each input

  function groupsOf(place, signals, build) {
    const groups = new Map();
    for (const [name, signal] of signals) {
      if (!groups.has(owner(name))) { const made = element("div", {}, element("h3", { textContent: owner(name) })); groups.set(owner(name), made); place.append(made); }
      groups.get(owner(name)).append(build(name, signal));
    }
  }

  // A switch, or a bus whose power a click takes away.
  const isBus = ([name, { kind }]) => kind === "Real" && /bus\w*_power$/.test(name), busOf = (name) => short(name).replace(/ power$/, "");
  function switchOf(name, signal) {
    const bus = isBus([name, signal]), words = bus ? `${busOf(name)} lost` : short(name), isOn = () => (bus ? present(name) === 0 : Boolean(present(name)));
    const button = element("button", { type: "button", textContent: words, title: `${name}: ${signal.text}` });
    button.setAttribute("aria-label", `${owner(name)}: ${words}`);
    button.addEventListener("click", () => {
      const wanted = bus ? (isOn() ? startOf(name) : 0) : Number(!isOn());
      act(wanted === startOf(name) ? "reset" : "override", name, bus ? wanted : Boolean(wanted));
    });
    rows.push(() => {
      button.setAttribute("aria-pressed", String(isOn()));
      button.classList.toggle("changed", bus ? isOn() : present(name) !== startOf(name));
    });
    return button;
  }

  function fieldOf(name, signal, explained) {
    const id = `input-${name}`, field = element("input", { id, inputMode: "decimal" }), release = element("button", { type: "button", textContent: "Release" });
    const label = element("label", { htmlFor: id, textContent: short(name), title: `${name}: ${signal.text}` }), remark = element("span", { className: "wrong", id: `wrong-${name}` });
    if (explained) label.append(element("small", { textContent: signal.text.replace(/[,;].*/, "") }));
    remark.setAttribute("aria-live", "polite");
    field.setAttribute("aria-describedby", remark.id);
    const row = element("div", { className: "input" }, label, field, element("span", { textContent: unitOf(signal) }), release, remark);
    row.dataset.words = `${name} ${signal.text}`.toLowerCase();
    field.setAttribute("aria-label", `${owner(name)}: ${short(name)}${unitOf(signal) && `, ${unitOf(signal)}`}`);
    release.setAttribute("aria-label", `Give ${name} back to its source or its start value`);
    field.addEventListener("change", () => {
      const value = valueIn(field, remark, signal);
      if (value !== null) act("override", name, value);
    });
    const clear = () => { remark.textContent = ""; field.removeAttribute("aria-invalid"); };
    field.addEventListener("keydown", ({ key }) => { if (key === "Escape") { clear(); field.value = digits(present(name) * factorOf(signal)); } });
    release.addEventListener("click", () => { clear(); act("reset", name); });
    rows.push(() => {
      const held = live.held(name);
      row.classList.toggle("held", Boolean(held));
      release.disabled = !held;
      if (document.activeElement !== field && !remark.textContent) field.value = digits(present(name) * factorOf(signal));
    });
    return row;
  }

  groupsOf(by("failures").querySelector(".groups"), free.filter((one) => one[1].kind === "Boolean" || isBus(one)), switchOf);
  const weather = new Set(run.flows.flatMap(({ what }) => free.map(([name]) => name).filter((name) => new RegExp(`(^|\\.|_)${what.replace(/s$/, "")}_(speed|from|to|height|period)$`).test(name))));
  // The system's own inputs are those that its maker chose to steer it by.
  const isMain = ([name, { side }]) => aims.includes(name) || weather.has(name) || side === 2, numbers = Object.entries(about.signals).filter(([name, signal]) => signal.kind !== "Boolean" && (signal.free || aims.includes(name)));
  const [main, rest] = by("inputs").querySelectorAll(".groups");
  groupsOf(main, numbers.filter(isMain).sort(([a], [b]) => aims.includes(b) - aims.includes(a)), (name, signal) => fieldOf(name, signal, true));
  groupsOf(rest, numbers.filter((one) => !isMain(one)), fieldOf);
  by("inputs").querySelector("details").hidden = !rest.childElementCount;
  if (!aims.length) by("inputs").querySelector("h2").textContent = "Steering and weather";
  by("failures").hidden = !by("failures").querySelector("button");
  by("inputs-filter").addEventListener("input", ({ target }) => {
    const words = target.value.toLowerCase().split(/\s+/);
    for (const row of rest.querySelectorAll(".input")) row.style.display = words.every((word) => row.dataset.words.includes(word)) ? "" : "none";
    for (const group of rest.children) group.style.display = [...group.querySelectorAll(".input")].some((row) => row.style.display !== "none") ? "" : "none";
  });

  function act(action, name, value) {  // what one does acts at the end of the record, so the view goes there
    live.act(action, name, value);
    told = "";
    if (scene.time < live.time.last) go();
    changed();
  }
  function changed() { for (const write of rows) write(); if (!live.stopped) by("failure").hidden = true; }
  window.desk = { act, live, present, move, element, changed, isBus, busOf };  // for those who look from outside

  // ---- other start values

  const starts = about.starts.filter(([, , value]) => typeof value === "number"), choice = by("start-name"), typed = by("start-value");
  const rank = (name) => [/\.seed$/, /\.(significant_wave_height|peak_period|waves_from|\w+_start)$/, /./].findIndex((form) => form.test(name));  // what one tries first
  starts.sort(([, a], [, b]) => rank(a) - rank(b) || a.localeCompare(b));
  const signals = new Map(starts.map(([place, , value, unit, kind]) => [String(place), { value, unit, kind }]));
  for (const [place, name] of starts) { const unit = unitOf(signals.get(String(place))); choice.append(new Option(`${name}${unit ? ` [${unit}]` : ""}`, place)); }
  const before = () => live.starts[choice.value] ?? signals.get(choice.value).value;
  const show = () => { typed.value = +(before() * factorOf(signals.get(choice.value))).toPrecision(12); by("start-wrong").textContent = ""; typed.removeAttribute("aria-invalid"); };
  choice.addEventListener("change", show);
  by("starts").hidden = !starts.length;
  if (starts.length) show();
  by("start-again").addEventListener("click", () => {
    const value = valueIn(typed, by("start-wrong"), signals.get(choice.value)), old = before();
    if (value === null) return;
    scene.pause();
    try { live.reset({ [choice.value]: value }); }
    catch (error) { live.reset({ [choice.value]: old }); by("failure").hidden = false; by("failure").textContent = `It does not start with that: ${error.message}. The value before holds.`; go(); return; }
    go();
    changed();
  });

  // ---- alarms: flags that components raise, and those that say that something works no longer

  const ALARM = /alarm|lost|fail|fault|rejected|saturated|limited|dropout|unsafe/, WORKS = /(^|[._])(valid|available)$/;
  const flags = Object.entries(about.signals).flatMap(([name, { kind, side, text }]) => {
    const short = name.slice(name.lastIndexOf(".") + 1), works = WORKS.test(short);
    if (kind !== "Boolean" || side !== 0 || !(works || ALARM.test(short))) return [];
    // Words for people: "port: not available", and what is no longer true.
    const label = `${owner(name)}: ${works ? "not " : ""}${short.replaceAll("_", " ")}`;
    return [{ name, rings: works ? 0 : 1, label, text: works ? `no longer true: ${text}` : text }];
  });
  const acknowledged = new Set(), place = by("alarm-list"), box = by("alarms");
  let alarms = [], looked = 0;
  function forget() { alarms = []; looked = 0; place.replaceChildren(); }  // all rows are looked at anew
  addEventListener("live-cut", forget);

  function itemOf(alarm) {  // an entry stays the same element: one may be about to press its button
    const key = `${alarm.flag.name} ${alarm.since}`, over = element("span"), words = element("span", { className: "on", textContent: `${alarm.flag.label} (${alarm.flag.text})` });
    const item = element("li", {}, element("span", { textContent: `${alarm.since.toFixed(1)} s` }), words, element("span", { className: "spacer" }), over);
    alarm.end = (t) => { alarm.until = t; words.className = ""; over.textContent = `over at ${t.toFixed(1)} s`; };
    const done = element("span", { textContent: "acknowledged" });
    if (acknowledged.has(key)) { item.append(done); return item; }
    const button = element("button", { type: "button", textContent: "Acknowledge" });
    button.setAttribute("aria-label", `Acknowledge ${alarm.flag.label} of ${alarm.since.toFixed(1)} s`);
    button.addEventListener("click", () => {
      acknowledged.add(key);
      const all = [...place.querySelectorAll("button")], next = all[all.indexOf(button) + 1] || all[all.indexOf(button) - 1];
      button.replaceWith(done);
      next?.focus();
    });
    item.append(button);
    return item;
  }

  function look() {
    for (; looked < live.time.length; looked++) {  // every row, however fast it goes
      const t = live.time.all[looked];
      for (const flag of flags) {
        const on = (live.raw.get(flag.name).all[looked] > 0.5) === Boolean(flag.rings), open = alarms.find((one) => one.flag === flag && one.until === null);
        if (on && !open) { const alarm = { flag, since: t, until: null }; alarms.push(alarm); place.prepend(itemOf(alarm)); }
        if (!on && open) open.end(t);
      }
    }
    while (place.childElementCount > 60) place.lastElementChild.remove();
    by("no-alarms").hidden = alarms.length > 0;
    // The box speaks of the time that is shown, the list of the whole run.
    const t = scene.time, now = alarms.filter(({ since, until }) => since <= t && (until === null || until > t));
    const left = place.querySelectorAll("button").length, waiting = left ? `${left} to acknowledge` : flags.length ? "" : "No component raises one.";
    by("acknowledge-all").hidden = left < 2;
    const words = now.length ? [`${now.length} alarm${now.length > 1 ? "s" : ""}`, now.map(({ flag }) => flag.label).join("; ")] : ["No alarm", waiting];
    if (box.textContent === words.join("")) return;
    box.className = `verdict ${now.length ? "loud" : "quiet"}`;
    [box.querySelector("strong").textContent, box.querySelector("p").textContent] = words;
    box.querySelector("p").title = words[1];  // it may be cut off
  }

  by("acknowledge-all").addEventListener("click", () => { for (const button of place.querySelectorAll("button")) button.click(); });

  // ---- whether the past is shown

  let told = "";  // that a file was saved, until something else is done
  function tell() {
    // While she runs the rows are a little ahead of the view.
    const ahead = scene.playing ? live.engine.seconds(about.steps_per_row) + live.engine.ahead() : 0;
    const end = live.time.last, past = scene.time < end - ahead - 1e-6, words = past ? `Shown is ${scene.time.toFixed(1)} s of ${end.toFixed(1)} s. What you change acts at the end; ${noWay() ? `there is no way back: ${noWay()}` : `“Continue from here” forgets what came after ${scene.time.toFixed(1)} s.`}` : told;
    if (by("past").textContent !== words) by("past").textContent = words;
    back.disabled = !past || Boolean(noWay()) || live.engine.steers === false;
  }

  // ---- trends

  const trends = [], names = by("trend-names");
  for (const name of live.raw.keys()) names.append(new Option(name));
  function addTrend(name) {
    by("trend-wrong").textContent = live.raw.has(name) ? "" : `There is no signal “${name}”.`;
    if (!live.raw.has(name) || trends.some((one) => one.name === name)) return;
    const canvas = element("canvas"), signal = about.signals[name] || { unit: "" };
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name} over the last two minutes`);
    const remove = element("button", { type: "button", textContent: "×" }), box = element("div", { className: "trend" }, canvas, remove);
    remove.setAttribute("aria-label", `Remove ${name}`);
    by("trend-canvases").append(box);
    const trend = { name, canvas, unit: unitOf(signal), factor: factorOf(signal) };
    trends.push(trend);
    remove.addEventListener("click", () => { trends.splice(trends.indexOf(trend), 1); box.remove(); });
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
      const constant = high === low ? String(digits(low)) : "";
      if (!(high > low)) { high += 0.5; low -= 0.5; }
      const x = (t) => 8 + ((width - 16) * (t - from)) / (last - from || 1), y = (v) => height - 20 - ((height - 42) * (v - low)) / (high - low);
      c.beginPath();
      for (let k = begin; k < values.length && time[k] <= last + 1e-9; k++) c.lineTo(x(time[k]), y(factor * values[k]));
      scene.stroke(c, "blue", 1.5);
      c.fillStyle = scene.colour("soft");
      c.textAlign = "left"; c.fillText(`${name}${unit ? ` [${unit}]` : ""}`, 8, 12, Math.max(width - 190, 60));
      // Ends of the range, to a hundredth of it.
      const least = 10 ** (Math.floor(Math.log10(high - low)) - 1), end = (v) => String(digits(Math.round(v / least) * least)).replaceAll("-", "−");
      c.textAlign = "right"; c.fillText(constant || `${end(low)} to ${end(high)}`, width - 32, 12);
      c.fillText(`${last.toFixed(0)} s`, width - 8, height - 4);
      c.textAlign = "left"; c.fillText(`${from.toFixed(0)} s`, 8, height - 4);
    }
  }

  // ---- saving

  const quoted = (text) => JSON.stringify(text).replaceAll("\x7f", "\\u007f"), written = (value) => (typeof value === "string" ? quoted(value) : String(value));
  const seconds = (value) => String(value).replace(/^-?\d+$/, "$&.0");  // TOML tells whole numbers from others
  const valueOf = { Real: seconds, Integer: String, Boolean: (value) => String(Boolean(value)) };

  function scenario() {
    const { set, ...head } = about.scenario, now = live.now(), lines = [];
    const values = { ...set };
    for (const [place, value] of Object.entries(live.starts)) values[about.starts[place][1]] = value;
    const description = head.description || head.system, tail = ", as it was run in the page";
    lines.push(`description = ${quoted(description.endsWith(tail) ? description : description + tail)}`, `system = ${quoted(head.system)}`);
    if (head.parameters?.length) lines.push(`parameters = [${head.parameters.map(quoted).join(", ")}]`);
    // What was done in a pause acts on the next step, so the run goes on to the row after it.
    const stop = Math.ceil((now + Number(live.pending.length > 0)) / about.steps_per_row) * about.steps_per_row;
    lines.push(`stop_time = ${seconds(live.engine.seconds(Math.max(stop, about.steps_per_row)))}`, `step_size = ${seconds(head.step_size)}`);
    if (head.output_interval) lines.push(`output_interval = ${seconds(head.output_interval)}`);
    if (head.order) lines.push(`order = ${quoted(head.order)}`);
    const swapped = Object.entries(head.components || {});
    if (swapped.length) lines.push("", "[components]", ...swapped.map(([name, fmu]) => `${quoted(name)} = ${quoted(fmu)}`));
    lines.push("", "[set]", ...Object.entries(values).map(([name, value]) => `${quoted(name)} = ${written(value)}`));
    for (const [step, action, name, value] of live.before(stop).sort((a, b) => a[0] - b[0])) {
      lines.push("", "[[events]]", `time = ${seconds(live.engine.seconds(step))}`);
      lines.push(action === "reset" ? `reset = [${quoted(name)}]` : `${action} = { ${quoted(name)} = ${valueOf[about.signals[name].kind](value)} }`);
    }
    return `${lines.join("\n")}\n`;
  }

  function csv() {
    const columns = [...live.raw], head = ["time [s]", ...columns.map(([name]) => `${name}${about.signals[name]?.unit ? ` [${about.signals[name].unit}]` : ""}`)];
    const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text), lines = [head.map(cell).join(",")];
    live.time.values.forEach((t, row) => lines.push([t, ...columns.map(([, column]) => column.all[row])].join(",")));
    return new Blob(lines.map((line) => `${line}\n`), { type: "text/csv" });  // a text of ten hours would be longer than texts may be
  }

  function netcdf() {
    const signals = about.columns.flatMap((names, x) => names.map((name) => ({ name, kind: about.kinds[x], unit: about.signals[name]?.unit ?? "", text: about.signals[name]?.text ?? "", values: live.raw.get(name).values })));
    const { description = "", system, step_size } = about.scenario;
    const clock = { name: "time", kind: "Real", unit: "s", text: "time", values: live.time.values };
    return netcdfOf({ description, system, step_size, saved_scenario: scenario() }, [clock, ...signals]);
  }

  function keep(name, content) {
    const file = new Blob([content], { type: content.type || "text/plain" }), address = URL.createObjectURL(file), link = element("a", { href: address, download: name });
    link.click();
    told = `Saved as ${name}, ${(file.size / 1e6).toFixed(file.size > 1e6 ? 0 : 3)} MB.`;
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }
  // Who leaves the page with something done that is not saved is asked first.
  let unsaved = false;
  addEventListener("live-acted", () => { unsaved = true; });
  addEventListener("beforeunload", (event) => { if (unsaved && navigator.userActivation?.hasBeenActive) event.preventDefault(); });
  save.addEventListener("click", () => { keep("live.toml", scenario()); told += " “shipcosim run live.toml” repeats this run."; unsaved = false; });
  result.addEventListener("click", () => { keep("result.nc", netcdf()); unsaved = false; });  // the scenario stands in it
  table.addEventListener("click", () => keep("live.csv", csv()));
  Object.assign(window.desk, { scenario, csv, netcdf });

  // ---- go

  // Marks at what was done, on a time line that grows.
  const marked = () => scene.mark([...new Set(live.done.map(([step]) => live.engine.seconds(step)))].filter((t) => t <= scene.end));
  scene.writes(() => { look(); tell(); draw(); marked(); for (const write of rows) write(); });
  changed();
})();
