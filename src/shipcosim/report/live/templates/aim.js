// The set point by hand: by a click in the chart, by dragging its cross, by the arrow keys, and by a joystick.
(() => {
  const { live } = report, { act, present, move, element } = window.desk, chart = document.getElementById("scene-chart");
  const STEP = 1, TURN = 5;  // m and degrees that a key moves it
  const run = report.data.scene[0], recipes = (run.vessels[0]?.aims["set point"] || []).map((column) => run.recipes[column]);
  const signals = recipes.map((recipe) => recipe && !recipe.angle && live.about.signals[recipe.signal]);
  if (!signals[0] || !signals[1]) { move.hidden = true; return; }

  // ---- its north, east and heading in m and degrees, as the chart shows them

  const aim = (k) => (signals[k] ? recipes[k].factor * present(recipes[k].signal) + recipes[k].offset : NaN);
  function set(k, shown) {
    const value = (shown - recipes[k].offset) / recipes[k].factor, { min = -Infinity, max = Infinity } = signals[k];
    act("override", recipes[k].signal, Math.min(Math.max(value, min), max));
  }
  function place({ north, east }) {
    set(0, +north.toFixed(1));
    set(1, +east.toFixed(1));
    scene.refresh();
  }

  // ---- keys

  const words = element("p", { className: "hint", id: "aim" }), value = element("output");
  words.append("Set point: ", value, ` In the chart the arrow keys move it by ${STEP} m${signals[2] ? `, ← and → with Shift turn it by ${TURN}°` : ""}; or drag its cross. A joystick or gamepad moves it too.${run.vessels[0].aims.reference ? " The reference travels there from where it is." : ""}`);
  document.getElementById("scene").append(words);
  Object.assign(chart, { tabIndex: 0, role: "application" });
  chart.setAttribute("aria-describedby", "aim");
  chart.addEventListener("keydown", (event) => {
    const across = event.shiftKey ? [2, TURN] : [1, STEP], along = event.shiftKey ? null : [0, STEP];
    const found = { ArrowRight: [across, 1], ArrowLeft: [across, -1], ArrowUp: [along, 1], ArrowDown: [along, -1] }[event.key];
    if (!found?.[0] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();  // outside of the chart these keys go through time
    const [[k, size], sense] = found;
    if (signals[k]) set(k, k === 2 ? scene.wrapped(Math.round(aim(k)) + sense * size) : +(aim(k) + sense * size).toFixed(1));
    scene.refresh();
  });

  // ---- joystick or gamepad: forward is north, as in the chart; its third axis turns the ship

  const FASTEST = [1, 1, TURN], IDLE = 0.15, EVERY = 250;  // m/s and deg/s at full stick; share of it that moves nothing; ms
  let stick = null;
  function steered() {
    const pad = [...navigator.getGamepads()].find(Boolean);
    if (!pad) { clearInterval(stick); stick = null; return; }
    const [right = 0, back = 0, turn = 0] = pad.axes.map((axis) => (Math.abs(axis) < IDLE ? 0 : axis));
    for (const [k, share] of [-back, right, turn].entries()) {
      const next = aim(k) + (share * FASTEST[k] * EVERY) / 1000;
      if (share && signals[k]) set(k, +(k === 2 ? scene.wrapped(next) : next).toFixed(2));
    }
    if (right || back || turn) scene.refresh();
  }
  window.addEventListener("gamepadconnected", () => { stick ??= setInterval(steered, EVERY); });

  // ---- pointer

  const NEAR = 14, FINGER = 24, STILL = 4;  // pixels: from its cross, and between press and release of a click
  let dragged = null, pressed = [0, 0];
  const pointer = (event) => { const box = chart.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const apart = ([x, y], [u, v]) => Math.hypot(x - u, y - v);
  const isNear = (event) => apart(pointer(event), scene.pixel(aim(1), aim(0))) < (event.pointerType === "touch" ? FINGER : NEAR);

  chart.addEventListener("pointerdown", (event) => {
    pressed = pointer(event);
    if (move.ariaPressed === "true" || !isNear(event)) return;
    event.stopImmediatePropagation();  // the chart itself stays where it is
    dragged = { north: aim(0), east: aim(1) };
    chart.setPointerCapture(event.pointerId);
  }, { capture: true });
  chart.addEventListener("pointermove", (event) => {
    chart.style.cursor = move.ariaPressed === "true" ? "crosshair" : dragged || isNear(event) ? "move" : "";
    if (!dragged) return;
    event.stopImmediatePropagation();
    dragged = scene.place(...pointer(event));
    scene.refresh();
  }, { capture: true });
  chart.addEventListener("pointerup", (event) => {
    if (dragged && apart(pointer(event), pressed) >= STILL) place(dragged);
    dragged = null;
    scene.refresh();
  });
  chart.addEventListener("touchstart", (event) => { if (dragged) event.preventDefault(); }, { passive: false });  // else the page scrolls
  chart.addEventListener("pointercancel", () => { dragged = null; scene.refresh(); });

  move.addEventListener("click", () => move.setAttribute("aria-pressed", String(move.ariaPressed !== "true")));
  chart.addEventListener("click", (event) => {
    if (move.ariaPressed !== "true" || apart(pointer(event), pressed) >= STILL) return;
    move.setAttribute("aria-pressed", "false");
    place(scene.place(...pointer(event)));
  });

  // ---- what is not yet in a row: where it is dragged to, or stands from the next step on

  scene.paints(() => {
    const pending = live.pending.some(([, , name]) => recipes.some((recipe) => recipe?.signal === name));
    if (!dragged && !(pending && scene.time >= live.time.last)) return [];
    const next = dragged || { north: aim(0), east: aim(1) };
    const c = chart.getContext("2d"), [x, y] = scene.pixel(next.east, next.north);
    c.beginPath(); c.moveTo(x - 10, y); c.lineTo(x + 10, y); c.moveTo(x, y - 10); c.lineTo(x, y + 10); scene.stroke(c, "blue", 2);
    if (signals[2]) { const hull = scene.placed(run.vessels[0], next.north, next.east, aim(2)); scene.outline(c, hull); scene.stroke(c, "blue", 1.2, [2, 3]); }
    return [{ what: "next set point", ...next, heading: aim(2) }];
  });

  const degrees = (angle) => `${scene.compass(+angle.toFixed(1)).toFixed(1)}°`;
  scene.writes(() => {
    const { north, east } = dragged || { north: aim(0), east: aim(1) };
    const text = `${north.toFixed(1)} m north, ${east.toFixed(1)} m east${signals[2] ? `, heading ${degrees(aim(2))}` : ""}.`;
    if (value.textContent !== text) value.textContent = text;
  });
})();
