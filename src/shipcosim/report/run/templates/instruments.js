// The instruments of the scene: heading scale with wind, current and waves, figures, and the load of every thruster.
(() => {
  if (!scene) return;
  const { runs, colour, compass, wrapped, arrow, stroke } = scene, two = runs.length > 1;
  const three = (degrees) => `${compass(+degrees.toFixed(1)).toFixed(1).padStart(5, "0")}°`;
  const whole = (degrees) => `${String(Math.round(compass(degrees)) % 360).padStart(3, "0")}°`;
  const signed = (v, digits = 2) => (Number.isFinite(v) ? (v < -0.5 * 10 ** -digits ? "−" : v > 0.5 * 10 ** -digits ? "+" : " ") + plain(Math.abs(v), digits) : "–");
  const plain = (v, digits = 2) => (Number.isFinite(v) ? (Math.abs(v) >= 1e6 ? v.toExponential(2) : v.toFixed(digits)).replace(/^-(0\.0*)$/, "$1").replace("-", "−") : "–");
  const FLOW = { wind: "sky", current: "blue", waves: "green" };

  // ---- heading scale

  const dial = scene.canvas("compass", (width) => Math.min(width, 250)), layer = scene.layer();

  function scale(c, x, y, R, on) {
    c.beginPath(); c.arc(x, y, R, 0, 2 * Math.PI); c.fillStyle = colour("sea"); c.fill(); stroke(c, "faint", 1);
    c.beginPath();
    for (let a = 0; a < 360; a += 10) { c.moveTo(...on(a, R)); c.lineTo(...on(a, R - (a % 30 ? 5 : 10))); }
    stroke(c, "soft", 1);
    c.textAlign = "center"; c.textBaseline = "middle";
    for (let a = 0; a < 360; a += 30) {
      c.fillStyle = colour(a % 90 ? "soft" : "ink");
      c.fillText(a % 90 ? String(a).padStart(3, "0") : "NESW"[a / 90], ...on(a, R + 12));
    }
  }

  scene.paints((states) => {
    const target = dial(), { context: c, width, height } = target, x = width / 2, y = height / 2, R = Math.min(width, height) / 2 - 24, drawn = [];
    const on = (degrees, radius) => [x + radius * Math.sin((degrees * Math.PI) / 180), y - radius * Math.cos((degrees * Math.PI) / 180)];
    layer(target, "", (still) => scale(still, x, y, R, on));
    const main = states.find((state) => state.flows.length) || states[0];
    for (const flow of main.flows) {
      if (!(flow.size > 0) || !Number.isFinite(flow.degrees)) continue;
      const from = flow.sense === "from", inner = { wind: 0.62, waves: 0.4, current: 0.36 }[flow.what] * R, outer = { wind: 0.9, waves: 0.6, current: 0.66 }[flow.what] * R;
      const tail = on(flow.degrees, from ? outer : inner), tip = on(flow.degrees, from ? inner : outer);
      arrow(c, ...tail, ...tip, FLOW[flow.what], 4);
      drawn.push({ what: "flow", of: flow.what, degrees: flow.degrees, sense: flow.sense, size: flow.size });
    }
    for (const { run, state } of chosen(states)) {
      const length = 0.3 * R, wide = Math.min(length * (state.vessel.size[1] / state.vessel.size[0]), 0.8 * length), a = (state.heading * Math.PI) / 180;
      const [f, b] = state.vessel.outline, [l, w] = state.vessel.size;
      c.beginPath();
      f.forEach((fore, k) => { const u = (fore / l) * 2 * length, v = (b[k] / w) * 2 * wide; c.lineTo(x + Math.sin(a) * u + Math.cos(a) * v, y - Math.cos(a) * u + Math.sin(a) * v); });
      c.closePath(); c.fillStyle = colour(`${run.colour}/0.3`); c.fill(); stroke(c, run.colour, 1.5);
      const aim = state.aims.reference || state.aims["set point"];
      if (aim && Number.isFinite(aim.heading)) {
        if (run.watch.heading) { c.beginPath(); for (const side of [-1, 1]) { c.moveTo(...on(aim.heading + side * run.watch.heading, R)); c.lineTo(...on(aim.heading + side * run.watch.heading, R - 16)); } stroke(c, Math.abs(state.off.heading) > run.watch.heading ? "alarm" : "caution", 2); }
        wedge(c, on, aim.heading, R, R - 13); stroke(c, two ? run.colour : "orange", 2);
        drawn.push({ what: "pointer", of: "aim", run: run.label, degrees: compass(aim.heading) });
      }
      wedge(c, on, state.heading, R - 1, R - 15); c.fillStyle = colour(run.colour); c.fill();
      c.beginPath(); c.moveTo(...on(state.heading, 2 * length * 0.5)); c.lineTo(...on(state.heading, R - 15)); stroke(c, run.colour, 1.5);
      drawn.push({ what: "pointer", of: "heading", run: run.label, degrees: compass(state.heading) });
    }
    return drawn;
  });

  const chosen = (states) => states.map((one) => ({ run: one.run, state: scene.of(one) })).filter(({ state }) => state);

  function wedge(c, on, degrees, outer, inner) {
    c.beginPath(); c.moveTo(...on(degrees, outer)); c.lineTo(...on(degrees - 5, inner)); c.lineTo(...on(degrees + 5, inner)); c.closePath();
  }

  // ---- figures

  const table = document.getElementById("scene-figures");
  scene.writes((states) => {
    const rows = two ? compared(states) : single(chosen(states)[0]?.state);
    for (const what of Object.keys(FLOW)) {
      const found = states.map(({ flows }) => flows.find((flow) => flow.what === what));
      if (!found.some(Boolean)) continue;
      const said = found.map((flow) => (flow ? `${plain(flow.size, 1)} ${flow.unit} ${flow.sense} ${whole(flow.degrees)}` : "–"));
      const same = said.every((text) => text === said[0]);
      rows.push([what[0].toUpperCase() + what.slice(1), same ? said[0] : said.map((text, k) => `${runs[k].label} ${text}`).join(", ")]);
    }
    write(rows);
  });

  function single(state) {
    if (!state) return [["", "not in the run at this time"]];
    const { aims, off } = state, word = aims.reference ? "reference" : aims["set point"] ? "set point" : "", aim = aims[word] || {};
    const rows = [["", "now", ...(word ? [word, "off by"] : [])]];
    const line = (name, now, want, by) => rows.push([name, now, ...(word ? [want, by] : [])]);
    line("North [m]", plain(state.north), plain(aim.north), signed(off?.north));
    line("East [m]", plain(state.east), plain(aim.east), signed(off?.east));
    line("Heading", three(state.heading), Number.isFinite(aim.heading) ? three(aim.heading) : "–", Number.isFinite(off?.heading) ? `${signed(off.heading, 1)}°` : "–");
    if (off) rows.push(["Off", `${plain(off.distance)} m: ${plain(Math.abs(off.ahead))} ${off.ahead < 0 ? "aft" : "fwd"}, ${plain(Math.abs(off.starboard))} ${off.starboard < 0 ? "port" : "stbd"}`]);
    if (Number.isFinite(state.u + state.v)) rows.push(["Speed", `${plain(Math.hypot(state.u, state.v))} m/s: ${plain(Math.abs(state.u))} ${state.u < 0 ? "aft" : "fwd"}, ${plain(Math.abs(state.v))} ${state.v < 0 ? "port" : "stbd"}`]);
    if (Number.isFinite(state.r)) rows.push(["Turning", `${plain(Math.abs(state.r))}°/s to ${state.r < 0 ? "port" : "stbd"}`]);
    return rows;
  }

  function compared(states) {
    const found = states.map(scene.of), [a, b] = found, pair = found.length === 2;  // of three ships no difference, but how far each is from the first
    const rows = [["", ...runs.map((run) => run.label), ...(pair ? ["difference"] : [])]];
    const line = (name, read, digits) => { const v = found.map((s) => (s ? read(s) : NaN)); if (v.some(Number.isFinite)) rows.push([name, ...v.map((one) => plain(one, digits)), ...(pair ? [signed(v[1] - v[0], digits)] : [])]); };
    line("North [m]", (s) => s.north, 2);
    line("East [m]", (s) => s.east, 2);
    rows.push(["Heading", ...found.map((s) => (s ? three(s.heading) : "–")), ...(pair ? [a && b ? `${signed(wrapped(b.heading - a.heading), 1)}°` : "–"] : [])]);
    line("Off [m]", (s) => s.off?.distance ?? NaN, 2);
    line("Speed [m/s]", (s) => Math.hypot(s.u, s.v), 2);
    const apart = (s) => (a && s ? `${plain(Math.hypot(a.north - s.north, a.east - s.east))} m` : "–");
    if (pair ? a && b : a) rows.push(["Apart", ...(pair ? [apart(b)] : found.map((s) => (s === a ? "" : apart(s))))]);
    return rows;
  }

  function write(rows) {  // cells that stay are not made again
    while (table.rows.length > rows.length) table.deleteRow(-1);
    rows.forEach((texts, k) => {
      const row = table.rows[k] || table.insertRow();
      while (row.cells.length > texts.length) row.deleteCell(-1);
      texts.forEach((text, i) => {
        const cell = row.cells[i] || row.insertCell(), span = i === texts.length - 1 ? 4 - i : 1;
        if (cell.textContent !== text) cell.textContent = text;
        if (cell.colSpan !== span) cell.colSpan = span;
      });
    });
  }

  // ---- thrusters

  const units = () => runs.flatMap((run) => scene.vesselOf(run)?.units ?? []);
  const names = () => [...new Set(units().map((unit) => unit.name))];
  const BAR = two ? 44 : 30, bars = scene.canvas("thrust", () => names().length * BAR + (names().length ? 24 : 0));

  scene.paints((states) => {
    const { context: c, width } = bars(), drawn = [], all = names();
    if (!all.length) return drawn;
    const left = Math.min(90, 0.28 * width), right = width - 104, middle = (left + right) / 2, half = (right - left) / 2;
    c.textBaseline = "middle"; c.fillStyle = colour("soft"); c.textAlign = "left"; c.fillText(report.data.bars ?? "Thrusters", 0, 10);
    const tall = two ? 12 : 14;
    all.forEach((name, k) => {
      const y = 24 + k * BAR + BAR / 2;
      c.fillStyle = colour("ink"); c.textAlign = "left"; c.fillText(fitted(c, name, left - 8), 0, y);
      chosen(states).forEach(({ run, state }, rank) => {
        const found = state.units.find(({ unit }) => unit.name === name);
        if (!found) return;
        const { thrust, command, limits, azimuth, state: how, unit } = found, most = Math.max(Math.abs(limits[0]), limits[1]) || 1, top = y - (two ? (rank ? -3 : tall + 3) : tall / 2);
        const at = (kN) => middle + (half * Math.max(-1, Math.min(1, kN / most)));
        c.fillStyle = colour("chart-grid"); c.fillRect(at(limits[0]), top, at(limits[1]) - at(limits[0]), tall);
        c.fillStyle = colour(how === "runs" ? run.colour : how === "limit" ? "caution" : "alarm");
        if (Number.isFinite(thrust)) c.fillRect(Math.min(middle, at(thrust)), top, Math.abs(at(thrust) - middle), tall);
        if (how === "failed") c.fillRect(middle - 2, top, 4, tall);
        c.beginPath(); c.moveTo(middle, top - 2); c.lineTo(middle, top + tall + 2); stroke(c, "soft", 1);
        if (Number.isFinite(command)) { c.beginPath(); c.moveTo(at(command), top + tall / 2); c.lineTo(at(command) - 4, top - 4); c.lineTo(at(command) + 4, top - 4); c.closePath(); c.fillStyle = colour("ink"); c.fill(); }
        c.fillStyle = colour(how === "runs" ? "ink" : how === "limit" ? "caution-text" : "alarm"); c.textAlign = "right";
        const angle = Number.isFinite(azimuth) && !two ? ` ${plain(wrapped(azimuth), 0)}°` : "";  // from the bow, as in the diagram
        c.fillText(how === "failed" ? "failed" : `${plain(thrust, 1)} kN${angle}`, width, two ? top + tall / 2 : y);
        drawn.push({ what: "bar", run: run.label, unit: unit.name, thrust, command, share: thrust / (thrust < 0 ? -limits[0] : limits[1]), from: middle, to: at(thrust), state: how });
      });
    });
    return drawn;
  });

  function fitted(c, text, width) {  // what is too long loses its middle: names begin, or end, alike
    let shown = text;
    for (let n = text.length - 2; n > 3 && c.measureText(shown).width > width; n--) shown = `${text.slice(0, Math.ceil(n / 2))}…${text.slice(text.length - Math.floor(n / 2))}`;
    return shown;
  }
})();
