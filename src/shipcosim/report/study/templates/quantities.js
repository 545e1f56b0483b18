// Quantities of the chosen runs: median, nine in ten, largest; the share of what is true or false.
(() => {
  const table = document.getElementById("quantities"), quantities = study.columns.filter((column) => column.role === "quantity" && !column.labels.length).slice(0, 10);
  if (!quantities.length) return;
  const line = (tag, texts) => { const row = document.createElement("tr"); row.append(...texts.map((text) => Object.assign(document.createElement(tag), { textContent: text }))); return row; };

  function numbers(column) {
    const known = study.chosen.filter((row) => Number.isFinite(column.values[row])), values = Float64Array.from(known, (row) => column.values[row]).sort();
    if (!values.length) return ["–", "–", "–"];
    if (column.truth) return [`${Math.round((100 * values.reduce((a, b) => a + b, 0)) / values.length)} % yes`, "", ""];
    const at = (share) => { const x = share * (values.length - 1), k = Math.floor(x); return values[k] + (x - k) * ((values[k + 1] ?? values[k]) - values[k]); };
    return [0.5, 0.9, 1].map((share) => study.text({ ...column, levels: null }, at(share)));
  }

  study.listen((what) => {
    if (what !== "choice") return;
    table.replaceChildren(line("th", ["Of the chosen runs", "median", "90 %", "largest"]), ...quantities.map((column) => line("td", [column.title, ...numbers(column)])));
  });
})();
