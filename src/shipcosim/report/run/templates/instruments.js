// The instruments of the scene: OpenBridge's compass and thrusters with their numbers as text, and the figures.
(() => {
  if (!scene) return;
  const { runs, compass, wrapped } = scene, two = runs.length > 1;
  const three = (degrees) => `${compass(+degrees.toFixed(1)).toFixed(1).padStart(5, "0")}°`;
  const whole = (degrees) => `${String(Math.round(compass(degrees)) % 360).padStart(3, "0")}°`;
  const signed = (v, digits = 2) => (Number.isFinite(v) ? (v < -0.5 * 10 ** -digits ? "−" : v > 0.5 * 10 ** -digits ? "+" : " ") + plain(Math.abs(v), digits) : "–");
  const plain = (v, digits = 2) => (Number.isFinite(v) ? (Math.abs(v) >= 1e6 ? v.toExponential(2) : v.toFixed(digits)).replace(/^-(0\.?0*)$/, "$1").replace("-", "−") : "–");
  const chosen = (states) => states.map((one) => ({ run: one.run, state: scene.of(one) }));

  // ---- components

  const made = (tag, properties = {}, ...parts) => { const found = Object.assign(document.createElement(tag), properties); found.append(...parts); return found; };
  const tenth = (value) => Math.round(10 * value) / 10;  // finer steps nobody sees, and each one draws the component anew
  const known = (value, otherwise) => (Number.isFinite(value) ? tenth(value) : otherwise);
  const write = (place, text) => { if (place.textContent !== text) place.textContent = text; };

  // A component with a title and a table of its numbers: what it shows, now, and the set point where there is one.
  function instrument(place, tag, title, run, properties = {}, caption = title) {
    const component = made(tag, { priority: "enhanced", role: "img", ...properties }), rows = made("table"), name = made("figcaption", { textContent: caption });
    if (two) name.style.color = `var(--${run.colour})`;
    const figure = made("figure", { className: "instrument" }, made("div", { className: "dial" }, component), made("div", {}, name, rows));
    place.append(figure);
    return {
      component, figure, rows,
      tell(texts) {  // rows of name, unit, value and set point
        tabulate(rows, texts.map(([what, unit, now, wanted]) => [unit ? `${what} [${unit}]` : what, now, ...(wanted ? [`set ${wanted}`] : [])]));
        component.ariaLabel = `${title}: ${texts.map(([what, unit, now, wanted]) => `${what} ${now}${unit && ` ${unit}`}${wanted ? `, set point ${wanted}${unit && ` ${unit}`}` : ""}`.trim()).join(", ")}`;
      },
    };
  }

  // ---- compass

  const BEAUFORT = [0.3, 1.6, 3.4, 5.5, 8, 10.8, 13.9, 17.2, 20.8, 24.5, 28.5, 32.7];  // m/s from which each force holds, as the WMO has them
  const CURRENT = 0.5;  // m/s an arrow, up to four; assumed, OpenBridge says none
  const UNDER_WAY = 0.1;  // m/s, from which a ship has a course; assumed
  const SECTOR = 30;  // deg of caution drawn beyond a limit of the heading alarm

  // Letters inside, where no arrow lies over them, in place of a ship; nothing turns that is no measured value.
  const DIAL = { showLabels: true, tickmarksInside: true, vesselImage: "", rotType: undefined };
  const compasses = runs.map((run) => instrument(document.getElementById("scene-compasses"), "obc-compass", two ? `Compass, ${run.label}` : "Compass", run, DIAL, two ? run.label : ""));

  function steer({ component, figure }, run, state, flows) {
    figure.classList.toggle("gone", !state);
    if (!state) return;
    const aim = heading(state), course = courseOf(state);
    const from = (what) => { const flow = flows.find((one) => one.what === what); return flow && flow.size > 0 && Number.isFinite(flow.degrees) ? { size: flow.size, degrees: tenth(compass(flow.degrees + (flow.sense === "from" ? 0 : 180))) } : null; };
    const wind = from("wind"), current = from("current");
    Object.assign(component, {
      heading: tenth(compass(state.heading)), courseOverGround: tenth(compass(course ?? state.heading)), headingSetpoint: Number.isFinite(aim) ? tenth(compass(aim)) : null,
      windSpeed: wind && BEAUFORT.filter((least) => wind.size >= least).length, windFromDirection: wind && wind.degrees,
      currentSpeed: current && Math.min(Math.ceil(current.size / CURRENT), 4), currentFromDirection: current && current.degrees,
    });
    // Beyond the limits of the heading alarm; angles near the heading, as the component compares them with it.
    const limit = run.watch.heading, about = tenth(compass(state.heading) + wrapped(aim - state.heading));
    if (!limit || !Number.isFinite(about) || component.about === about) return;
    component.about = about;
    component.headingAdvices = [[limit, limit + SECTOR], [-limit - SECTOR, -limit]].map(([least, most]) => ({ minAngle: about + least, maxAngle: about + most, type: "caution", hinted: true }));
  }
  const courseOf = ({ heading, u, v }) => (Math.hypot(u, v) > UNDER_WAY ? heading + (Math.atan2(v, u) * 180) / Math.PI : null);
  const heading = ({ aims }) => (aims.reference || aims["set point"])?.heading;

  function bearings(state) {
    const aim = heading(state), course = courseOf(state);
    return [["Heading", "", three(state.heading), Number.isFinite(aim) ? three(aim) : ""], ...(Number.isFinite(state.u + state.v) ? [["Course", "", course === null ? "–" : three(course)]] : [])];
  }

  // ---- thrusters

  const place = document.getElementById("scene-thrusters"), thrusters = new Map();  // by run, then by name of the unit
  place.ariaLabel = report.data.bars ?? "Thrusters";

  // What turns is an azimuth thruster, what pushes sideways a tunnel; by the force of the run where no signal says it.
  function kindOf({ run, unit, force }) {
    if (unit.azimuth) return "azimuth";
    const [forward, starboard] = force;
    if (Math.min(forward, starboard) > 0.1 * Math.max(forward, starboard)) return "azimuth";
    return starboard > forward ? "tunnel" : "fixed";
  }
  const COMPONENTS = { azimuth: ["obc-azimuth-thruster", {}], tunnel: ["obc-thruster", { tunnel: true }], fixed: ["obc-thruster", {}] };

  function mount() {
    place.replaceChildren();
    thrusters.clear();
    for (const run of runs) for (const unit of scene.vesselOf(run)?.units ?? []) {
      const force = (unit.force ?? []).map((name) => run.columns[name].reduce((most, v) => (Math.abs(v) > most ? Math.abs(v) : most), 0));
      thrusters.set(unit, fit({ run, unit, force: unit.force ? force : [0, 0] }));
    }
    place.hidden = !thrusters.size;
  }

  function fit(thruster) {  // with the component of its kind
    const { run, unit } = thruster, kind = kindOf(thruster), [tag, properties] = COMPONENTS[kind], before = thruster.figure;
    const advices = unit.sectors.map(([from, to]) => ({ minAngle: from, maxAngle: to, type: "caution", hinted: true }));
    Object.assign(thruster, { kind }, instrument(place, tag, two ? `${run.label}: ${unit.name}` : unit.name, run, { ...properties, ...(kind === "azimuth" ? { angleAdvices: advices } : {}) }));
    thruster.figure.classList.add(kind);
    before?.replaceWith(thruster.figure);
    return thruster;
  }

  function refitted(thruster, force) {  // a run that goes on shows late which way a unit pushes
    force?.forEach((v, way) => { if (Math.abs(v) > thruster.force[way]) thruster.force[way] = Math.abs(v); });
    return kindOf(thruster) === thruster.kind ? thruster : fit(thruster);
  }

  function push(thruster, now) {
    const { unit, component, figure } = thruster, { limits, thrust, command, azimuth, azimuthCommand, force, state } = now;
    figure.className = `instrument ${thruster.kind} ${state}`;
    const turned = thruster.kind === "azimuth" && !unit.azimuth;  // shows the force itself
    const share = (kN) => Math.max(-100, Math.min(100, (100 * kN) / ((kN < 0 ? -limits[0] : limits[1]) || 1)));
    Object.assign(component, { state: state === "failed" ? "off" : "active", thrust: known(share(turned ? Math.hypot(...force) : thrust), 0) });
    const angle = turned ? (Math.atan2(force[1], force[0]) * 180) / Math.PI : azimuth;
    if (thruster.kind === "azimuth") Object.assign(component, { angle: known(wrapped(angle), 0), angleSetpoint: known(wrapped(azimuthCommand)), thrustSetpoint: known(share(command)) });
    else component.setpoint = known(share(command));
  }

  function say(thruster, { thrust, command, azimuth, azimuthCommand, rpm, state, unit }) {
    const rows = [["Thrust", "kN", plain(thrust, 1), unit.command && plain(command, 1)]];
    if (unit.azimuth) rows.push(["Azimuth", "", `${plain(wrapped(azimuth), 0)}°`, unit.azimuth_command && `${plain(wrapped(azimuthCommand), 0)}°`]);
    if (unit.rpm) rows.push(["Shaft", "rpm", plain(rpm, 0)]);
    if (state !== "runs") rows.push([state === "failed" ? "failed" : "at its limit", "", ""]);
    thruster.tell(rows);
  }

  mount();
  addEventListener("scene-vessel", mount);

  // A component takes 1 ms to draw: while the run plays one of them a frame, in turn, else all.
  let turn = 0;
  scene.paints((states) => {
    const flows = states.find((one) => one.flows.length)?.flows ?? [], draws = [];
    chosen(states).forEach(({ run, state }, k) => {
      draws.push(() => steer(compasses[k], run, state, states[k].flows.length ? states[k].flows : flows));
      for (const now of state?.units ?? []) if (thrusters.has(now.unit)) draws.push(() => push(refitted(thrusters.get(now.unit), now.force), now));
    });
    turn += 1;
    for (const draw of scene.playing ? [draws[turn % draws.length]] : draws) draw();
    return [];
  });
  scene.writes((states) => chosen(states).forEach(({ state }, k) => {
    compasses[k].tell(state ? bearings(state) : [["not in the run at this time", "", ""]]);
    for (const now of state?.units ?? []) if (thrusters.has(now.unit)) say(thrusters.get(now.unit), now);
  }));

  // ---- figures

  const FLOWS = ["wind", "current", "waves"], table = document.getElementById("scene-figures");
  scene.writes((states) => {
    const rows = two ? compared(states) : single(scene.of(states[0]));
    for (const what of FLOWS) {
      const found = states.map(({ flows }) => flows.find((flow) => flow.what === what));
      if (!found.some(Boolean)) continue;
      const said = found.map((flow) => (flow ? `${plain(flow.size, 1)} ${flow.unit} ${flow.sense} ${whole(flow.degrees)}` : "–"));
      const same = said.every((text) => text === said[0]);
      rows.push([what[0].toUpperCase() + what.slice(1), same ? said[0] : said.map((text, k) => `${runs[k].label} ${text}`).join(", ")]);
    }
    tabulate(table, rows, 4);
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

  function tabulate(table, rows, columns = 3) {  // cells that stay are not made again; the last one spans the rest
    while (table.rows.length > rows.length) table.deleteRow(-1);
    rows.forEach((texts, k) => {
      const row = table.rows[k] || table.insertRow();
      while (row.cells.length > texts.length) row.deleteCell(-1);
      texts.forEach((text, i) => {
        const cell = row.cells[i] || row.insertCell(), span = i === texts.length - 1 ? columns - i : 1;
        if (cell.textContent !== text) cell.textContent = text;
        if (cell.colSpan !== span) cell.colSpan = span;
      });
    });
  }
})();
