"use strict";
// Colours of the page: day and bright are light, dusk and night are dark. They follow the system, or what the reader
// chose, on this page and the next. Paper is day.
(() => {
  const SCHEMES = { day: "light", dusk: "dark", night: "dark", bright: "light" };
  const root = document.documentElement, system = matchMedia("(prefers-color-scheme: dark)");
  const ofSystem = () => (system.matches ? "dusk" : "day");
  const kept = { get: () => null, set: () => {} };
  try {  // a page inside another may have no storage
    const storage = localStorage;
    kept.get = () => storage.getItem("shipcosim-palette");
    kept.set = (palette) => (palette ? storage.setItem("shipcosim-palette", palette) : storage.removeItem("shipcosim-palette"));
  } catch {}

  function show(palette) {
    if (root.dataset.obcTheme === palette) return;
    root.dataset.obcTheme = palette;  // as OpenBridge's style sheet asks for it
    root.dataset.scheme = SCHEMES[palette];
    const control = document.getElementById("scheme");
    if (control) label(control);
    dispatchEvent(new Event("scheme"));
  }

  function choose(palette) {
    kept.set(palette === ofSystem() ? null : palette);
    show(palette);
  }

  // Pages with instruments have a list of the palettes, others a button for light and dark.
  function label(control) {
    if (control.options) control.value = root.dataset.obcTheme;
    else control.textContent = root.dataset.scheme === "dark" ? "Light" : "Dark";
  }

  show(SCHEMES[kept.get()] ? kept.get() : ofSystem());
  system.addEventListener("change", () => { kept.set(null); show(ofSystem()); });
  document.addEventListener("DOMContentLoaded", () => {
    const control = document.getElementById("scheme");
    label(control);
    if (control.options) control.addEventListener("change", () => choose(control.value));
    else control.addEventListener("click", () => choose(root.dataset.scheme === "dark" ? "day" : "dusk"));
  });
  let before;
  addEventListener("beforeprint", () => { before = root.dataset.obcTheme; show("day"); });
  addEventListener("afterprint", () => show(before));
})();
