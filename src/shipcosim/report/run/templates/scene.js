// The scene of a run: time that plays, and the state of every vessel at it. Chart, instruments and plots follow it.
const scene = (() => {
  const section = document.getElementById("scene");
  if (!section) return null;
  const { data, live } = report;  // live: a run that goes on

  // ---- the table

  const COLOURS = ["blue", "purple"];
  const runs = live ? live.runs : data.scene.map((run, k) => {
    const time = report.series(run.time), columns = {};
    for (const [name, packed] of Object.entries(run.columns)) columns[name] = report.series(packed, time.length);
    const predicted = run.predicted.map((one) => {
      const made = report.series(one.made), read = (what) => one[what].map((packed) => report.series(packed, made.length));
      return { ...one, made, north: read("north"), east: read("east"), heading: read("heading"), radius: read("radius") };
    });
    return { ...run, time, columns, predicted, colour: run.colour || COLOURS[k] };
  });
  const start = Math.min(...runs.map((run) => run.time[0]));
  let end = Math.max(...runs.map((run) => run.time[run.time.length - 1]));

  // Last row at or before a time, and how far the time is on the way to the next; null outside of the run.
  function place(run, t) {
    const { time } = run, last = time.length - 1;
    if (!(t >= time[0] - 1e-6 && t <= time[last] + 1e-6)) return null;
    let low = 0, high = last;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (time[middle] <= t + 1e-9) low = middle; else high = middle - 1;
    }
    const span = low < last ? time[low + 1] - time[low] : 1;
    return { row: low, share: low < last ? Math.max(0, (t - time[low]) / span) : 0 };
  }

  // Values between two rows lie on the straight line; what is switched or commanded stays until the next row.
  function value(run, name, where) {
    if (name === null || name === undefined || where === null) return NaN;
    const values = run.columns[name], a = values[where.row];
    return where.share > 0 ? a + where.share * (values[where.row + 1] - a) : a;
  }
  const held = (run, name, where) => (name === null || name === undefined || where === null ? NaN : run.columns[name][where.row]);

  // ---- what stands where at a time

  const wrapped = (degrees) => ((((degrees + 180) % 360) + 360) % 360) - 180;
  const compass = (degrees) => ((degrees % 360) + 360) % 360;

  function placed({ outline }, north, east, heading) {
    const c = Math.cos((heading * Math.PI) / 180), s = Math.sin((heading * Math.PI) / 180), [forward, starboard] = outline;
    return { east: forward.map((f, k) => east + s * f + c * starboard[k]), north: forward.map((f, k) => north + c * f - s * starboard[k]) };
  }

  function vesselAt(run, vessel, where) {
    const [north, east, heading] = vessel.pose.map((name) => value(run, name, where));
    if (!Number.isFinite(north + east + heading)) return null;
    const aims = {};
    for (const [word, names] of Object.entries(vessel.aims)) {
      const read = word === "reference" ? value : held, [n, e, h] = names.map((name) => read(run, name, where));
      if (Number.isFinite(n + e)) aims[word] = { north: n, east: e, heading: h };
    }
    const [u, v, r] = vessel.velocity.map((name) => value(run, name, where));
    const units = vessel.units.map((unit) => unitAt(run, unit, where));
    return { vessel, north, east, heading, aims, u, v, r, units, off: error(north, east, heading, aims), hull: placed(vessel, north, east, heading) };
  }

  // How far she is off where she should be: off the reference, else off the set point.
  function error(north, east, heading, aims) {
    const aim = aims.reference || aims["set point"];
    if (!aim) return null;
    const n = north - aim.north, e = east - aim.east, c = Math.cos((heading * Math.PI) / 180), s = Math.sin((heading * Math.PI) / 180);
    return { north: n, east: e, distance: Math.hypot(n, e), ahead: c * n + s * e, starboard: c * e - s * n, heading: wrapped(heading - aim.heading) };
  }

  function unitAt(run, unit, where) {
    const read = (name) => value(run, name, where), on = (name) => held(run, name, where) > 0.5;
    const limits = unit.limits || [-unit.largest, unit.largest];
    return {
      unit, limits, thrust: read(unit.thrust), command: read(unit.command), azimuth: read(unit.azimuth), azimuthCommand: read(unit.azimuth_command), rpm: read(unit.rpm),
      force: unit.force ? unit.force.map(read) : null,
      state: on(unit.failed) || (unit.available && held(run, unit.available, where) < 0.5) ? "failed" : on(unit.saturated) ? "limit" : "runs",
    };
  }

  // The prediction that held at a time, place by place: where she was to be, and where she came to be.
  function predictedAt(run, one, t) {
    let last = -1;
    for (let low = 0, high = one.made.length - 1; low <= high;) {
      const middle = (low + high) >> 1;
      if (one.made[middle] <= t + 1e-6) { last = middle; low = middle + 1; } else high = middle - 1;
    }
    if (last < 0) return null;
    return one.horizons.map((seconds, k) => {
      const then = place(run, one.made[last] + seconds), [north, east] = run.vessels[0].pose.map((name) => value(run, name, then));
      return { seconds, north: one.north[k][last], east: one.east[k][last], heading: one.heading[k][last], radius: one.radius[k][last], true: Number.isFinite(north + east) ? [north, east] : null };
    });
  }

  function flowAt(run, flow, where) {
    if (flow.height) return { ...flow, size: value(run, flow.height, where), degrees: compass(value(run, flow.direction, where)), unit: "m" };
    const [north, east] = flow.velocity.map((name) => value(run, name, where));
    const to = (Math.atan2(east, north) * 180) / Math.PI;
    return { ...flow, size: Math.hypot(north, east), degrees: compass(flow.sense === "from" ? to + 180 : to), unit: "m/s" };
  }

  function at(t) {
    return runs.map((run) => {
      const where = place(run, t);
      return { run, where, vessels: run.vessels.map((vessel) => where && vesselAt(run, vessel, where)).filter(Boolean), flows: where ? run.flows.map((flow) => flowAt(run, flow, where)) : [], predicted: where ? run.predicted.map((one) => predictedAt(run, one, t)).filter(Boolean) : [] };
    });
  }

  // ---- time

  const shades = new Map();  // what the style sheet says of a colour, asked once
  const colour = (name) => shades.get(name) ?? shades.set(name, report.colour(name)).get(name);

  const self = { runs, start, get end() { return end; }, time: end, speed: live ? 1 : 16, playing: false, frames: 0, chosen: 0, ghost: null, at, placed, compass, wrapped, colour, drawn: [] };
  const painters = [], writers = [];
  let read = 0;
  self.paints = (painter) => painters.push(painter);  // on canvases, every frame
  self.writes = (writer) => writers.push(writer);  // texts

  self.paint = () => {
    const states = at(self.time);
    self.drawn = painters.flatMap((painter) => painter(states, self.time) || []);
    const now = performance.now();
    if (!self.playing || now - read > 100) {  // figures that change faster nobody reads
      read = now;
      for (const writer of writers) writer(states, self.time);
    }
    self.frames += 1;
    dispatchEvent(new CustomEvent("scene-time", { detail: self.time }));
  };

  let waiting = false;
  self.refresh = () => {
    if (waiting || self.playing) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; self.paint(); });
  };

  self.go = (t) => {
    self.time = Math.min(Math.max(t, start), end);
    self.refresh();
    if (!self.playing) keep();
  };

  let keeping = 0;
  function keep() {  // browsers allow few changes of the address a second
    clearTimeout(keeping);
    keeping = setTimeout(() => { try { history.replaceState(null, "", `#t=${+self.time.toFixed(2)}`); } catch {} }, 300);
  }

  let last = 0;
  function step(now) {
    if (!self.playing) return;
    const due = self.time + (Math.min(Math.max(now - last, 1), 250) / 1000) * self.speed;
    if (live) self.grown(live.reach(due));
    self.time = Math.min(due, end);
    last = now;
    self.paint();
    if (live ? live.stopped : self.time >= end) self.pause(); else requestAnimationFrame(step);
  }

  self.play = () => {
    if (self.playing) return;
    if (self.time >= end && !live) self.time = start;
    self.playing = true;
    last = performance.now();
    requestAnimationFrame(step);
    label();
  };
  self.grown = (last) => { end = last; slider.max = end; };  // the record has another end
  self.pause = () => { self.playing = false; label(); self.refresh(); keep(); };
  self.toggle = () => (self.playing ? self.pause() : self.play());

  // ---- the player

  const by = (name) => document.getElementById(`scene-${name}`);
  const slider = by("time"), clock = by("clock"), play = by("play"), speed = by("speed");
  Object.assign(slider, { min: start, max: end, value: end });
  const label = () => { play.textContent = self.playing ? "Pause" : live ? "Run" : "Play"; };

  function stamp(t) {
    const whole = Math.floor(t - start), two = (n) => String(n).padStart(2, "0"), hours = Math.floor(whole / 3600);
    return `${hours ? `${hours}:` : ""}${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
  }
  self.writes((states, t) => {
    slider.value = t;
    document.getElementById("cursor").textContent = `t = ${+t.toFixed(1)} s`;
    clock.textContent = `${t.toFixed(1)} s · ${stamp(t)} of ${stamp(end)}`;
  });

  slider.addEventListener("input", () => self.go(+slider.value));
  play.addEventListener("click", self.toggle);
  speed.addEventListener("change", () => { self.speed = +speed.value; });
  self.setSpeed = (factor) => { if ([...speed.options].some((o) => +o.value === factor)) { speed.value = factor; self.speed = factor; } };

  const faster = (by) => { speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + by, 0), speed.options.length - 1); self.speed = +speed.value; };

  // Lines at the times at which something happens; a joystick makes more of them than there are places.
  self.mark = (times) => by("marks").replaceChildren(...[...new Set(times.map((t) => ((100 * (t - start)) / (end - start || 1)).toFixed(1)))].map((share) => {
    const line = document.createElementNS("http://www.w3.org/2000/svg", "line"), x = `${share}%`;
    for (const [key, v] of Object.entries({ x1: x, x2: x, y1: 0, y2: "100%" })) line.setAttribute(key, v);
    return line;
  }));
  self.mark(data.events);

  const KEYS = {
    " ": () => self.toggle(), Home: () => self.go(start), End: () => self.go(end), "+": () => faster(1), "-": () => faster(-1),
    ArrowRight: (far) => self.go(self.time + far * Math.min(self.speed, 64)), ArrowLeft: (far) => self.go(self.time - far * Math.min(self.speed, 64)),
  };
  addEventListener("keydown", (event) => {
    const box = section.getBoundingClientRect();
    // Fields, lists and what a blank presses keep their keys; a list of speeds leaves ← and → to the time.
    const through = event.target === speed && /^Arrow(Left|Right)$/.test(event.key);
    const writes = !through && event.target.closest("input:not([type=range]), textarea, select");
    const pressed = event.key === " " && event.target.closest("button, summary, a");
    if (writes || pressed || !KEYS[event.key] || event.ctrlKey || event.metaKey || event.altKey || box.bottom < 0 || box.top > innerHeight) return;
    event.preventDefault();
    KEYS[event.key](event.shiftKey ? 10 : 1);
  });

  function fromAddress() {
    const found = location.hash.match(/^#t=(-?[\d.]+)$/);
    if (found && Number.isFinite(+found[1])) self.go(+found[1]);
  }
  addEventListener("hashchange", fromAddress);
  addEventListener("scene-go", (event) => self.go(event.detail));
  addEventListener("scene-ghost", (event) => { self.ghost = event.detail; self.refresh(); });

  const choice = by("vessel"), vessels = [...new Set(runs.flatMap((run) => (run.vessels.length > 1 ? run.vessels.map((vessel) => vessel.name) : [])))];
  for (const [k, name] of vessels.entries()) choice.append(new Option(name, k));
  choice.hidden = vessels.length < 2;
  choice.addEventListener("change", () => { self.chosen = +choice.value; for (const { measure } of canvases.values()) measure(); dispatchEvent(new Event("scene-vessel")); self.refresh(); });
  self.vessels = vessels;
  self.vesselOf = (run) => (run.vessels.length > 1 ? run.vessels.find((vessel) => vessel.name === vessels[self.chosen]) : run.vessels[0]);
  self.of = (state) => state.vessels.find(({ vessel }) => vessel === self.vesselOf(state.run)) || null;

  // ---- canvases

  const canvases = new Map();  // sizes are looked up when they change: to ask while playing costs a layout of the page

  self.canvas = (name, height) => {
    const place = by(name), context = place.getContext("2d"), found = { context, width: 0, height: 0, shown: true, version: 0 };
    const measure = () => {
      const ratio = window.devicePixelRatio || 1, width = place.clientWidth;
      if (height) place.style.height = `${height(width)}px`;
      Object.assign(found, { width, height: place.clientHeight, version: found.version + 1 });
      Object.assign(place, { width: Math.round(width * ratio), height: Math.round(found.height * ratio) });
      prepare(context, ratio);
    };
    canvases.set(place, { found, measure });
    new ResizeObserver(() => { if (place.clientWidth !== found.width || place.clientHeight !== found.height) { measure(); self.refresh(); } }).observe(place);
    new IntersectionObserver(([entry]) => { found.shown = entry.isIntersecting; if (found.shown) self.refresh(); }).observe(place);
    return () => {
      if (!found.version) measure();
      context.clearRect(0, 0, found.width, found.height);
      return found;
    };
  };

  addEventListener("beforeprint", () => {  // paper shows what is not in view, too
    for (const { found, measure } of canvases.values()) { found.shown = true; measure(); }
    self.paint();
  });

  function prepare(context, ratio) {
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  }

  // What stays from frame to frame is painted once, until its key says that it looks different.
  self.layer = () => {
    const kept = document.createElement("canvas"), context = kept.getContext("2d");
    let known = null;
    return (target, key, paint) => {
      const ratio = window.devicePixelRatio || 1, { canvas } = target.context, wanted = `${key} ${canvas.width} ${canvas.height} ${colour("sea")}`;
      if (known !== wanted) {
        known = wanted;
        Object.assign(kept, { width: canvas.width, height: canvas.height });
        prepare(context, ratio);
        paint(context);
      }
      target.context.drawImage(kept, 0, 0, target.width, target.height);
    };
  };

  self.opened = () => {
    window.scene = self;  // for those who look from outside
    if (data.opens_at !== undefined) self.go(data.opens_at);
    fromAddress();
    report.draw(section, () => { shades.clear(); self.paint(); }, true);
  };
  return self;
})();
