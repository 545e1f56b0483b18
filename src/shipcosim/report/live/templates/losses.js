// What comes of each loss, by simulation of this very system in a worker or by the server, again and again.
(() => {
  const { live } = report, { about } = live, { element, present, isBus, busOf } = window.desk, section = document.getElementById("losses"), body = section.querySelector("tbody"), said = document.getElementById("losses-said");
  const ahead = 120, run = report.data.scene[0], vessel = run.vessels[0], aim = vessel && (vessel.aims.reference || vessel.aims["set point"]);
  const name = (column) => run.recipes[column]?.signal, real = about.kinds.indexOf("Real");
  const columns = aim ? [...vessel.pose, ...aim].map((column) => about.columns[real].indexOf(name(column))) : [];

  // Losses: a unit that has a switch "failed", and a bus without power.
  const losses = Object.entries(about.signals).filter(([, signal]) => signal.free).flatMap(([signal, { kind }]) => {
    if (kind === "Boolean" && /\.failed$/.test(signal)) return [{ name: signal.slice(0, signal.lastIndexOf(".")), changes: [["override", signal, true]] }];
    if (isBus([signal, { kind }])) return [{ name: busOf(signal), changes: [["override", signal, 0]] }];
    return [];
  });
  if (!losses.length || columns.length < 6 || columns.some((column) => column < 0)) { section.hidden = true; return; }

  const limits = { distance: run.watch.position || 5, heading: run.watch.heading || 10 };
  const assumed = [run.watch.position ? "" : "5 m", run.watch.heading ? "" : "10°"].filter(Boolean).join(" and ");
  const begin = about.server ? askServer() : askWorker();
  let busy = false, asked = null, changes = 0;
  const shown = { answers: [], milliseconds: NaN, time: NaN };

  function ask() {
    const present = `${live.now()} ${changes}`;
    if (busy || live.stopped || present === asked || document.hidden || live.engine.steers === false || live.engine.noWayBack) return;
    busy = true;
    asked = present;
    begin(Math.round((ahead * about.step[1]) / about.step[0]));
  }

  // Each of these returns a function that asks for so many steps; the answer goes to `take`.
  function askWorker() {
    const address = URL.createObjectURL(new Blob([document.getElementById("worker").textContent], { type: "text/javascript" }));
    const worker = new Worker(address);
    worker.postMessage({ module: live.module, about });
    worker.onmessage = ({ data }) => take(data);
    worker.onerror = (event) => stop(event.message);
    return (steps) => worker.postMessage({ state: live.engine.state(), coming: live.coming(steps), losses, steps, time: live.time.last, watch: { x: real, columns, ...limits } });
  }

  function askServer() {
    const watched = columns.map((column) => about.columns[real][column]), spacing = live.engine.seconds(about.steps_per_row);
    const tellWhy = () => {
      section.querySelector("table").hidden = Boolean(live.engine.noWayBack);
      if (live.engine.noWayBack) said.textContent = `Not possible here: a forecast starts from a copy of the state. ${live.engine.noWayBack}`;
    };
    tellWhy();
    addEventListener("live-arrived", tellWhy);
    addEventListener("live-forecast", ({ detail: { error, step, milliseconds, answers } }) => {
      if (error === "") { busy = false; asked = null; return; }  // another run has begun
      if (error) { stop(error); return; }
      take({ time: live.engine.seconds(step - 1), milliseconds, answers: answers.map((one, k) => ({ name: losses[k].name, ...(one.error ? one : outcomeOf(one.rows, limits, spacing)) })) });
    });
    // What was done in a pause goes to the server with the next steps only, so each loss brings it.
    const pending = () => live.pending.filter(([, , , , byHand]) => byHand).map((change) => change.slice(1, 4));
    return (steps) => live.engine.forecast({ steps, watched, losses: losses.map(({ changes }) => [...pending(), ...changes]) });
  }

  // A unit that is lost already is no further loss.
  const isLost = ({ changes }) => changes.every(([, signal, value]) => present(signal) === Number(value));

  function outcome({ name, error, crossed }) {
    if (isLost(losses.find((one) => one.name === name))) return "is lost already";
    if (error) return `stops: ${error}`;
    if (!crossed) return "holds";
    return crossed.after === 0 ? `is beyond the limit of ${crossed.what} already` : `leaves the limit of ${crossed.what} after ${crossed.after.toFixed(0)} s`;
  }

  // ---- a future in the chart: where she goes after a loss, with her outline every half minute; a click plays it

  const OUTLINES = 30, FASTER = 20;  // s; times real time
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches, rows = new Map(), chart = document.getElementById("scene-chart");
  let chosen = null, began = 0;

  function rowOf(name) {  // rows stay, and with them the focus of the keyboard
    if (!rows.has(name)) {
      const row = body.insertRow(), button = element("button", { type: "button", textContent: "Show" });
      row.insertCell().append(name);
      const cells = [0, 1, 2].map(() => row.insertCell());
      row.insertCell().append(button);
      button.setAttribute("aria-label", `Show in the chart where she goes after the loss of ${name}`);
      button.addEventListener("click", () => {
        chosen = chosen === name ? null : name;
        for (const [other, found] of rows) found.button.setAttribute("aria-pressed", String(other === chosen));
        if (chosen) { scene.follow(false); chart.scrollIntoView({ block: "nearest" }); }
        began = performance.now();
        follow();
      });
      button.setAttribute("aria-pressed", "false");
      rows.set(name, { row, cells, button });
    }
    return rows.get(name);
  }

  function follow() {
    const answer = shown.answers.find((one) => one.name === chosen && one.track), track = answer?.track || [], places = [];
    for (let k = 0; k < track.length; k += 3) places.push({ north: track[k], east: track[k + 1], heading: (track[k + 2] * 180) / Math.PI });
    scene.future = places.length ? places : null;
    scene.refresh();
  }

  scene.paints(() => {
    if (!scene.future) return [];
    const c = chart.getContext("2d"), places = scene.future, spacing = live.engine.seconds(about.steps_per_row);
    const outline = ({ north, east, heading }) => scene.outline(c, scene.placed(vessel, north, east, heading));

    // How far it has been played; who wants no motion sees its end.
    const played = Math.floor(((performance.now() - began) / 1000) * (FASTER / spacing)), most = places.length - 1;
    const end = still ? most : Math.min(played, most), last = places[end];
    if (end < most) requestAnimationFrame(scene.refresh);

    // The whole track, the outlines up to there, and the ship.
    c.beginPath();
    for (const { north, east } of places) c.lineTo(...scene.pixel(east, north));
    scene.stroke(c, "alarm", 2, [6, 4]);
    const every = Math.round(OUTLINES / spacing) || 1;
    for (let k = every - 1; k < end; k += every) { outline(places[k]); scene.stroke(c, "alarm/0.5", 1.2); }
    outline(last);
    c.fillStyle = scene.colour("alarm/0.15"); c.fill();
    scene.stroke(c, "alarm", 1.6);

    // Which future it is, and its time.
    const [x, y] = scene.pixel(last.east, last.north);
    c.fillStyle = scene.colour("alarm"); c.textAlign = "left"; c.textBaseline = "middle";
    c.fillText(`${chosen} lost: in ${Math.round((end + 1) * spacing)} s`, x + 8, y);
    return [{ what: "future", of: chosen, places, at: end }];
  });

  function take(data) {
    busy = false;
    Object.assign(shown, data);
    said.textContent = `As of ${data.time.toFixed(1)} s, two minutes ahead, computed in ${data.milliseconds < 1000 ? `${data.milliseconds.toFixed(0)} ms` : `${(data.milliseconds / 1000).toFixed(1)} s`}. Limits: ${+limits.distance.toPrecision(3)} m and ${+limits.heading.toPrecision(3)}° off the ${vessel.aims.reference ? "reference" : "set point"}${assumed ? ` (${assumed} assumed)` : ""}.`;
    for (const one of data.answers) {
      const { row, cells } = rowOf(one.name), far = one.error ? ["–", "–"] : [`${one.distance.toFixed(1)} m`, `${one.heading.toFixed(1)}°`];
      row.className = one.crossed || one.error ? "leaves" : "holds";
      [outcome(one), ...far].forEach((text, k) => { cells[k].textContent = text; });
    }
    follow();
  }
  function stop(why) { busy = false; said.textContent = `The forecast stopped: ${why}`; }

  // What one does changes the forecast, also while the run pauses.
  for (const event of ["live-acted", "live-cut"]) addEventListener(event, () => { changes += 1; setTimeout(ask); });
  setInterval(ask, 3000);
  ask();
  window.desk.losses = shown;
})();
