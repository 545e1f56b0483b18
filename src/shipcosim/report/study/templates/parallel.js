// Parallel coordinates: an axis a column, a line a run; a drag along an axis chooses a range of it.
(() => {
  const { columns, varying, named } = study, { colour } = report;
  const frame = document.getElementById("parallel"), place = frame.querySelector("canvas"), names = frame.querySelector(".axes");
  const MOST_AXES = 12, MOST_LINES = 3000, MOVING = 600, BEHIND = 800, NARROWEST = 92, TOP = 10, BOTTOM = 30, GAP = 14, REACH = 22;
  const rank = { factor: 0, sample: 1, quantity: 2, summary: 3 };
  let shown = [...varying].sort((a, b) => rank[a.role] - rank[b.role]).slice(0, MOST_AXES).map((column) => column.name);

  // ---- where things are

  const wide = () => place.clientWidth, tall = () => place.clientHeight;
  const across = (k) => (wide() / shown.length) * (k + 0.5);
  const end = () => tall() - BOTTOM;
  function down(column, v) {  // below the axis where there is no value
    const foot = end() - GAP;
    return Number.isFinite(v) ? foot - ((v - column.low) / (column.high - column.low || 1)) * (foot - TOP) : end();
  }
  const valueAt = (column, y) => column.low + ((end() - GAP - y) / (end() - GAP - TOP)) * (column.high - column.low);

  function even(rows, most) {
    if (rows.length <= most) return rows;
    return Uint32Array.from({ length: most }, (_, k) => rows[Math.floor((k * rows.length) / most)]);
  }

  function trace(c, axes, row) {
    c.beginPath();
    axes.forEach(({ column, x }, k) => { const y = down(column, column.values[row]); if (k) c.lineTo(x, y); else c.moveTo(x, y); });
    c.stroke();
  }

  function lines(c, axes) {
    c.lineJoin = "round";
    c.lineWidth = 1;
    if (study.chosen.length < study.count) {
      c.strokeStyle = colour("faint/0.18");
      for (const row of even(Uint32Array.from({ length: study.count }, (_, k) => k), study.moving ? MOVING / 2 : BEHIND)) if (!study.isChosen[row]) trace(c, axes, row);
    }
    const { of, shades } = study.colours(), rows = even(study.chosen, study.moving ? MOVING : MOST_LINES);
    c.globalAlpha = Math.min(Math.max(5 / Math.sqrt(rows.length || 1), 0.07), 0.9);
    for (const row of rows) { c.strokeStyle = shades[of(row)]; trace(c, axes, row); }
    study.lines = rows.length;
  }

  function ticksOf(column) {
    const room = Math.floor((end() - GAP - TOP) / 18);
    if (!column.levels) return study.ticks(column.low, column.high, Math.min(room, 6)).map((v) => [v, `${+v.toPrecision(6)}`.replace("-", "−")]);
    const every = Math.ceil(column.levels.length / room), apart = (v) => down(column, v);
    let last = Infinity;
    return column.levels.filter((_, k) => k % every === 0).filter((v) => { const free = last - apart(v) >= 13; if (free) last = apart(v); return free; }).map((v) => [v, study.text(column, v)]);
  }

  function cut(c, text, most) {
    if (c.measureText(text).width <= most) return text;
    let n = text.length;
    while (n > 1 && c.measureText(`${text.slice(0, n)}…`).width > most) n -= 1;
    return `${text.slice(0, n)}…`;
  }

  function paint(target) {
    const { context: c } = target, axes = shown.map((name, k) => ({ column: named.get(name), x: across(k) })), room = wide() / shown.length - 14;
    target.layer(`${study.version} ${shown}`, (layer) => lines(layer, axes));
    for (const { column, x } of axes) {
      c.strokeStyle = colour("soft"); c.lineWidth = 1;
      c.beginPath(); c.moveTo(x, TOP); c.lineTo(x, end() - GAP); c.stroke();
      const range = study.ranges.get(column.name);
      if (range) {
        const [a, b] = range.map((v) => Math.min(Math.max(down(column, v), TOP - 4), end() - GAP + 4));
        c.fillStyle = colour("blue/0.25"); c.strokeStyle = colour("blue");
        c.fillRect(x - 6, b, 12, Math.max(a - b, 3)); c.strokeRect(x - 6, b, 12, Math.max(a - b, 3));
      }
      for (const [v, text] of ticksOf(column)) {
        const y = down(column, v);
        c.strokeStyle = colour("soft"); c.lineWidth = 1; c.beginPath(); c.moveTo(x - 3, y); c.lineTo(x + 3, y); c.stroke();
        target.write(cut(c, text, room), x + 6, y, { shade: "ink" });
      }
    }
    const lacking = axes.find(({ column }) => column.values.some(Number.isNaN));
    if (lacking) target.write("none", lacking.x, end() + 14, { align: "center" });
    for (const row of [study.over, study.row]) {
      if (row === null) continue;
      c.strokeStyle = colour("ink"); c.lineWidth = 2.2;
      trace(c, axes, row);
    }
  }

  // ---- names of the axes, and which are shown

  const canvas = study.canvas(place, paint);

  function layOut() {
    frame.style.minWidth = `${shown.length * NARROWEST}px`;
    names.replaceChildren(...shown.map((name) => {
      const column = named.get(name), label = document.createElement("span"), small = document.createElement("small");
      label.title = column.description || name;
      small.textContent = column.unit;
      label.append(name, document.createElement("br"), small);
      return label;
    }));
    canvas.soon();
  }

  const choice = document.querySelector("#axes .levels");
  for (const column of varying) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: column.name, title: column.description });
    button.setAttribute("aria-pressed", shown.includes(column.name));
    button.addEventListener("click", () => {
      const without = shown.filter((name) => name !== column.name);
      if (shown.includes(column.name) && without.length < 2) return;
      shown = shown.includes(column.name) ? without : varying.filter(({ name }) => name === column.name || shown.includes(name)).map(({ name }) => name);
      study.setRange(column.name, null);
      button.setAttribute("aria-pressed", shown.includes(column.name));
      layOut();
    });
    choice.append(button);
  }

  // ---- the pointer

  const nearest = (x) => { const k = Math.round((x / wide()) * shown.length - 0.5); return k >= 0 && k < shown.length && Math.abs(across(k) - x) < REACH ? k : null; };
  let drag = null;
  place.addEventListener("pointerdown", (event) => {
    const [x, y] = study.at(event, place), k = nearest(x);
    if (k === null) return;
    drag = { column: named.get(shown[k]), from: y };
    place.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  place.addEventListener("pointermove", (event) => {
    const [x, y] = study.at(event, place);
    place.style.cursor = nearest(x) === null ? "" : "row-resize";
    if (!drag || Math.abs(y - drag.from) < 3) return;
    const ends = [drag.from, y].map((at) => valueAt(drag.column, at)).sort((a, b) => a - b);
    study.setRange(drag.column.name, ends);
  });
  place.addEventListener("pointerup", (event) => {
    if (drag && Math.abs(study.at(event, place)[1] - drag.from) < 3) study.setRange(drag.column.name, null);
    drag = null;
  });
  place.addEventListener("pointercancel", () => { drag = null; });

  study.axes = () => shown.map((name, k) => ({ name, x: across(k), top: down(named.get(name), named.get(name).high), bottom: down(named.get(name), named.get(name).low) }));
  if (shown.length < 2) frame.parentElement.hidden = document.getElementById("axes").hidden = true;
  study.listen(() => canvas.soon());
  layOut();
})();
