// Panels of what the system puts out: whether each reference is used, and what each bus carries.
(() => {
  const { live } = report, { element } = window.desk, section = document.getElementById("panels");
  const outputs = Object.entries(live.about.signals).filter(([, { side }]) => side === 0), names = outputs.map(([name]) => name);

  // References: a sensor says that one is valid; a controller that votes says that it rejects one.
  const references = outputs.flatMap(([name, { kind }]) => {
    const found = kind === "Boolean" && name.match(/^(?:.*\.)?((?:position|compass|heading|wind|gnss|gyro)\w*)_valid$/);
    if (!found) return [];
    const rejected = names.find((other) => other.endsWith(`.${found[1]}_rejected`));
    const state = (at) => (at(name) < 0.5 ? "lost" : !rejected ? "valid" : at(rejected) > 0.5 ? "rejected" : "used");
    return [{ group: "References", label: found[1], state, isBad: (text) => text === "lost" || text === "rejected" }];
  });

  // Buses: their load, and the power that they have for thrusters.
  const UNLIMITED = 5e7;  // W; assumed: no bus of a ship has more, models that know no limit say so
  const kilowatts = (watts) => `${(watts / 1000).toFixed(0)} kW`;
  const buses = outputs.flatMap(([name, { unit }]) => {
    const found = unit === "W" && name.match(/^(.*\.)(\w*bus\w*)_load$/);
    if (!found) return [];
    const most = `${found[1]}${found[2]}_power`, known = live.raw.has(most);
    const state = (at) => `${kilowatts(at(name))}${known && at(most) < UNLIMITED ? ` of ${kilowatts(at(most))}` : ""}`;
    return [{ group: "Power", label: found[2], state, isBad: (text, at) => known && at(name) > at(most) }];
  });

  const rows = [...references, ...buses].map((one) => ({ ...one, cell: element("td") }));
  const groups = [...new Set(rows.map((one) => one.group))];
  section.hidden = !rows.length;
  section.querySelector("h2").textContent = groups.map((group, k) => (k ? group.toLowerCase() : group)).join(" and ");
  for (const group of groups) {
    const table = element("table");
    for (const { label, cell } of rows.filter((one) => one.group === group)) table.append(element("tr", {}, element("th", { scope: "row", textContent: label.replaceAll("_", " ") }), cell));
    section.querySelector(".groups").append(element("div", {}, element("h3", { textContent: group }), table));
  }

  scene.writes(([{ where }]) => {
    if (!where) return;
    const at = (name) => live.raw.get(name).all[where.row];
    for (const { state, isBad, cell } of rows) {
      const text = state(at);
      if (cell.textContent === text) continue;
      cell.textContent = text;
      cell.className = isBad(text, at) ? "bad" : "";
    }
  });
})();
