"use strict";
// Light or dark: what the system says, or what the reader chose, on this page and the next. Paper is light.
(() => {
  const root = document.documentElement, system = matchMedia("(prefers-color-scheme: dark)");
  const ofSystem = () => (system.matches ? "dark" : "light");
  const kept = { get: () => null, set: () => {} };
  try {  // a page inside another may have no storage
    const storage = localStorage;
    kept.get = () => storage.getItem("shipcosim-scheme");
    kept.set = (scheme) => (scheme ? storage.setItem("shipcosim-scheme", scheme) : storage.removeItem("shipcosim-scheme"));
  } catch {}

  function show(scheme) {
    if (root.dataset.scheme === scheme) return;
    root.dataset.scheme = scheme;
    const button = document.getElementById("scheme");
    if (button) label(button);
    dispatchEvent(new Event("scheme"));
  }

  function label(button) {
    button.textContent = root.dataset.scheme === "dark" ? "Light" : "Dark";
  }

  show(kept.get() || ofSystem());
  system.addEventListener("change", () => { kept.set(null); show(ofSystem()); });
  document.addEventListener("DOMContentLoaded", () => {
    const button = document.getElementById("scheme");
    label(button);
    button.addEventListener("click", () => {
      const other = root.dataset.scheme === "dark" ? "light" : "dark";
      kept.set(other === ofSystem() ? null : other);
      show(other);
    });
  });
  let before;
  addEventListener("beforeprint", () => { before = root.dataset.scheme; show("light"); });
  addEventListener("afterprint", () => show(before));
})();
