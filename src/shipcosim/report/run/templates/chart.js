// The chart of the scene: grid, trails, ships to scale with their thrusters, set points and circles; north up.
(() => {
  if (!scene) return;
  const { runs, colour, placed } = scene;
  const place = document.getElementById("scene-chart"), sized = scene.canvas("chart"), key = document.getElementById("scene-key");
  const view = { follow: false, zoom: 1, east: 0, north: 0 };  // what the reader chose over what is shown by itself

  // ---- what there is to see

  const size = (vessel) => vessel.size[0];
  const largest = report.live ? Math.max(...runs.flatMap((run) => run.vessels.flatMap((vessel) => vessel.units.map(({ limits, largest: most }) => Math.max(...(limits || [most]).map(Math.abs))))), 0) : Math.max(...runs.flatMap((run) => run.vessels.flatMap((vessel) => vessel.units.flatMap((unit) => (unit.force && unit.place ? forces(run, unit) : [])))), 0);
  function forces(run, unit) {
    const [x, y] = unit.force.map((name) => run.columns[name]);
    let most = 0;
    for (let k = 0; k < x.length; k++) { const f = Math.hypot(x[k], y[k]); if (f > most) most = f; }
    return most;
  }
  const VECTOR = 0.6;  // length of the largest force, over the ship's

  const box = { east: [Infinity, -Infinity], north: [Infinity, -Infinity] };
  let seen = 0;  // rows of a run that goes on which the box holds
  function extend() {
    const first = seen;
    seen = runs[0].time.length;
    const hold = (e, n, around) => {
      if (!Number.isFinite(e + n)) return;
      box.east = [Math.min(box.east[0], e - around), Math.max(box.east[1], e + around)];
      box.north = [Math.min(box.north[0], n - around), Math.max(box.north[1], n + around)];
    };
    for (const run of runs) {
      for (const vessel of run.vessels) {
        const [north, east] = vessel.pose.map((name) => run.columns[name]);
        for (let k = first; k < north.length; k++) hold(east[k], north[k], 0.6 * size(vessel));
        for (const [n, e] of Object.values(vessel.aims).map((names) => names.map((name) => run.columns[name]))) for (let k = first; k < n.length; k += 10) hold(e[k], n[k], 0);
      }
      for (const { centre, radius } of run.circles) hold(centre[1], centre[0], radius);
    }
  }
  extend();

  function projection(width, height, states) {
    if (report.live && seen !== runs[0].time.length) extend();
    let [west, east] = box.east, [south, north] = box.north;
    for (const place of scene.future || []) {  // a forecast that is shown is in view
      const around = 0.6 * size(runs[0].vessels[0]);
      west = Math.min(west, place.east - around); east = Math.max(east, place.east + around);
      south = Math.min(south, place.north - around); north = Math.max(north, place.north + around);
    }
    const middle = { east: (west + east) / 2, north: (south + north) / 2 };
    let scale = Math.min((width - 70) / (east - west || 1), (height - 50) / (north - south || 1));
    const own = states.map(scene.of).find(Boolean);
    if (view.follow && own) {
      Object.assign(middle, { east: own.east, north: own.north });
      scale = Math.max(scale, Math.min(width, height) / (3.2 * size(own.vessel)));
    }
    scale *= view.zoom;
    middle.east += view.east; middle.north += view.north;
    return { scale, x: (east) => width / 2 + 12 + (east - middle.east) * scale, y: (north) => height / 2 - 8 - (north - middle.north) * scale, east: (x) => middle.east + (x - width / 2 - 12) / scale, north: (y) => middle.north - (y - height / 2 + 8) / scale };
  }

  function nice(least) {
    const power = 10 ** Math.floor(Math.log10(least));
    return [1, 2, 5, 10].map((n) => n * power).find((step) => step >= least);
  }

  // ---- painting

  function path(c, p, east, north, closed) {  // points that lie within a pixel of the last are left out
    c.beginPath();
    let x = NaN, y = NaN;
    for (let k = 0; k < east.length; k++) {
      const nextX = p.x(east[k]), nextY = p.y(north[k]);
      if (!Number.isFinite(nextX + nextY)) { x = y = NaN; continue; }
      if (Number.isNaN(x)) c.moveTo(nextX, nextY);
      else if (Math.abs(nextX - x) + Math.abs(nextY - y) > 0.8 || k === east.length - 1) c.lineTo(nextX, nextY);
      else continue;
      x = nextX; y = nextY;
    }
    if (closed) c.closePath();
  }

  function stroke(c, shade, width, dash = []) {
    c.strokeStyle = colour(shade); c.lineWidth = width; c.setLineDash(dash); c.stroke(); c.setLineDash([]);
  }

  function grid(c, p, width, height) {
    const step = nice(72 / p.scale), digits = Math.max(0, -Math.floor(Math.log10(step)));
    c.fillStyle = colour("soft"); c.textBaseline = "middle";
    c.save(); c.beginPath(); c.rect(46, 0, width - 46, height - 22); c.clip(); c.beginPath();
    for (let e = Math.ceil(p.east(46) / step) * step; p.x(e) < width; e += step) { c.moveTo(p.x(e), 0); c.lineTo(p.x(e), height - 22); }
    for (let n = Math.ceil(p.north(height - 22) / step) * step; p.y(n) > 0; n += step) { c.moveTo(46, p.y(n)); c.lineTo(width, p.y(n)); }
    stroke(c, "chart-grid", 1); c.restore();
    c.textAlign = "center";
    for (let e = Math.ceil(p.east(60) / step) * step; p.x(e) < width - 24; e += step) c.fillText(number(e, digits), p.x(e), height - 11);
    c.textAlign = "right";
    for (let n = Math.ceil(p.north(height - 34) / step) * step; p.y(n) > 26; n += step) c.fillText(number(n, digits), 41, p.y(n));
    c.fillText("N [m]", 41, 12); c.fillText("E [m]", width - 4, height - 34);
  }
  const number = (v, digits) => (Math.abs(v) >= 1e6 ? v.toExponential(1) : (v === 0 ? 0 : v).toFixed(digits)).replace("-", "−").replace(/^−(0(\.0*)?)$/, "$1");

  function background(c, p, run) {
    if (report.live) return;  // there is no track yet to paint once
    for (const vessel of run.vessels) {
      const [north, east] = vessel.pose.map((name) => run.columns[name]), [n, e, h] = vessel.way;
      n.forEach((_, k) => { const corners = placed(vessel, n[k], e[k], h[k]); path(c, p, corners.east, corners.north, true); stroke(c, `${run.colour}/0.28`, 1, k ? [] : [5, 4]); });
      if (vessel.aims.reference) { const [rn, re] = vessel.aims.reference.map((name) => run.columns[name]); path(c, p, re, rn); stroke(c, runs.length > 1 ? `${run.colour}/0.55` : "orange", 1.3, [6, 5]); }
      path(c, p, east, north); stroke(c, `${run.colour}/0.35`, 1.2);
    }
  }

  function trails(c, p, { run, where }) {
    for (const vessel of run.vessels) {
      const [north, east] = vessel.pose.map((name) => run.columns[name]), until = where ? where.row + 1 : 0;
      if (report.live && vessel.aims.reference) { const [rn, re] = vessel.aims.reference.map((name) => run.columns[name].subarray(0, until)); path(c, p, re, rn); stroke(c, "orange", 1.3, [6, 5]); }
      path(c, p, east.subarray(0, until), north.subarray(0, until)); stroke(c, run.colour, 2);
    }
  }

  function circles(c, p, { run, vessels }, t) {
    const drawn = run.circles.map(({ centre, radius, during, passed }) => {
      const now = !during || (t >= during[0] && t <= during[1]);
      ring(c, p, centre[1], centre[0], radius); stroke(c, passed ? (now ? "green" : "green/0.45") : now ? "vermillion" : "vermillion/0.5", now ? 2.2 : 1.2);
      return { what: "circle", of: "expectation", run: run.label, east: centre[1], north: centre[0], radius, passed, now };
    });
    const aim = vessels.length && (vessels[0].aims.reference || vessels[0].aims["set point"]);
    if (run.watch.position && aim) {
      const beyond = vessels[0].off.distance > run.watch.position;
      ring(c, p, aim.east, aim.north, run.watch.position); stroke(c, beyond ? "alarm" : "caution", beyond ? 2.4 : 1.4, [9, 5]);
      drawn.push({ what: "circle", of: "watch", run: run.label, east: aim.east, north: aim.north, radius: run.watch.position, beyond });
    }
    return drawn;
  }

  function ring(c, p, east, north, radius) { c.beginPath(); c.arc(p.x(east), p.y(north), radius * p.scale, 0, 2 * Math.PI); }

  function aims(c, p, run, state) {
    return Object.entries(state.aims).map(([word, { north, east, heading }]) => {
      const x = p.x(east), y = p.y(north), shade = word === "set point" ? "ink" : runs.length > 1 ? run.colour : "orange";
      c.beginPath();
      if (word === "set point") { c.moveTo(x - 10, y); c.lineTo(x + 10, y); c.moveTo(x, y - 10); c.lineTo(x, y + 10); } else c.arc(x, y, 5, 0, 2 * Math.PI);
      stroke(c, shade, 2);
      if (word === "set point" && Number.isFinite(heading)) { const o = placed(state.vessel, north, east, heading); path(c, p, o.east, o.north, true); stroke(c, "ink/0.6", 1.2, [2, 3]); }
      return { what: word, run: run.label, vessel: state.vessel.name, east, north, heading };
    });
  }

  function ship(c, p, run, state, ghost) {
    const { vessel, hull } = state;
    path(c, p, hull.east, hull.north, true);
    if (ghost) { c.fillStyle = colour(`${run.colour}/0.1`); c.fill(); stroke(c, run.colour, 1.2, [4, 3]); return { what: "ghost", run: run.label, vessel: vessel.name, ...hull }; }
    if (runs.length === 1) { c.fillStyle = colour("hull"); c.fill(); }  // of two, both are seen
    c.fillStyle = colour(`${run.colour}/0.3`); c.fill(); stroke(c, run.colour, 2);
    const s = Math.sin((state.heading * Math.PI) / 180), n = Math.cos((state.heading * Math.PI) / 180), x = p.x(state.east), y = p.y(state.north), bow = 0.5 * size(vessel) * p.scale;
    c.beginPath(); c.moveTo(x + s * bow, y - n * bow); c.lineTo(x + s * (bow + 16), y - n * (bow + 16)); stroke(c, run.colour, 2);
    c.beginPath(); c.arc(x, y, 2.5, 0, 2 * Math.PI); c.fillStyle = colour(run.colour); c.fill();
    if (2 * bow < 16) { c.beginPath(); c.arc(x, y, 9, 0, 2 * Math.PI); stroke(c, run.colour, 2); }  // too small to see: marked
    return { what: "hull", run: run.label, vessel: vessel.name, colour: colour(run.colour), position: [state.north, state.east], heading: state.heading, ...hull };
  }

  const FORETOLD = ["purple", "olive", "sky"];  // of several predictors

  function predictions(c, p, { run, vessels, predicted }) {  // of the first vessel: line, places, regions, and where she came to be
    return predicted.flatMap((places, k) => {
      const own = vessels[0], shade = runs.length > 1 ? run.colour : FORETOLD[k % 3];
      if (!own) return [];
      path(c, p, [own.east, ...places.map((one) => one.east)], [own.north, ...places.map((one) => one.north)]); stroke(c, shade, 1.6, [7, 3]);
      return places.map(({ seconds, north, east, heading, radius, true: then }) => {
        const x = p.x(east), y = p.y(north), a = (heading * Math.PI) / 180;
        if (radius > 0) { ring(c, p, east, north, radius); c.fillStyle = colour(`${shade}/0.1`); c.fill(); stroke(c, shade, 1.2); }
        c.beginPath(); c.moveTo(x, y); c.lineTo(x + 14 * Math.sin(a), y - 14 * Math.cos(a)); stroke(c, shade, 2);
        c.beginPath(); c.arc(x, y, 3.5, 0, 2 * Math.PI); c.fillStyle = colour(shade); c.fill();
        if (then) { const u = p.x(then[1]), v = p.y(then[0]); c.beginPath(); c.moveTo(u - 4, v - 4); c.lineTo(u + 4, v + 4); c.moveTo(u + 4, v - 4); c.lineTo(u - 4, v + 4); stroke(c, runs.length > 1 ? run.colour : "ink", 1.5); }
        if (!places.some((one) => one.seconds > seconds && Math.hypot(p.x(one.east) - x, p.y(one.north) - y) < 32)) {  // else they lie over each other
          c.fillStyle = colour("ink"); c.textAlign = "left"; c.textBaseline = "middle"; c.fillText(`${seconds} s`, x + 8, y + 9);
        }
        return { what: "predicted", run: run.label, of: run.predicted[k].name, seconds, north, east, heading, radius, true: then };
      });
    });
  }

  function title(c, p, { vessel, hull }) {  // where there are several, beside the outline
    if (scene.vessels.length < 2) return;
    c.fillStyle = colour("ink"); c.textAlign = "left"; c.textBaseline = "middle";
    c.fillText(vessel.name, p.x(Math.max(...hull.east)) + 8, p.y((Math.max(...hull.north) + Math.min(...hull.north)) / 2));
  }

  function thrusters(c, p, run, { vessel, units, north, east, heading }) {
    const s = Math.sin((heading * Math.PI) / 180), n = Math.cos((heading * Math.PI) / 180), drawn = [];
    for (const { unit, force, state } of units) {
      if (!unit.place) continue;
      const [f, b] = unit.place, e0 = east + s * f + n * b, n0 = north + n * f - s * b, r = Math.min(Math.max(0.045 * size(vessel) * p.scale, 2.5), 11);
      c.beginPath(); c.arc(p.x(e0), p.y(n0), r, 0, 2 * Math.PI); c.fillStyle = colour("hull"); c.fill(); stroke(c, state === "runs" ? "ink" : state === "limit" ? "caution" : "alarm", state === "runs" ? 1.2 : 2.4);
      drawn.push({ what: "thruster", run: run.label, vessel: vessel.name, unit: unit.name, east: e0, north: n0, state });
      if (state === "failed") { const d = 0.7 * r; c.beginPath(); c.moveTo(p.x(e0) - d, p.y(n0) - d); c.lineTo(p.x(e0) + d, p.y(n0) + d); c.moveTo(p.x(e0) + d, p.y(n0) - d); c.lineTo(p.x(e0) - d, p.y(n0) + d); stroke(c, "alarm", 2); }
      if (!force || !Number.isFinite(force[0] + force[1]) || !largest) continue;
      const length = (VECTOR * size(vessel)) / largest, e1 = e0 + length * (s * force[0] + n * force[1]), n1 = n0 + length * (n * force[0] - s * force[1]);
      arrow(c, p.x(e0), p.y(n0), p.x(e1), p.y(n1), state === "limit" ? "caution" : run.colour, 3);
      drawn.push({ what: "force", run: run.label, vessel: vessel.name, unit: unit.name, from: [n0, e0], to: [n1, e1], force, metresPerKilonewton: length });
    }
    return drawn;
  }

  function arrow(c, x0, y0, x1, y1, shade, width) {
    const length = Math.hypot(x1 - x0, y1 - y0), head = Math.min(9, length);
    if (length < 1) return;
    const a = Math.atan2(y1 - y0, x1 - x0), bx = x1 - head * Math.cos(a), by = y1 - head * Math.sin(a);
    c.beginPath(); c.moveTo(x0, y0); c.lineTo(bx, by); stroke(c, shade, width);
    c.beginPath(); c.moveTo(x1, y1); c.lineTo(bx - head * 0.55 * Math.sin(a), by + head * 0.55 * Math.cos(a)); c.lineTo(bx + head * 0.55 * Math.sin(a), by - head * 0.55 * Math.cos(a)); c.closePath();
    c.fillStyle = colour(shade); c.fill();
  }
  scene.arrow = arrow; scene.stroke = stroke; scene.nice = nice;

  let shown = null;
  const layer = scene.layer();

  scene.paints((states, t) => {
    const target = sized(), { context: c, width, height } = target, p = (shown = projection(width, height, states)), drawn = [];
    const inside = (context) => { context.save(); context.beginPath(); context.rect(46, 0, width - 46, height - 22); context.clip(); };
    layer(target, [p.scale, p.x(0), p.y(0)], (still) => {
      still.fillStyle = colour("sea"); still.fillRect(0, 0, width, height);
      grid(still, p, width, height);
      inside(still);
      for (const run of runs) background(still, p, run);
      still.restore();
    });
    inside(c);
    for (const state of states) trails(c, p, state);
    if (scene.ghost !== null) for (const { run, vessels } of scene.at(scene.ghost)) for (const vessel of vessels) drawn.push(ship(c, p, run, vessel, true));
    for (const { run, vessels } of states) for (const vessel of vessels) drawn.push(ship(c, p, run, vessel));
    for (const state of states) drawn.push(...predictions(c, p, state), ...circles(c, p, state, t));
    for (const { run, vessels } of states) for (const vessel of vessels) { drawn.push(...aims(c, p, run, vessel), ...thrusters(c, p, run, vessel)); title(c, p, vessel); }
    c.restore();
    legend(p);
    return drawn;
  });
  scene.place = (x, y) => ({ east: shown.east(x), north: shown.north(y) });
  scene.outline = (c, { east, north }) => path(c, shown, east, north, true);
  scene.pixel = (east, north) => [shown.x(east), shown.y(north)];  // of the chart, in pixels of the style sheet

  // ---- key, and what the reader turns

  let words = "";
  function legend(p) {
    const kN = nice(largest / 4 || 1), vessel = runs[0].vessels[0], pixels = ((VECTOR * size(vessel)) / (largest || 1)) * kN * p.scale;
    const entries = runs.map((run) => [run.label || run.vessels.map((v) => v.name).join(", "), "line", run.colour]);
    const has = (what) => runs.some((run) => run.vessels.some((v) => v.aims[what]));
    if (has("reference")) entries.push(["reference", "dash", runs.length > 1 ? "soft" : "orange"]);
    if (has("set point")) entries.push(["set point", "cross", "ink"]);
    for (const [k, one] of (runs.length > 1 ? [] : runs[0].predicted.entries())) entries.push([`${one.name}: in ${one.horizons.join(", ")} s`, "dash", FORETOLD[k % 3]]);
    if (runs.length > 1 && runs.some((run) => run.predicted.length)) entries.push(["predicted", "dash", "soft"]);
    if (runs.some((run) => run.predicted.some((one) => one.radius.some((column) => column.some((r) => r > 0))))) entries.push(["region of 90 %", "ring", runs.length > 1 ? "soft" : FORETOLD[0]]);
    if (runs.some((run) => run.predicted.length)) entries.push(["× where she came to be", "none", "soft"]);
    if (runs.some((run) => run.circles.length)) entries.push(["limit held", "ring", "green"]);
    if (runs.some((run) => run.circles.some(({ passed }) => !passed))) entries.push(["limit missed", "ring", "vermillion"]);
    if (runs.some((run) => run.watch.position)) entries.push([`watch circle ${+runs.find((run) => run.watch.position).watch.position.toPrecision(3)} m`, "ring", "caution"]);
    if (largest) entries.push([`force ${kN} kN`, "bar", runs[0].colour, Math.min(pixels, 120)]);
    if (!vessel.to_scale) entries.push(["ship not to scale: her size is not in the table", "none", "soft"]);
    const said = JSON.stringify(entries);
    if (said === words) return;
    words = said;
    key.replaceChildren(...entries.map(([text, kind, shade, long]) => {
      const item = document.createElement("li"), sign = document.createElement("i");
      sign.className = kind; sign.style.color = `var(--${shade})`;
      if (long) sign.style.width = `${long.toFixed(1)}px`;
      item.append(sign, text);
      return item;
    }));
  }

  const button = document.getElementById("scene-view");
  const name = () => { button.textContent = view.follow ? "Whole track" : "Follow"; };
  scene.follow = (on) => { Object.assign(view, { follow: on, zoom: 1, east: 0, north: 0 }); name(); scene.refresh(); };
  button.addEventListener("click", () => scene.follow(!view.follow));
  const zoom = (factor) => { view.zoom = Math.min(Math.max(view.zoom * factor, 0.1), 200); scene.refresh(); };
  document.getElementById("scene-in").addEventListener("click", () => zoom(1.4));
  document.getElementById("scene-out").addEventListener("click", () => zoom(1 / 1.4));
  place.addEventListener("wheel", (event) => { if (event.ctrlKey || event.metaKey) { event.preventDefault(); zoom(Math.exp(-event.deltaY / 300)); } }, { passive: false });
  place.addEventListener("dblclick", () => scene.follow(view.follow));
  place.addEventListener("pointerdown", (event) => { place.setPointerCapture(event.pointerId); });
  place.addEventListener("pointermove", (event) => {
    if (!place.hasPointerCapture(event.pointerId)) return;
    view.east -= event.movementX / shown.scale; view.north += event.movementY / shown.scale;
    scene.refresh();
  });
  const widest = Math.max(box.east[1] - box.east[0], box.north[1] - box.north[0]);
  scene.follow(Math.max(...runs.flatMap((run) => run.vessels.map(size))) < 0.03 * widest);
})();
