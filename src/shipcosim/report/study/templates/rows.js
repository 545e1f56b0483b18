// The table of runs: in any order, of the chosen ones; only the rows in view are there.
(() => {
  const { columns, runs } = study, HEIGHT = 27, MORE = 8;
  const frame = document.querySelector(".rows-scroll"), table = document.getElementById("rows"), head = table.tHead, body = table.tBodies[0];
  const shown = [{ name: "run", title: "run", values: runs, run: true }, ...columns, ...(study.count && report.data.failed.length ? [{ name: "error", title: "error", error: true }] : [])];
  let order = { column: shown[0], down: false }, rows = study.chosen;

  const key = (column, row) => (column.error ? (study.error.has(row) ? 0 : 1) : column.values[row]);
  function sort() {
    rows = Array.from(study.chosen);
    const { column, down } = order;
    rows.sort((a, b) => {  // what has no value comes last either way
      const x = key(column, a), y = key(column, b), gone = Number.isNaN(x) - Number.isNaN(y);
      return gone || (down ? y - x : x - y) || a - b;
    });
    frame.scrollTop = 0;
    draw();
  }

  function cell(column, row) {
    const place = document.createElement("td");
    if (column.run) {
      const button = document.createElement("button");
      Object.assign(button, { type: "button", className: "link", textContent: Math.round(runs[row]), title: "To the page of this run" });
      button.dataset.run = Math.round(runs[row]);
      place.append(button);
    } else if (column.error) {
      place.textContent = study.error.get(row) || "";
      place.title = place.textContent;
      place.className = "error";
    } else {
      place.textContent = study.text(column, column.values[row]);
      if (!column.labels.length && !column.truth) place.className = "number";
    }
    return place;
  }

  function spacer(count) {
    const row = document.createElement("tr");
    row.className = "space";
    row.style.height = `${count * HEIGHT}px`;
    return row;
  }

  function draw() {
    const first = Math.max(Math.floor(frame.scrollTop / HEIGHT) - MORE, 0), last = Math.min(first + Math.ceil(frame.clientHeight / HEIGHT) + 2 * MORE, rows.length);
    const lines = [];
    for (let k = first; k < last; k += 1) {
      const line = document.createElement("tr");
      line.dataset.row = rows[k];
      line.setAttribute("aria-rowindex", k + 1);
      if (rows[k] === study.row) line.className = "shown";
      if (study.error.has(rows[k])) line.classList.add("failed");
      line.append(...shown.map((column) => cell(column, rows[k])));
      lines.push(line);
    }
    body.replaceChildren(spacer(first), ...lines, spacer(rows.length - last));
    table.setAttribute("aria-rowcount", rows.length);
  }

  function titles() {
    const line = document.createElement("tr");
    for (const column of shown) {
      const cell = document.createElement("th"), button = document.createElement("button");
      Object.assign(button, { type: "button", textContent: column.title, title: column.description ? `${column.description}; sorts` : "Sorts" });
      cell.setAttribute("aria-sort", order.column === column ? (order.down ? "descending" : "ascending") : "none");
      button.addEventListener("click", () => { order = { column, down: order.column === column && !order.down }; titles(); sort(); });
      if (column.values && !column.run && !column.labels.length && !column.truth) cell.className = "number";
      cell.append(button);
      line.append(cell);
    }
    head.replaceChildren(line);
  }

  let waiting = false;
  frame.addEventListener("scroll", () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; draw(); });
  }, { passive: true });
  new ResizeObserver(draw).observe(frame);
  body.addEventListener("pointerover", (event) => { const line = event.target.closest("tr[data-row]"); if (line) study.point(+line.dataset.row); });
  body.addEventListener("pointerleave", () => study.point(null));
  body.addEventListener("click", (event) => { const line = event.target.closest("tr[data-row]"); if (line && !event.target.closest("button")) study.show(+line.dataset.row); });
  frame.addEventListener("keydown", (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (!step || !rows.length) return;
    event.preventDefault();
    const at = rows.indexOf(study.row), next = Math.min(Math.max(at < 0 ? 0 : at + step, 0), rows.length - 1);
    if (next * HEIGHT < frame.scrollTop) frame.scrollTop = next * HEIGHT;
    if ((next + 3) * HEIGHT > frame.scrollTop + frame.clientHeight) frame.scrollTop = (next + 3) * HEIGHT - frame.clientHeight;
    study.show(rows[next]);
  });

  study.listen((what) => { if (what === "choice") sort(); else if (what === "row") draw(); });
  titles();
})();
