// The instruments of the scene: OpenBridge's compass and thrusters with their numbers as text, and the figures.
(() => {
  if (!scene) return;
  const { runs, compass, wrapped } = scene, two = runs.length > 1;
  const three = (degrees) => (Number.isFinite(degrees) ? `${compass(+degrees.toFixed(1)).toFixed(1).padStart(5, "0")}°` : "–");
  const whole = (degrees) => `${String(Math.round(compass(degrees)) % 360).padStart(3, "0")}°`;
  const signed = (v, digits = 2) => (Number.isFinite(v) ? (v < -0.5 * 10 ** -digits ? "−" : v > 0.5 * 10 ** -digits ? "+" : " ") + plain(Math.abs(v), digits) : "–");
  const plain = (v, digits = 2) => (Number.isFinite(v) ? (Math.abs(v) >= 1e6 ? v.toExponential(2) : v.toFixed(digits)).replace(/^-(0\.?0*)$/, "$1").replace("-", "−") : "–");

  // ---- an instrument: a component of OpenBridge, and a table of its numbers

  const made = (tag, properties = {}, ...parts) => { const found = Object.assign(document.createElement(tag), properties); found.append(...parts); return found; };
  const tenth = (value) => (Number.isFinite(value) ? Math.round(10 * value) / 10 : undefined);  // finer steps nobody sees, and each draws the component anew

  function instrument(place, run, title, caption = title) {
    const dial = made("div", { className: "dial" }), name = made("figcaption", { textContent: caption }), rows = made("table");
    if (two) name.style.color = `var(--${run.colour})`;
    const figure = made("figure", { className: "instrument" }, name, dial, rows);
    place.append(figure);
    return { figure, dial, rows, title };
  }
  const put = (one, tag, properties) => one.dial.replaceChildren((one.component = made(tag, { priority: "enhanced", role: "img", ...properties })));

  const has = (text) => Boolean(text) && text !== "–";
  function tell({ component, rows, title }, texts) {  // each of name, unit, value and set point
    tabulate(rows, texts.map(([what, unit, now, wanted]) => [unit ? `${what} [${unit}]` : what, now, ...(has(wanted) ? [`set ${wanted}`] : [])]));
    component.ariaLabel = `${title}: ${texts.map(([what, unit, now, wanted]) => `${what} ${now} ${unit}${has(wanted) ? `, set point ${wanted} ${unit}` : ""}`.trim()).join(", ")}`;
  }

  // ---- compass

  const BEAUFORT = [0.3, 1.6, 3.4, 5.5, 8, 10.8, 13.9, 17.2, 20.8, 24.5, 28.5, 32.7];  // m/s from which each force holds, as the WMO has them
  const CURRENT = 0.5, UNDER_WAY = 0.1;  // m/s: an arrow of the current, up to four; the least at which a ship has a course; both assumed
  const SECTOR = 30;  // deg that are marked beyond a limit of the heading alarm

  const compasses = runs.map((run) => instrument(document.getElementById("scene-compasses"), run, two ? `Compass, ${run.label}` : "Compass", two ? run.label : ""));
  // Letters inside, where no arrow lies over them, in place of a ship; no ring that turns by itself.
  for (const one of compasses) put(one, "obc-compass", { showLabels: true, tickmarksInside: true, vesselImage: "", rotType: undefined });

  const heading = ({ aims }) => (aims.reference || aims["set point"])?.heading;
  const course = ({ heading, u, v }) => (Math.hypot(u, v) > UNDER_WAY ? heading + (Math.atan2(v, u) * 180) / Math.PI : NaN);

  function steer({ component, figure }, run, state, flows) {
    figure.classList.toggle("gone", !state);
    if (!state) return;
    const aim = heading(state), [wind, current] = ["wind", "current"].map((what) => flows.find((flow) => flow.what === what && flow.size > 0) ?? {});
    const from = ({ degrees, sense }) => tenth(compass(degrees + (sense === "from" ? 0 : 180))) ?? null;
    Object.assign(component, {
      heading: tenth(compass(state.heading)), courseOverGround: tenth(compass(course(state))) ?? tenth(compass(state.heading)), headingSetpoint: tenth(compass(aim)) ?? null,
      windSpeed: BEAUFORT.filter((least) => wind.size >= least).length, windFromDirection: from(wind),
      currentSpeed: Math.min(Math.ceil(current.size / CURRENT), 4), currentFromDirection: from(current),
    });
    // The component compares these angles with the heading as they are: they must not lie a turn from it.
    const limit = run.watch.heading, about = tenth(compass(state.heading) + wrapped(aim - state.heading));
    if (!limit || component.about === about) return;
    component.about = about;
    component.headingAdvices = [limit, -limit - SECTOR].map((least) => ({ minAngle: about + least, maxAngle: about + least + SECTOR, type: "caution", hinted: true }));
  }

  // Its marks that need words: the sectors of the alarm, and the two kinds of arrows.
  const bearings = (state, { watch }, flows) => [
    ["Heading", "", three(state.heading), three(heading(state))], ["Course", "", three(course(state))],
    ...(watch.heading ? [["Hatched", "", `alarm, ${plain(watch.heading, 0)}° off`]] : []),
    ...(flows.some((flow) => flow.what !== "waves" && flow.size > 0) ? [["Arrows", "", "feathered wind, plain current"]] : []),
  ];
  const flowsOf = (one, states) => (one.flows.length ? one.flows : states.flatMap((other) => other.flows));

  // ---- thrusters

  const place = document.getElementById("scene-thrusters"), thrusters = new Map();
  place.ariaLabel = report.data.bars ?? "Thrusters";  // a diagnosis shows another force

  function mount() {
    place.replaceChildren(...(report.data.bars ? [made("h3", { textContent: report.data.bars })] : []));
    thrusters.clear();
    const units = runs.flatMap((run) => (scene.vesselOf(run)?.units ?? []).map((unit) => ({ run, unit }))), names = units.map(({ unit }) => unit.name);
    units.sort((a, b) => names.indexOf(a.unit.name) - names.indexOf(b.unit.name));  // those of two runs next to each other
    for (const { run, unit } of units) {
      const most = (unit.force ?? []).map((name) => run.columns[name].reduce((largest, v) => (Math.abs(v) > largest ? Math.abs(v) : largest), 0));
      thrusters.set(unit, { ...instrument(place, run, two ? `${run.label}: ${unit.name}` : unit.name), most });
    }
    place.hidden = !thrusters.size;
  }

  // What turns is an azimuth thruster, what pushes sideways a tunnel: by the force, where no signal says it. A run that goes on shows it late.
  function fit(one, { unit, force }) {
    one.most = one.most.map((largest, way) => (Math.abs(force[way]) > largest ? Math.abs(force[way]) : largest));
    const [forward = 0, starboard = 0] = one.most, kind = unit.azimuth || Math.min(forward, starboard) > 0.1 * Math.max(forward, starboard) ? "azimuth" : starboard > forward ? "tunnel" : "fixed";
    if (one.kind === kind) return;
    one.kind = kind;
    if (kind === "azimuth") put(one, "obc-azimuth-thruster", { angleAdvices: unit.sectors.map(([from, to]) => ({ minAngle: from, maxAngle: to, type: "caution", hinted: true })) });
    else put(one, "obc-thruster", { tunnel: kind === "tunnel" });
  }

  function push(one, now) {
    fit(one, now);
    const { unit, limits, thrust, command, azimuth, azimuthCommand, force, state } = now, turns = one.kind === "azimuth", byForce = turns && !unit.azimuth;
    const share = (kN) => tenth(Math.max(-100, Math.min(100, (100 * kN) / ((kN < 0 ? -limits[0] : limits[1]) || 1))));
    one.figure.className = `instrument ${one.kind} ${state}`;
    Object.assign(one.component, { state: state === "failed" ? "off" : "active", thrust: share(byForce ? Math.hypot(...force) : thrust) ?? 0, [turns ? "thrustSetpoint" : "setpoint"]: share(command) });
    if (turns) Object.assign(one.component, { angle: tenth(wrapped(byForce ? (Math.atan2(force[1], force[0]) * 180) / Math.PI : azimuth)) ?? 0, angleSetpoint: tenth(wrapped(azimuthCommand)) });
  }

  const angle = (degrees) => `${plain(wrapped(degrees), 0)}°`;  // from the bow, as in the diagram
  const force = (unit, kN) => plain(kN, unit.largest > 0 && unit.largest < 1 ? 3 : 1);  // of a boat in newtons
  const numbers = ({ unit, thrust, command, azimuth, azimuthCommand, rpm, state }) => [
    [report.data.bars ? "Force" : "Thrust", "kN", force(unit, thrust), unit.command && force(unit, command)],
    ...(unit.azimuth ? [["Azimuth", "", angle(azimuth), unit.azimuth_command && angle(azimuthCommand)]] : []),
    ...(unit.rpm ? [["Shaft", "rpm", plain(rpm, 0)]] : []),
    ...(state === "runs" ? [] : [[state === "failed" ? "failed" : "at its limit", "", ""]]),
  ];

  mount();
  addEventListener("scene-vessel", mount);

  // A component takes 1 ms to draw: while the run plays one of them a frame, in turn; else all.
  let turn = 0;
  scene.paints((states) => {
    const draws = states.flatMap((one, k) => {
      const state = scene.of(one);
      return [() => steer(compasses[k], one.run, state, flowsOf(one, states)), ...(state?.units ?? []).map((now) => () => push(thrusters.get(now.unit), now))];
    });
    turn += 1;
    for (const draw of scene.playing ? [draws[turn % draws.length]] : draws) draw();
    return [];
  });
  scene.writes((states) => states.forEach((one, k) => {
    const state = scene.of(one);
    tell(compasses[k], state ? bearings(state, one.run, flowsOf(one, states)) : [["not in the run at this time", "", ""]]);
    for (const now of state?.units ?? []) if (thrusters.get(now.unit).component) tell(thrusters.get(now.unit), numbers(now));
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
    line("Heading", three(state.heading), three(aim.heading), Number.isFinite(off?.heading) ? `${signed(off.heading, 1)}°` : "–");
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
