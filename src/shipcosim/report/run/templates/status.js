// Whether each reference is used, and what each bus carries, at the time that the scene shows.
(() => {
  const section = document.getElementById("status"), run = scene?.runs[0];
  if (!section || !run || scene.runs.length > 1) return;
  const made = (tag, properties = {}, ...parts) => { const found = Object.assign(document.createElement(tag), properties); found.append(...parts); return found; };
  const UNLIMITED = 5e7;  // W; assumed: no bus of a ship has more, models that know no limit say so
  const kilowatts = (watts) => `${(watts / 1000).toFixed(0)} kW`;

  // A sensor says that a reference is valid; a controller that votes says that it rejects one.
  const reference = ({ valid, rejected }, at) => (at(valid) < 0.5 ? "lost" : !rejected ? "valid" : at(rejected) > 0.5 ? "rejected" : "used");
  const power = ({ load, most }, at) => `${kilowatts(at(load))}${most && at(most) < UNLIMITED ? ` of ${kilowatts(at(most))}` : ""}`;
  const groups = [
    { title: "References", entries: run.references, text: reference, isBad: (_, at, text) => text === "lost" || text === "rejected" },
    { title: "Power", entries: run.buses, text: power, isBad: ({ load, most }, at) => Boolean(most) && at(load) > at(most) },
  ].filter(({ entries }) => entries.length);

  section.hidden = !groups.length;
  section.querySelector("h2").textContent = groups.map(({ title }, k) => (k ? title.toLowerCase() : title)).join(" and ");
  const rows = groups.flatMap(({ title, entries, text, isBad }) => {
    const table = made("table"), found = entries.map((entry) => ({ entry, text, isBad, cell: made("td") }));
    for (const { entry, cell } of found) table.append(made("tr", {}, made("th", { scope: "row", textContent: entry.label }), cell));
    section.querySelector(".groups").append(made("div", {}, made("h3", { textContent: title }), table));
    return found;
  });

  scene.writes(([{ where }]) => {
    if (!where) return;
    const at = (column) => run.columns[column][where.row];
    for (const { entry, text, isBad, cell } of rows) {
      const now = text(entry, at);
      if (cell.textContent === now) continue;
      cell.textContent = now;
      cell.className = isBad(entry, at, now) ? "bad" : "";
    }
  });
})();
