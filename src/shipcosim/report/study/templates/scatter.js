// Dots of any two columns; a drag over an area chooses its runs, a click shows the nearest one.
(() => {
  const { varying, named } = study, { colour } = report;
  const place = document.getElementById("scatter"), selects = ["across", "up"].map((id) => document.getElementById(id));
  const LEFT = 62, RIGHT = 12, TOP = 24, BOTTOM = 42, REACH = 14;
  if (varying.length < 2) { place.closest("figure").hidden = true; return; }
  const numbers = varying.filter((column) => !column.labels.length && !column.truth);
  const quantities = numbers.filter((column) => column.role === "quantity"), causes = varying.filter((column) => column.role !== "quantity");
  const up = quantities[0] || numbers[numbers.length - 1] || varying[1], first = [...quantities.slice(1), ...causes, ...varying].find((column) => column !== up);
  selects.forEach((select, k) => {
    select.append(...varying.map((column) => new Option(column.title, column.name)));
    select.value = [first, up][k].name;
    select.addEventListener("change", () => canvas.soon());
  });

  const ends = (column) => { const margin = 0.04 * (column.high - column.low); return [column.low - margin, column.high + margin]; };
  function scales() {
    const [x, y] = selects.map((select) => named.get(select.value)), [left, right] = ends(x), [low, high] = ends(y), { width, height } = canvas.target;
    const wide = width - LEFT - RIGHT, tall = height - TOP - BOTTOM;
    return { x, y, across: (v) => LEFT + ((v - left) / (right - left)) * wide, down: (v) => TOP + ((high - v) / (high - low)) * tall, east: (px) => left + ((px - LEFT) / wide) * (right - left), north: (py) => high - ((py - TOP) / tall) * (high - low), wide, tall };
  }

  function ticks(column, room, apart) {
    if (!column.levels || (!column.labels.length && !column.truth)) return study.ticks(column.low, column.high, room).map((v) => [v, `${+v.toPrecision(6)}`.replace("-", "−")]);
    const every = Math.ceil(column.levels.length / apart);
    return column.levels.filter((_, k) => k % every === 0).map((v) => [v, study.text(column, v)]);
  }

  function short(c, text, most) {
    let n = text.length;
    while (n > 1 && c.measureText(n < text.length ? `${text.slice(0, n)}…` : text).width > most) n -= 1;
    return n < text.length ? `${text.slice(0, n)}…` : text;
  }

  function paint(target) {
    const { context: c, width, height } = target, s = scales(), room = Math.max(Math.floor(s.wide / 80), 2), cell = s.wide / Math.min(room, 9);
    c.strokeStyle = colour("grid"); c.lineWidth = 1;
    const columns = ticks(s.x, room, room), rows = ticks(s.y, Math.max(Math.floor(s.tall / 40), 2), Math.floor(s.tall / 18));
    for (const [v] of columns) { c.beginPath(); c.moveTo(s.across(v), TOP); c.lineTo(s.across(v), height - BOTTOM); c.stroke(); }
    for (const [v] of rows) { c.beginPath(); c.moveTo(LEFT, s.down(v)); c.lineTo(width - RIGHT, s.down(v)); c.stroke(); }
    target.layer(`${study.version} ${s.x.name} ${s.y.name}`, (layer) => dots(layer, s));
    for (const row of [study.over, study.row]) {
      if (row === null) continue;
      c.strokeStyle = colour("ink"); c.lineWidth = 2;
      c.beginPath(); c.arc(s.across(s.x.values[row]), s.down(s.y.values[row]), 7, 0, 2 * Math.PI); c.stroke();
    }
    for (const [v, text] of columns) {
      const name = short(c, text, Math.min(cell, s.wide / columns.length) - 6), half = c.measureText(name).width / 2;
      target.write(name, Math.min(s.across(v), width - 2 - half), height - BOTTOM + 13, { align: "center" });
    }
    for (const [v, text] of rows) target.write(short(c, text, LEFT - 8), LEFT - 6, s.down(v), { align: "right" });
    target.write(s.y.title, 4, 9, { shade: "ink" });
    target.write(s.x.title, width - RIGHT, height - 9, { align: "right", shade: "ink" });
    if (drag && drag.to) { c.strokeStyle = colour("blue"); c.fillStyle = colour("blue/0.12"); const [a, b] = drag.from, [d, e] = drag.to; c.fillRect(a, b, d - a, e - b); c.strokeRect(a, b, d - a, e - b); }
  }

  function dots(c, s) {
    const { of, shades } = study.colours(), size = study.count > 3000 ? 3 : 5, h = size / 2;
    if (study.chosen.length < study.count) {
      c.fillStyle = colour("faint/0.35");
      for (let row = 0; row < study.count; row += 1) if (!study.isChosen[row]) c.fillRect(s.across(s.x.values[row]) - h, s.down(s.y.values[row]) - h, size, size);
    }
    c.globalAlpha = Math.min(Math.max(30 / Math.sqrt(study.chosen.length || 1), 0.25), 0.85);
    shades.forEach((shade, k) => {
      c.fillStyle = shade;
      for (const row of study.chosen) if (of(row) === k) c.fillRect(s.across(s.x.values[row]) - h, s.down(s.y.values[row]) - h, size, size);
    });
  }

  // ---- the pointer

  let drag = null;
  function nearest([px, py]) {
    const s = scales();
    let best = null, least = REACH ** 2;
    for (const row of study.chosen) {
      const d = (s.across(s.x.values[row]) - px) ** 2 + (s.down(s.y.values[row]) - py) ** 2;
      if (d < least) { least = d; best = row; }
    }
    return best;
  }
  place.addEventListener("pointerdown", (event) => { drag = { from: study.at(event, place), to: null }; place.setPointerCapture(event.pointerId); });
  place.addEventListener("pointermove", (event) => {
    const here = study.at(event, place);
    if (!drag) { study.point(nearest(here)); return; }
    if (drag.to || Math.hypot(here[0] - drag.from[0], here[1] - drag.from[1]) > 4) { drag.to = here; canvas.soon(); }
  });
  place.addEventListener("pointerleave", () => study.point(null));
  place.addEventListener("pointerup", () => {
    const done = drag;
    drag = null;
    if (!done) return;
    if (!done.to) { const row = nearest(done.from); if (row !== null) study.show(row); return; }
    const s = scales(), [a, b] = done.from, [d, e] = done.to;
    study.setRange(s.x.name, [s.east(Math.min(a, d)), s.east(Math.max(a, d))]);
    study.setRange(s.y.name, [s.north(Math.max(b, e)), s.north(Math.min(b, e))]);
  });
  place.addEventListener("pointercancel", () => { drag = null; canvas.soon(); });

  const canvas = study.canvas(place, paint);
  study.listen(() => canvas.soon());
})();
