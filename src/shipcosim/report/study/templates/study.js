// The runs of a study: their columns, which of them are chosen, and who is told when that changes.
const study = (() => {
  const { data, series } = report;
  const runs = series(data.runs), count = runs.length;
  const place = new Map(Array.from(runs, (number, row) => [Math.round(number), row]));
  const error = new Map(data.failed.map((row, k) => [row, data.errors[data.errorOf[k]]]));

  // ---- columns

  function decoded(packed) {
    const { name, role, unit, description, labels, truth } = packed;
    const values = packed.places ? Float64Array.from(packed.places, (k) => (k < 0 ? NaN : packed.levels[k])) : packed.values.step || packed.digits !== undefined ? series(packed.values, count) : Float64Array.from(packed.values, (v) => v ?? NaN);
    let low = Infinity, high = -Infinity;
    for (const v of values) if (Number.isFinite(v)) { if (v < low) low = v; if (v > high) high = v; }
    if (labels.length) [low, high] = [0, labels.length - 1];
    const levels = labels.length ? labels.map((_, k) => k) : truth ? [0, 1] : packed.levels || null;
    return { name, role, unit, description, labels, truth, values, levels, low, high, digits: packed.digits ?? null, title: unit ? `${name} [${unit}]` : name };
  }
  const columns = data.columns.map(decoded), named = new Map(columns.map((column) => [column.name, column]));
  const varying = columns.filter((column) => column.high > column.low);

  const signed = (text) => text.replace("-", "−");
  function text(column, v) {
    if (!Number.isFinite(v)) return "–";
    if (column.labels.length) return column.labels[v];
    if (column.truth) return v ? "yes" : "no";
    return signed(column.digits === null ? `${+v.toPrecision(5)}` : v.toFixed(column.digits));
  }

  // ---- colours

  const MIX = 7;
  function mixed(share) {  // from blue to orange
    const [a, b] = ["blue", "orange"].map((name) => report.colour(name).match(/\w\w/g).map((part) => parseInt(part, 16)));
    return `#${a.map((v, k) => Math.round(v + share * (b[k] - v)).toString(16).padStart(2, "0")).join("")}`;
  }

  let painter = null;  // class of each row and the colour of each class, kept until the choice or the scheme changes
  function colours() {
    if (painter) return painter;
    const column = named.get(self.colour);
    if (!column) return (painter = { of: () => 0, shades: [report.colour("blue")], entries: [] });
    if (column.truth) return (painter = { of: (row) => [1, 0][column.values[row]] ?? 2, shades: ["green", "vermillion", "faint"].map((name) => report.colour(name)), entries: ["yes", "no"].map((word) => `${column.name}: ${word}`) });
    if (column.levels && column.levels.length <= data.cycle.length) {
      const at = new Map(column.levels.map((level, k) => [level, k]));
      return (painter = { of: (row) => at.get(column.values[row]) ?? column.levels.length, shades: [...column.levels.map((_, k) => report.colour(data.cycle[k].slice(1))), report.colour("faint")], entries: column.levels.map((level) => text(column, level)) });
    }
    const span = column.high - column.low || 1, shades = Array.from({ length: MIX }, (_, k) => mixed(k / (MIX - 1)));
    const of = (row) => { const v = column.values[row]; return Number.isFinite(v) ? Math.min(Math.floor(((v - column.low) / span) * MIX), MIX - 1) : MIX; };
    const entries = shades.map((_, k) => (k === 0 ? text(column, column.low) : k === MIX - 1 ? `${text(column, column.high)} ${column.unit}` : ""));
    return (painter = { of, shades: [...shades, report.colour("faint")], entries });
  }

  function legend() {
    const { shades, entries } = colours(), list = document.getElementById("colours");
    list.replaceChildren(...entries.map((word, k) => {
      const item = document.createElement("li"), swatch = document.createElement("i");
      swatch.style.borderColor = shades[k];
      item.append(swatch, word);
      return item;
    }));
  }

  // ---- which are chosen

  const every = Uint32Array.from({ length: count }, (_, row) => row);
  const self = { runs, count, columns, varying, named, text, error, colours, colour: data.colour, chosen: every, isChosen: new Uint8Array(count).fill(1), ranges: new Map(), levels: new Map(), row: null, over: null, version: 0, moving: false, rowOf: (number) => place.get(number), boxes: {} };
  const listeners = [];
  self.listen = (listener) => listeners.push(listener);  // told "choice", "rest", "row", "over" or "colour"
  const tell = (what) => { for (const listener of listeners) listener(what); };

  function choose() {
    const tests = [];
    for (const [name, [low, high]] of self.ranges) { const { values } = named.get(name); tests.push((row) => values[row] >= low && values[row] <= high); }
    for (const [name, levels] of self.levels) { const { values } = named.get(name); tests.push((row) => levels.has(values[row])); }
    self.isChosen = Uint8Array.from(every, (row) => (tests.every((test) => test(row)) ? 1 : 0));
    self.chosen = tests.length ? every.filter((row) => self.isChosen[row]) : every;
    document.getElementById("count").textContent = `${self.chosen.length} of ${count} runs are chosen`;
    document.getElementById("all").hidden = !tests.length;
    self.version += 1;
    tell("choice");
  }

  let waiting = false, resting = 0;  // at most one choice a frame while a pointer moves, and fewer lines until it rests
  function soon() {
    self.moving = true;
    clearTimeout(resting);
    resting = setTimeout(() => { self.moving = false; self.version += 1; tell("rest"); }, 250);
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; choose(); });
  }

  self.setRange = (name, range) => {
    if (range) self.ranges.set(name, range); else self.ranges.delete(name);
    soon();
  };

  self.toggleLevel = (name, level) => {
    const levels = self.levels.get(name) || new Set();
    if (!levels.delete(level)) levels.add(level);
    if (levels.size) self.levels.set(name, levels); else self.levels.delete(name);
    soon();
    return levels.has(level);
  };

  self.show = (row) => { self.row = row; tell("row"); };
  self.point = (row) => { if (row !== self.over) { self.over = row; tell("over"); } };

  document.getElementById("all").addEventListener("click", () => {
    self.ranges.clear();
    self.levels.clear();
    for (const button of document.querySelectorAll("[data-level]")) button.setAttribute("aria-pressed", "false");
    soon();
  });
  for (const button of document.querySelectorAll("[data-level]")) {
    button.addEventListener("click", () => button.setAttribute("aria-pressed", self.toggleLevel(button.parentElement.dataset.column, +button.dataset.level)));
  }

  // ---- colour by

  const select = document.getElementById("colour");
  select.append(new Option("nothing", ""), ...varying.map((column) => new Option(column.title, column.name)));
  select.value = self.colour;
  select.addEventListener("change", () => { self.colour = select.value; repaint(); });
  function repaint() { painter = null; self.version += 1; legend(); tell("colour"); }
  addEventListener("scheme", repaint);

  self.opened = () => { window.study = self; legend(); choose(); };
  return self;
})();
