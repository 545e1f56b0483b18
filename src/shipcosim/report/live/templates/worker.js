// What comes of each loss: the present state runs on with one unit or bus lost and with the scenario's events, and is watched.
let engine = null, about = null;

function future({ state, coming, changes, steps, watch }) {
  engine.restore(state);
  const begin = engine.step(), width = about.columns[watch.x].length, found = [];
  const due = [...coming, ...changes.map(([action, name, value]) => [begin, action, name, value])];
  engine.advance(begin + steps, due, (tables) => {
    const table = tables[watch.x];
    for (let at = 0; at < table.length; at += width) found.push(watch.columns.map((column) => table[at + column]));
  });
  return outcomeOf(found, watch, engine.seconds(about.steps_per_row));
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
