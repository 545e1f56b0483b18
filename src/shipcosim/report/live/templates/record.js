// The record of a run that goes on: rows of all signals, the columns that the scene draws, and states to go back to.
report.live = await (async () => {
  const about = report.data.live, remote = about.server;  // the page runs the system, or a server does
  const module = remote ? null : await WebAssembly.compile(await report.unpacked("code").arrayBuffer());
  const engine = remote ? connectEngine(about, { adopt, arrive, fail, acted }) : makeEngine(module, about);

  // ---- columns that grow

  class Column {
    constructor() { this.all = new Float64Array(1024); this.length = 0; }
    push(value) {
      if (this.length === this.all.length) { const wider = new Float64Array(2 * this.length); wider.set(this.all); this.all = wider; }
      this.all[this.length++] = value;
    }
    get last() { return this.length ? this.all[this.length - 1] : NaN; }
    get values() { return this.all.subarray(0, this.length); }
    cut(length) { this.length = Math.min(this.length, length); }
  }

  const places = new Map(about.columns.flatMap((names, x) => names.map((name, column) => [name, [x, column]])));
  const raw = new Map([...places.keys()].map((name) => [name, new Column()])), time = new Column();
  const run = report.data.scene[0], recipes = Object.entries(run.recipes), made = new Map(recipes.map(([name]) => [name, new Column()]));
  const tracks = run.predicted.map((one) => ({ name: one.name, horizons: one.horizons, source: one, parts: new Map(), made: new Column() }));
  const PARTS = ["north", "east", "heading", "radius"];
  for (const track of tracks) for (const part of PARTS) track.parts.set(part, track.horizons.map(() => new Column()));

  const shown = { ...run, columns: {}, colour: "blue", predicted: [], time: null };
  function show() {  // the scene sees the columns as they are now
    shown.time = time.values;
    for (const [name, column] of made) shown.columns[name] = column.values;
    shown.predicted = tracks.map((track) => Object.assign({ name: track.name, horizons: track.horizons, made: track.made.values }, ...PARTS.map((part) => ({ [part]: track.parts.get(part).map((column) => column.values) }))));
  }

  function take(tables, step) {  // rows of the engine, the first of them at a step
    const count = tables[0].length / about.columns[0].length;
    for (let row = 0; row < count; row++) {
      time.push(engine.seconds(step + row * about.steps_per_row));
      about.columns.forEach((names, x) => { const table = tables[x], at = row * names.length; for (let k = 0; k < names.length; k++) raw.get(names[k]).push(table[at + k]); });
      for (const [name, recipe] of recipes) made.get(name).push(derived(recipe, made.get(name).last));
      for (const track of tracks) predict(track);
    }
  }

  function derived({ signal, factor, offset, angle, trigonometric, turns }, before) {
    const value = factor * raw.get(signal).last + offset;
    if (angle) return value * Math[trigonometric](raw.get(angle).last);
    return turns && Number.isFinite(before) ? value + 360 * Math.round((before - value) / 360) : value;
  }

  function predict(track) {  // a new prediction has another time
    const at = made.get(track.source.made).last;
    if (track.made.length && at === track.made.last) return;
    track.made.push(at);
    for (const part of PARTS) track.parts.get(part).forEach((column, k) => column.push(track.source[part][k] === null ? 0 : made.get(track.source[part][k]).last));
  }

  // ---- what was done, and states to go back to

  // s between states, and ms of the clock, in which a fast run comes there again; s of them that are all kept, and their number: 3 MB each.
  const EVERY = 5, SOON = 50, RECENT = 60, MOST = 80;
  const early = [];  // what was done before a server had gone back or begun again
  let done = about.events.slice(), states = [], starts = {}, failure = "";

  function remember() {
    const now = engine.seconds(engine.step()), clock = performance.now(), before = states.at(-1);
    if (before && (now - before.time < EVERY - 1e-9 || clock - before.clock < SOON)) return;
    states.push({ time: now, clock, rows: time.length, bytes: engine.state() });
    if (states.length > MOST) states = states.filter(({ time }, k) => now - time <= RECENT || k % 2 === 0);  // the older ones farther apart
  }

  function rowsDue(to) {  // steps until the row at or after a time exists
    const row = Math.ceil((to * about.step[1]) / about.step[0] / about.steps_per_row - 1e-9);
    return row * about.steps_per_row;
  }

  function advance(to) {
    if (remote) { engine.advance(to, done); return; }  // rows arrive later
    const spacing = Math.max(Math.round((EVERY * about.step[1]) / about.step[0]), 1);
    try {
      while (engine.step() < to) {
        if (engine.step() >= about.last_step) throw new Error(`it has reached ${engine.seconds(about.last_step)} s, the longest run of a page`);  // its rows fill the memory
        const from = engine.step(), next = Math.min(to, about.last_step, from + spacing, from + about.most_steps);
        let first = Math.ceil(from / about.steps_per_row) * about.steps_per_row;
        engine.advance(next, done, (tables) => { take(tables, first); first = Math.ceil(engine.step() / about.steps_per_row) * about.steps_per_row; });
        remember();
      }
    } catch (error) { fail(error.message); }
  }

  function fail(why) {
    failure = why;
    dispatchEvent(new CustomEvent("live-failed", { detail: why }));
  }

  // ---- what a server sends

  function adopt(run, tables) {  // another run than before, from its start on
    self.cut(0, -1);
    ({ starts } = run);
    done = [...about.events, ...run.done.map((change) => [...change, true])];
    failure = "";
    arrive(tables);
    if (run.failure) fail(run.failure);
    for (const change of early.splice(0)) self.act(...change);
  }

  function arrive(tables) {
    const before = self.end;
    take(tables, time.length * about.steps_per_row);
    show();
    dispatchEvent(new CustomEvent("live-arrived", { detail: before }));
  }

  function acted(changes) {  // in the page that steers
    done = [...done, ...changes.map((change) => [...change, true])];
    dispatchEvent(new Event("live-arrived"));
  }

  // The last change of each signal up to the next step, found anew once something was done or a step was made.
  let latest = {};
  function latestOf(name) {
    const step = engine.step();
    if (latest.done !== done || latest.step !== step) {
      latest = { done, step, changes: new Map() };
      for (const change of done) if (change[0] <= step && !(latest.changes.get(change[2])?.[0] > change[0])) latest.changes.set(change[2], change);
    }
    return latest.changes.get(name);
  }

  const lastTime = () => (time.length ? time.last : 0);

  const self = {
    about, module, engine, runs: [shown], raw, time, failure: () => failure,
    get stopped() { return failure !== ""; },
    reach(to) {
      if (failure) return lastTime();
      if (to === Infinity) { const until = performance.now() + 12; while (!failure && engine.ready(until)) advance(engine.step() + engine.stride()); }
      else advance(rowsDue(to + engine.ahead()) + 1);
      show();
      return lastTime();
    },
    reset(values = {}) {
      starts = { ...starts, ...values };
      engine.start(starts);
      if (remote) return;
      self.cut(0, -1);
      done = about.events.slice();
      states = [];
      failure = "";
      remember();
      advance(1);
      show();
    },
    cut(rows, after) {  // forget what came later
      time.cut(rows);
      for (const column of [...raw.values(), ...made.values()]) column.cut(rows);
      for (const track of tracks) {
        let kept = track.made.length;
        while (kept && track.made.all[kept - 1] > after) kept -= 1;
        track.made.cut(kept);
        for (const columns of track.parts.values()) for (const column of columns) column.cut(kept);
      }
      dispatchEvent(new Event("live-cut"));
    },
    back(to) {
      const until = Math.floor((to * about.step[1]) / about.step[0] + 1e-9) + 1;  // its row is there
      if (remote) { engine.back(until); return; }
      const state = [...states].reverse().find((one) => one.time <= to + 1e-9) || states[0];
      engine.restore(state.bytes);
      self.cut(state.rows, state.time);
      done = done.filter(([step, , , , byHand]) => !byHand || step < until);
      states = states.filter((one) => one.time <= state.time);
      failure = "";
      advance(until);
      show();
    },
    act(action, name, value) {  // from the next step on
      if (remote && !engine.steers) return;
      if (remote && engine.waits) { early.push([action, name, value]); return; }
      // Of several changes of a signal before the next step the last one holds.
      const now = engine.step();
      done = done.filter(([step, , of, , byHand]) => !(byHand && step === now && of === name));
      done.push([now, action, name, value, true]);
      dispatchEvent(new Event("live-acted"));
    },
    get end() { return lastTime(); },
    now: () => engine.step(),
    value: (name) => raw.get(name)?.last,
    held(name) {  // what the last change of a signal says, or null
      const last = latestOf(name);
      return last && last[1] !== "reset" ? last : null;
    },
    coming: (steps) => done.filter(([step]) => step >= engine.step() && step < engine.step() + steps),
    get pending() { return self.coming(1); },  // what the next step begins with
    before: (end) => done.filter(([step, , , , byHand]) => byHand || step < end),
    get done() { return self.before(engine.step()); },
    get starts() { return starts; },
    states: () => states.length,
  };
  if (remote) await engine.opened; else self.reset();
  return self;
})();
