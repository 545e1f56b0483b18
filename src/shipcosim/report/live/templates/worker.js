// What comes of each loss: the present state runs on with one unit or bus lost and with the scenario's events, and is watched.
let engine = null, about = null;

function future({ state, coming, changes, steps, watch }) {
  engine.restore(state);
  const begin = engine.step(), width = about.columns[watch.x].length, found = { distance: 0, heading: 0, crossed: null };
  const due = [...coming, ...changes.map(([action, name, value]) => [begin, action, name, value])], track = [];
  let row = 0;
  engine.advance(begin + steps, due, (tables) => {
    const table = tables[watch.x];
    for (let at = 0; at < table.length; at += width, row += 1) {
      const [n, e, h, na, ea, ha] = watch.columns.map((column) => table[at + column]);
      const distance = Math.hypot(n - na, e - ea), heading = Math.abs(((((h - ha) * 180) / Math.PI + 540) % 360) - 180);
      found.distance = Math.max(found.distance, distance);
      found.heading = Math.max(found.heading, heading);
      const over = distance > watch.distance ? "position" : heading > watch.heading ? "heading" : null;
      if (over && !found.crossed) found.crossed = { what: over, after: engine.seconds(row * about.steps_per_row) };
      track.push(n, e, h);
    }
  });
  return { ...found, track };
}

onmessage = ({ data }) => {
  if (data.module) { about = data.about; engine = makeEngine(data.module, about); return; }
  const began = performance.now();
  const answers = data.losses.map((loss) => {
    try { return { name: loss.name, ...future({ ...data, changes: loss.changes }) }; }
    catch (error) { return { name: loss.name, error: error.message }; }
  });
  postMessage({ time: data.time, answers, milliseconds: performance.now() - began });
};
