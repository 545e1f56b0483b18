// From a row to its run: its numbers, the command that simulates it again, its page; with a server, simulated by a click.
(() => {
  const { columns, runs } = study, { data } = report, panel = document.getElementById("run");
  const pages = new Set(data.pages);
  let server = false;  // whether `shipcosim sweep --serve` shows this page
  const pageOf = (number) => `run-${number}/report.html`;

  const made = (tag, properties = {}, ...parts) => { const element = Object.assign(document.createElement(tag), properties); element.append(...parts); return element; };

  function link(number, text = "Open its page") {
    return made("a", { href: pageOf(number), target: "_blank", rel: "noopener", textContent: text });
  }

  async function copy(button, text) {
    try { await navigator.clipboard.writeText(text); } catch {  // a file has no right to it in every browser
      const field = made("textarea", { value: text });
      panel.append(field);
      field.select();
      document.execCommand("copy");
      field.remove();
    }
    button.textContent = "Copied";
  }

  function show(row) {
    if (row === null || row === undefined) return;
    const number = Math.round(runs[row]), command = `${data.command} --run ${number}`;
    const values = columns.map((column) => made("span", {}, made("b", { textContent: column.name }), ` ${study.text(column, column.values[row])}${column.unit && Number.isFinite(column.values[row]) ? ` ${column.unit}` : ""}`));
    const button = made("button", { type: "button", textContent: "Copy" });
    button.addEventListener("click", () => copy(button, command));
    const ways = pages.has(number) ? [link(number)] : server ? [simulation(number)] : [];
    const error = study.error.get(row);
    panel.replaceChildren(
      made("h3", { textContent: `Run ${number}` }), made("p", { className: "facts" }, ...values.flatMap((value) => [value, " "])),
      ...(error ? [made("p", { className: "error", textContent: error })] : []),
      made("p", { className: "way" }, ...ways, made("code", { textContent: command }), button), made("p", { className: "state" }),
    );
  }

  // ---- with a server

  function simulation(number) {
    const button = made("button", { type: "button", className: "go", textContent: "Simulate and open" });
    button.addEventListener("click", () => simulate(number));
    return button;
  }

  const say = (text, failed = false) => { const state = panel.querySelector(".state"); if (state) { state.textContent = text; state.classList.toggle("error", failed); } };

  async function simulate(number) {
    const tab = window.open("", "_blank");  // now: after waiting a browser would not let us
    if (tab) { tab.document.title = `Run ${number}`; tab.document.body.textContent = `Run ${number} is being simulated …`; }
    say(`Run ${number} is being simulated …`);
    try {
      const answer = await fetch(`run/${number}`, { method: "POST", headers: { "X-Shipcosim": "run" } }), said = await answer.json();
      if (!answer.ok) throw new Error(said.error);
      pages.add(number);
      if (tab && !tab.closed) tab.location = new URL(said.page, location.href).href;
      if (study.row !== null && Math.round(runs[study.row]) === number) show(study.row);
      say(`Run ${number} is simulated.`);
    } catch (error) {
      if (tab) tab.close();
      say(error.message, true);
    }
  }

  function go(number) {
    const row = study.rowOf(number);
    if (row !== undefined) study.show(row);
    if (pages.has(number)) window.open(pageOf(number), "_blank");
    else if (server) simulate(number);
    else if (row === undefined) panel.scrollIntoView({ block: "nearest" });
  }

  document.getElementById("runs").addEventListener("click", (event) => { const button = event.target.closest("button[data-run]"); if (button) go(+button.dataset.run); });
  document.getElementById("failed")?.addEventListener("click", (event) => {
    const row = study.rowOf(+event.target.closest("button[data-run]")?.dataset.run);
    if (row !== undefined) { study.show(row); panel.scrollIntoView({ block: "center" }); }
  });
  addEventListener("figure-point", ({ detail }) => {
    const row = study.rowOf(detail.customdata);
    if (row !== undefined) { study.show(row); panel.scrollIntoView({ block: "center" }); }
  });
  study.listen((what) => { if (what === "row") show(study.row); });
  panel.append(made("p", { className: "lead", textContent: "A click on a row shows its numbers and how to simulate it again." }));

  if (location.protocol.startsWith("http")) {
    fetch("study-server", { headers: { "X-Shipcosim": "run" } }).then(async (answer) => {
      if (!answer.ok) return;
      for (const number of (await answer.json()).pages) pages.add(number);
      server = true;
      document.body.dataset.server = "yes";
      show(study.row);
      if (study.row === null) panel.querySelector(".lead").textContent = "A click on the number of a run simulates it and opens its page.";
    }, () => {});
  }
})();
