// A system in WebAssembly, in the page and in its worker: start, steps, changes, states.
function makeEngine(module, about) {
  const calls = new WebAssembly.Instance(module, {}).exports;
  calls._initialize?.();
  const bytes = () => new Uint8Array(calls.memory.buffer);

  function words() {
    const from = calls.desk_words(), all = bytes();
    return new TextDecoder().decode(all.slice(from, all.indexOf(0, from)));
  }

  function check(status) {
    if (status) throw new Error(words() || "the run cannot go on");
  }

  const step = () => Number(calls.desk_step());
  const seconds = (steps) => (steps * about.step[0]) / about.step[1];

  // The rows of the last call: for each exchange a view of its numbers, row by row.
  function rows() {
    const count = Number(calls.desk_rows());
    return about.columns.map((names, x) => {
      const Numbers = about.kinds[x] === "Real" ? Float64Array : Int32Array;
      return new Numbers(calls.memory.buffer, calls.desk_table(x), count * names.length);
    });
  }

  // An event: override, bias or reset of a signal, which acts on the step that starts now.
  function change(action, name, value) {
    const { x, side, row, start } = about.signals[name], number = Number(value ?? 0);
    if (side === 2) calls.desk_give(x, row, action === "override" ? number : Number(start ?? 0) + (action === "bias" ? number : 0));
    else if (action === "reset") calls.desk_release(x, side, row);
    else calls.desk_modify(x, side, row, action === "override" ? 0 : 1, number);
  }

  // Steps up to a number of them, with the changes that are due on the way; `onRows` gets the rows of each call.
  function advance(to, due, onRows) {
    while (step() < to) {
      const now = step();
      for (const [, action, name, value] of due.filter(([at]) => at === now)) change(action, name, value);
      const next = Math.min(to, now + about.most_steps, ...due.map(([at]) => at).filter((at) => at > now));
      const status = calls.desk_advance(next - now);
      onRows?.(rows());
      check(status);
    }
  }

  // What changes while it runs lies behind the stack.
  const from = calls.__global_base.value;
  return {
    step, seconds, advance, change,
    ready: (until) => performance.now() < until, stride: () => 20 * about.steps_per_row + 1, ahead: () => 0,  // as fast as it goes
    start: (values = {}) => {
      for (const [place, value] of Object.entries(values)) calls.desk_change_start(+place, value);
      check(calls.desk_start());
    },
    state: () => bytes().slice(from),
    restore: (state) => {
      const missing = from + state.length - bytes().length;
      if (missing > 0) calls.memory.grow(Math.ceil(missing / 65536));
      bytes().set(state, from);
    },
  };
}
