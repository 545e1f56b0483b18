// What comes of each loss, by simulation of this very system in a worker, again and again.
(() => {
  const { live } = report, { about } = live, section = document.getElementById("losses"), body = section.querySelector("tbody"), said = document.getElementById("losses-said");
  const ahead = 120, run = report.data.scene[0], vessel = run.vessels[0], aim = vessel && (vessel.aims.reference || vessel.aims["set point"]);
  const name = (column) => run.recipes[column]?.signal, real = about.kinds.indexOf("Real");
  const columns = aim ? [...vessel.pose, ...aim].map((column) => about.columns[real].indexOf(name(column))) : [];

  // Losses: a unit that has a switch "failed", and a bus without power.
  const losses = Object.entries(about.signals).filter(([, signal]) => signal.free).flatMap(([signal, { kind }]) => {
    if (kind === "Boolean" && /\.failed$/.test(signal)) return [{ name: signal.slice(0, signal.lastIndexOf(".")), changes: [["override", signal, true]] }];
    if (kind === "Real" && /bus\w*_power$/.test(signal)) return [{ name: signal.slice(signal.lastIndexOf(".") + 1).replace(/_power$/, "").replaceAll("_", " "), changes: [["override", signal, 0]] }];
    return [];
  });
  if (!losses.length || columns.length < 6 || columns.some((column) => column < 0)) { section.hidden = true; return; }

  const limits = { distance: run.watch.position || 5, heading: run.watch.heading || 10 };
  const assumed = [run.watch.position ? "" : "5 m", run.watch.heading ? "" : "10°"].filter(Boolean).join(" and ");
  const address = URL.createObjectURL(new Blob([document.getElementById("worker").textContent], { type: "text/javascript" }));
  const worker = new Worker(address);
  worker.postMessage({ module: live.module, about });
  let busy = false, asked = -1;
  const shown = { answers: [], milliseconds: NaN, time: NaN };

  function ask() {
    if (busy || live.stopped || live.now() === asked || document.hidden) return;
    busy = true;
    asked = live.now();
    const steps = Math.round((ahead * about.step[1]) / about.step[0]);
    worker.postMessage({ state: live.engine.state(), losses, steps, time: live.time.last, watch: { x: real, columns, ...limits } });
  }

  worker.onmessage = ({ data }) => {
    busy = false;
    Object.assign(shown, data);
    said.textContent = `As of ${data.time.toFixed(1)} s, two minutes ahead, computed in ${data.milliseconds.toFixed(0)} ms. Limits: ${+limits.distance.toPrecision(3)} m and ${+limits.heading.toPrecision(3)}° off the ${vessel.aims.reference ? "reference" : "set point"}${assumed ? ` (${assumed} assumed)` : ""}.`;
    body.replaceChildren(...data.answers.map((one) => {
      const row = document.createElement("tr"), add = (text) => row.insertCell().append(text);
      row.className = one.crossed || one.error ? "leaves" : "holds";
      add(one.name);
      add(one.error ? `stops: ${one.error}` : one.crossed?.after === 0 ? `is beyond the limit of ${one.crossed.what} already` : one.crossed ? `leaves the limit of ${one.crossed.what} after ${one.crossed.after.toFixed(0)} s` : "holds");
      add(one.error ? "–" : `${one.distance.toFixed(1)} m`);
      add(one.error ? "–" : `${one.heading.toFixed(1)}°`);
      return row;
    }));
  };
  worker.onerror = (event) => { busy = false; said.textContent = `The forecast stopped: ${event.message}`; };
  setInterval(ask, 3000);
  ask();
  window.desk.losses = shown;
})();
