// Footprint and polar of the errors: where about the reference she was and how often, and how far off in each direction.
(() => {
  const section = document.getElementById("errors");
  if (!scene || !section) return;
  const { runs, colour, stroke, nice } = scene, CELLS = 40, SECTORS = 16, TURN = 2 * Math.PI;
  const two = runs.length > 1;

  function errorsOf(run) {
    const vessel = scene.vesselOf(run), aim = vessel && (vessel.aims.reference || vessel.aims["set point"]);
    if (!aim) return null;
    const [n, e] = [0, 1].map((k) => run.columns[vessel.pose[k]].map((v, row) => v - run.columns[aim[k]][row]));
    const kept = [...n.keys()].filter((k) => Number.isFinite(n[k] + e[k]));
    if (!kept.length) return null;
    const off = kept.map((k) => Math.hypot(n[k], e[k])), ordered = off.slice().sort((a, b) => a - b), share = (q) => ordered[Math.min(Math.floor(q * ordered.length), ordered.length - 1)];
    return { run, word: vessel.aims.reference ? "reference" : "set point", north: kept.map((k) => n[k]), east: kept.map((k) => e[k]), off, half: share(0.5), most: share(0.95), largest: ordered[ordered.length - 1] };
  }

  let found = [], range = 1;
  function look() {
    found = runs.map(errorsOf).filter(Boolean);
    section.hidden = !found.length;
    range = Math.max(...found.map((one) => one.largest), 1e-6) * 1.05;
    found.forEach((one) => Object.assign(one, { cells: counted(one), sectors: turned(one) }));
    const captions = section.querySelectorAll("figcaption"), name = (one) => (two ? `${one.run.label}: ` : "");
    if (!found.length) return;
    captions[0].textContent = `Position about the ${found[0].word}, the darker the longer; half of the time and 95 % of it lie within the rings. ` + found.map((one) => `${name(one)}50 % ${one.half.toFixed(2)} m, 95 % ${one.most.toFixed(2)} m, largest ${one.largest.toFixed(2)} m.`).join(" ");
    captions[1].textContent = `Distance off the ${found[0].word} by direction: mean (dark) and largest (light).`;
  }

  function counted({ north, east }) {
    const cells = new Float64Array(CELLS * CELLS);
    north.forEach((n, k) => {
      const i = Math.min(Math.floor(((east[k] + range) / (2 * range)) * CELLS), CELLS - 1), j = Math.min(Math.floor(((range - n) / (2 * range)) * CELLS), CELLS - 1);
      cells[j * CELLS + i] += 1;
    });
    const most = Math.max(...cells);
    return cells.map((count) => Math.sqrt(count / most));
  }

  function turned({ north, east, off }) {
    const sectors = Array.from({ length: SECTORS }, () => ({ count: 0, sum: 0, most: 0 }));
    off.forEach((distance, k) => {
      const sector = sectors[Math.round(((Math.atan2(east[k], north[k]) + TURN) / TURN) * SECTORS) % SECTORS];
      sector.count += 1; sector.sum += distance; sector.most = Math.max(sector.most, distance);
    });
    return sectors.map(({ count, sum, most }) => ({ count, mean: count ? sum / count : 0, most }));
  }

  // ---- drawing

  const places = { footprint: scene.canvas("footprint", (width) => width), polar: scene.canvas("polar", (width) => width) };
  const layers = { footprint: scene.layer(), polar: scene.layer() };

  function figure(name, paint) {  // its place, with what stays painted; nothing while it is out of sight
    const target = places[name]();
    if (section.hidden || !target.shown) return null;
    const { context: c, width, height } = target, f = { c, x: width / 2, y: height / 2, R: width / 2 - 22, step: nice(range / 3.2) };
    f.scale = f.R / range;
    layers[name](target, scene.chosen, (still) => { letters({ ...f, c: still }); paint({ ...f, c: still }); });
    return f;
  }

  function letters({ c, x, y, R }) {
    c.textAlign = "center"; c.textBaseline = "middle"; c.fillStyle = colour("soft");
    [..."NESW"].forEach((letter, k) => c.fillText(letter, x + (R + 12) * Math.sin((k * TURN) / 4), y - (R + 12) * Math.cos((k * TURN) / 4)));
  }

  function rings({ c, x, y, R, scale, step }) {
    c.beginPath(); c.moveTo(x - R, y); c.lineTo(x + R, y); c.moveTo(x, y - R); c.lineTo(x, y + R); stroke(c, "chart-grid", 1);
    const digits = Math.max(0, -Math.floor(Math.log10(step)));
    for (let r = step; r <= range; r += step) {
      c.beginPath(); c.arc(x, y, r * scale, 0, TURN); stroke(c, "faint/0.7", 1);
      c.fillStyle = colour("ink"); c.textAlign = "left"; c.fillText(`${r.toFixed(digits)} m`, x + 3, y - r * scale + 8); c.textAlign = "center";
    }
  }

  function spot({ c, x, y, scale }, states) {
    return states.map((one) => ({ run: one.run, state: scene.of(one) })).filter(({ state }) => state?.off).map(({ run, state }) => {
      c.beginPath(); c.arc(x + state.off.east * scale, y - state.off.north * scale, 4.5, 0, TURN); c.fillStyle = colour(run.colour); c.fill(); stroke(c, "card", 1.5);
      return { what: "error", run: run.label, north: state.off.north, east: state.off.east };
    });
  }

  function density(f) {
    const { c, x, y, R, scale } = f, side = (2 * R) / CELLS;
    for (const { run, cells } of found) cells.forEach((share, k) => {
      if (!share) return;
      c.fillStyle = colour(`${run.colour}/${((0.08 + 0.8 * share) * (two ? 0.7 : 1)).toFixed(2)}`);
      c.fillRect(x - R + (k % CELLS) * side, y - R + Math.floor(k / CELLS) * side, side + 0.5, side + 0.5);
    });
    rings(f);
    for (const { run, half, most } of found) { c.beginPath(); c.arc(x, y, half * scale, 0, TURN); stroke(c, run.colour, 1.5); c.beginPath(); c.arc(x, y, most * scale, 0, TURN); stroke(c, run.colour, 1.5, [6, 4]); }
  }

  function rose(f) {
    const { c, x, y, scale } = f;
    for (const { run, sectors } of found) sectors.forEach(({ mean, most }, k) => {
      const from = ((k - 0.5) / SECTORS) * TURN - TURN / 4, to = ((k + 0.5) / SECTORS) * TURN - TURN / 4;
      for (const [radius, shade] of [[most, `${run.colour}/0.22`], [mean, `${run.colour}/0.6`]]) { c.beginPath(); c.moveTo(x, y); c.arc(x, y, radius * scale, from, to); c.closePath(); c.fillStyle = colour(shade); c.fill(); if (two) stroke(c, run.colour, 1); }
    });
    rings(f);
  }

  scene.paints((states) => {
    const f = figure("footprint", density);
    return f ? [...spot(f, states), ...found.map((one) => ({ what: "footprint", run: one.run.label, rows: one.off.length, half: one.half, most: one.most, largest: one.largest }))] : [];
  });
  scene.paints((states) => {
    const f = figure("polar", rose);
    return f ? [...spot(f, states), ...found.flatMap(({ run, sectors }) => sectors.map((sector, k) => ({ what: "sector", run: run.label, degrees: (k * 360) / SECTORS, ...sector })))] : [];
  });

  look();
  addEventListener("scene-vessel", look);
})();
