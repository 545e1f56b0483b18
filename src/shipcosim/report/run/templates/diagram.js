// The thruster diagram: for every unit the force that it gives, bow up, with its limits and forbidden angles shaded.
(() => {
  const section = document.getElementById("diagram");
  if (!scene || !section) return;
  const { runs, colour, stroke, arrow, nice } = scene, TURN = 2 * Math.PI, RADIANS = Math.PI / 180, TEXT = 54;
  const two = runs.length > 1;

  // ---- what there is: units by name, those of both runs in one circle

  let circles = [], range = 1;
  function look() {
    const found = new Map();
    for (const run of runs) for (const unit of scene.vesselOf(run)?.units ?? []) {
      if (!unit.force) continue;
      const [forward, starboard] = unit.force.map((name) => run.columns[name]);
      if (!found.has(unit.name)) found.set(unit.name, []);
      found.get(unit.name).push({ run, unit, forward, starboard });
    }
    circles = [...found].map(([name, parts]) => ({ name, parts, limits: parts[0].unit.limits }));
    let most = 0;
    for (const { parts } of circles) for (const { forward, starboard } of parts) for (let k = 0; k < forward.length; k++) { const f = Math.hypot(forward[k], starboard[k]); if (f > most) most = f; }
    range = nice(Math.max(most, 1e-3));
    section.hidden = !circles.length;
    const shaded = circles.some(({ parts }) => parts.some(({ unit }) => unit.sectors.length)) ? " Shaded: angles that the allocator does not give the unit." : "", beyond = circles.some(({ limits }) => limits && Math.max(-limits[0], limits[1]) <= range) ? " Hatched: beyond the limit of thrust." : "";
    const ticks = circles.some(({ parts }) => parts.some(({ unit }) => unit.azimuth || unit.azimuth_command)) ? "; ticks on the circle: angle of the unit (solid) and as commanded (hollow)" : "";
    section.querySelector(".hint").textContent = `Bow up; every circle ends at ${range} kN. Arrow: the force on the ship now, its trace over the run${ticks}.${shaded}${beyond}`;
  }

  // ---- drawing

  function columns(width) {  // as many as fit, in rows of equal length
    const most = Math.max(1, Math.floor(width / 230));
    return Math.max(1, Math.ceil(circles.length / Math.ceil(circles.length / most)));
  }
  const number = (value, digits) => (+value.toFixed(digits) || 0).toFixed(digits).replace("-", "−");
  const side = (width) => Math.min(width / columns(width), 340);
  const place = scene.canvas("diagram", (width) => Math.ceil(circles.length / columns(width)) * (side(width) + TEXT));
  const layer = scene.layer();

  function frame(k, width) {
    const across = columns(width), s = side(width), left = (width - Math.min(across, circles.length) * s) / 2;
    return { x: left + (k % across) * s + s / 2, y: Math.floor(k / across) * (s + TEXT) + s / 2 + 12, R: s / 2 - 34 };
  }
  const on = ({ x, y }, degrees, r) => [x + r * Math.sin(degrees * RADIANS), y - r * Math.cos(degrees * RADIANS)];
  const wedge = (c, { x, y }, from, to, r) => { c.beginPath(); c.arc(x, y, r, from * RADIANS - TURN / 4, to * RADIANS - TURN / 4); c.lineTo(x, y); c.closePath(); };

  function still(c, width) {
    circles.forEach(({ name, parts, limits }, k) => {
      const f = frame(k, width), scale = f.R / range;
      c.beginPath(); c.arc(f.x, f.y, f.R, 0, TURN); c.fillStyle = colour("sea"); c.fill();
      for (const { run, unit } of parts) for (const [from, to] of unit.sectors) { wedge(c, f, from, to, f.R); c.fillStyle = colour(two ? `${run.colour}/0.16` : "vermillion/0.28"); c.fill(); }
      const most = limits && Math.max(-limits[0], limits[1]) * scale;
      if (limits && most < f.R) beyond(c, f, most);
      if (limits && -limits[0] * scale < f.R && -limits[0] < limits[1]) { c.beginPath(); c.arc(f.x, f.y, -limits[0] * scale, 0, TURN); stroke(c, "ink/0.6", 1, [4, 4]); }
      for (const share of [0.5, 1]) { c.beginPath(); c.arc(f.x, f.y, f.R * share, 0, TURN); stroke(c, "faint", 1); }
      c.beginPath(); c.moveTo(f.x - f.R, f.y); c.lineTo(f.x + f.R, f.y); c.moveTo(f.x, f.y - f.R); c.lineTo(f.x, f.y + f.R); stroke(c, "chart-grid", 1);
      c.textAlign = "center"; c.textBaseline = "middle"; c.fillStyle = colour("soft");
      for (const degrees of [0, 90, 180, -90]) c.fillText(`${degrees}°`.replace("-", "−"), ...on(f, degrees, f.R + 18));
      for (const { run, forward, starboard } of parts) {
        c.beginPath();
        for (let row = 0; row < forward.length; row++) { const x = f.x + starboard[row] * scale, y = f.y - forward[row] * scale; if (row) c.lineTo(x, y); else c.moveTo(x, y); }
        stroke(c, `${run.colour}/0.3`, 1);
      }
      c.fillStyle = colour("ink"); c.fillText(name, f.x, f.y + f.R + 36);
      c.fillStyle = colour("soft"); c.textAlign = "left";
      for (const share of [0.5, 1]) c.fillText(`${+(share * range).toPrecision(3)} kN`, f.x + 4, f.y - f.R * share + 9);
    });
  }

  function beyond(c, { x, y, R }, inner) {  // hatched from the limit to the circle
    c.save(); c.beginPath(); c.arc(x, y, R, 0, TURN); c.arc(x, y, inner, 0, TURN, true); c.clip("evenodd");
    c.beginPath();
    for (let d = -2 * R; d < 2 * R; d += 7) { c.moveTo(x + d - R, y + R); c.lineTo(x + d + R, y - R); }
    stroke(c, "vermillion/0.45", 1.2); c.restore();
    c.beginPath(); c.arc(x, y, inner, 0, TURN); stroke(c, "vermillion", 1.4);
  }

  function tick(c, f, degrees, shade, full) {
    c.beginPath(); c.moveTo(...on(f, degrees, f.R)); c.lineTo(...on(f, degrees - 4, f.R + 9)); c.lineTo(...on(f, degrees + 4, f.R + 9)); c.closePath();
    if (full) { c.fillStyle = colour(shade); c.fill(); } else stroke(c, shade, 1.4);
  }

  scene.paints((states) => {
    const target = place(), { context: c, width } = target, drawn = [];
    if (section.hidden || !target.shown) return drawn;
    layer(target, scene.chosen, (kept) => still(kept, width));
    circles.forEach(({ name, parts, limits }, k) => {
      const f = frame(k, width), scale = f.R / range, said = [];
      for (const { run, unit } of parts) {
        const found = scene.of(states.find((state) => state.run === run))?.units.find((one) => one.unit === unit);
        if (!found || !Number.isFinite(found.force[0] + found.force[1])) continue;
        const [forward, starboard] = found.force, shade = found.state === "runs" ? run.colour : found.state === "limit" ? "caution" : "alarm";
        if (Number.isFinite(found.azimuthCommand)) tick(c, f, found.azimuthCommand, run.colour, false);
        if (Number.isFinite(found.azimuth)) tick(c, f, found.azimuth, shade, true);
        arrow(c, f.x, f.y, f.x + starboard * scale, f.y - forward * scale, shade, 3);
        c.beginPath(); c.arc(f.x, f.y, 3, 0, TURN); c.fillStyle = colour(shade); c.fill();
        said.push(`${found.state === "failed" ? "failed" : `${number(found.thrust, range < 1 ? 3 : 1)} kN`}${Number.isFinite(found.azimuth) ? ` at ${number(scene.wrapped(found.azimuth), 0)}°` : ""}`);
        drawn.push({ what: "diagram", run: run.label, unit: name, force: found.force, to: [f.x + starboard * scale, f.y - forward * scale], middle: [f.x, f.y], range, radius: f.R, azimuth: found.azimuth, limits, sectors: unit.sectors });
      }
      c.textAlign = "center"; c.textBaseline = "middle"; c.fillStyle = colour("soft");
      c.fillText(said.join(two ? "; " : ""), f.x, f.y + f.R + 52);
    });
    return drawn;
  });

  look();
  addEventListener("scene-vessel", look);
})();
