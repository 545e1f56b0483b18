// A system that a local server steps: asks for steps, and gets their rows; what `makeEngine` is for a page that runs it.
function connectEngine(about, record) {
  const socket = new WebSocket(location.href.replace(/^http/, "ws").replace(/#.*/, "")), notice = document.getElementById("server");
  socket.binaryType = "arraybuffer";
  const LOOK = 50, AHEAD = 0.2;  // ms of steps that are asked for at once, s of the clock that rows may take to come: assumed
  const signals = about.starts.map(([, name]) => name), step = about.step[0] / about.step[1];
  let asked = 0, arrived = 0, waits = true, run = null, seen = performance.now(), pace = 20;  // steps of a ms
  const takeOver = Object.assign(document.createElement("button"), { type: "button", textContent: "Take over", title: "Steer this run in this page" });
  takeOver.addEventListener("click", () => socket.send(JSON.stringify({ do: "steer" })));
  const tell = (words) => { notice.hidden = !words; notice.textContent = words; };
  const ask = (what) => { if (engine.steers && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(what)); };

  // Who only reads can look at everything, and save it; once nobody steers, a click takes over.
  let isOpen = false;
  function permit() {
    if (!isOpen) return;
    for (const id of ["inputs", "failures", "starts"]) document.getElementById(id).inert = !engine.steers;
    for (const button of document.querySelectorAll("#scene button.plain")) if (!/^(Save|−60)/.test(button.textContent)) button.disabled = !engine.steers;
    document.getElementById("scene-play").disabled = !engine.steers;
    tell(engine.steers ? "" : "Another page steers this run; this one shows it. Once that one is closed, this one can take over.");
    scene.refresh();
  }
  addEventListener("live-opened", () => { isOpen = true; permit(); }, { once: true });

  function rowsOf(numbers) {  // for each exchange a view of its numbers, row by row
    let at = 2;
    return about.columns.map((names) => { const length = numbers[1] * names.length, table = numbers.subarray(at, at + length); at += length; return table; });
  }

  const engine = {
    steers: true, noWayBack: "",
    step: () => asked, seconds: (steps) => steps * about.step[0] / about.step[1],
    get waits() { return waits; },
    ready: () => !waits && asked - arrived < 2 * engine.stride(),
    stride: () => Math.max(Math.round(pace * LOOK), 1),
    ahead: () => AHEAD * scene.speed,
    advance(to, done) {
      if (waits || to <= asked || !engine.steers) return;
      if (asked === arrived) seen = performance.now();
      ask({ do: "advance", to, changes: done.filter(([at, , , , byHand]) => byHand && at >= asked && at < to).map((change) => change.slice(0, 4)) });
      asked = to;
    },
    start(starts) { waits = true; ask({ do: "start", values: Object.fromEntries(Object.entries(starts).map(([place, value]) => [signals[place], value])) }); },
    forecast(question) { ask({ do: "forecast", ...question }); },
    back(to) { waits = true; ask({ do: "back", to }); },
  };
  engine.opened = new Promise((resolve, reject) => {
    socket.onmessage = ({ data }) => {
      const told = typeof data === "string" ? JSON.parse(data) : {};
      if (told.run) {  // the whole run: its rows come next
        run = told.run;
        engine.noWayBack = run.noWayBack;
      } else if ("steers" in told) { engine.steers = told.steers; permit(); }
      else if (told.failed) {
        waits = false;
        asked = arrived = told.step;
        record.fail(told.failed);
      } else if (told.acted) { if (!engine.steers) record.acted(told.acted); }
      else if (told.left) { if (!engine.steers) { tell("The page that steered was closed: the run pauses. "); notice.append(takeOver); } }
      else if (told.forecast) dispatchEvent(new CustomEvent("live-forecast", { detail: told.forecast }));
      else if (told.taken) permit();  // by this page, or by another one
      else {
        const numbers = new Float64Array(data), now = performance.now();
        if (now > seen && numbers[0] > arrived && !run) pace += 0.3 * ((numbers[0] - arrived) / (now - seen) - pace);
        seen = now;
        arrived = numbers[0];
        asked = Math.max(asked, arrived);  // in a page that only reads
        if (run) {
          const starts = Object.fromEntries(Object.entries(run.starts).map(([name, value]) => [signals.indexOf(name), value]));
          asked = run.step;
          waits = false;
          record.adopt({ ...run, starts }, rowsOf(numbers));
          run = null;
          resolve();
        } else record.arrive(rowsOf(numbers));
      }
    };
    socket.onclose = () => { engine.gone = true; record.fail("the server has gone, or refuses this page"); reject(new Error("The server does not answer.")); };
  });
  return engine;
}
