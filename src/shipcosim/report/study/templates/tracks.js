// Charts of recorded tracks: density, tracks, outlines to scale at a time, circles of distance; north up, one scale.
(() => {
  const { data, series, colour } = report, MARGIN = 34, OUTLINES = 16, TURN = 2 * Math.PI;

  function chart(section, found) {
    const place = section.querySelector("canvas"), slider = section.querySelector("input[type=range]"), clock = section.querySelector("output"), table = section.querySelector(".beyond");
    const { time, box, circles, cells } = found, last = time.length - 1, shown = new Set(found.series.map((_, k) => k));
    for (const one of found.series) for (const track of one.tracks) for (const part of ["north", "east", "heading"]) track[part] = series(track[part], time.length);
    const reach = found.toScale ? Math.max(...found.hull[0]) : 0;
    let step = last;

    function projection({ width, height }) {
      const [west, east, south, north] = [box[0] - reach, box[1] + reach, box[2] - reach, box[3] + reach];
      const scale = Math.min((width - 2 * MARGIN) / (east - west || 1), (height - 2 * MARGIN) / (north - south || 1));
      const middle = [(west + east) / 2, (south + north) / 2];
      return { scale, x: (e) => width / 2 + (e - middle[0]) * scale, y: (n) => height / 2 - (n - middle[1]) * scale, west: middle[0] - width / 2 / scale, east: middle[0] + width / 2 / scale, south: middle[1] - height / 2 / scale, north: middle[1] + height / 2 / scale };
    }

    function density(c, p) {
      const some = found.series.filter((_, k) => shown.has(k)), most = Math.max(...some.map((one) => one.cells.reduce((a, b) => Math.max(a, b), 0)), 1);
      const wide = ((box[1] - box[0]) / cells) * p.scale, tall = ((box[3] - box[2]) / cells) * p.scale;
      for (const one of some) {
        c.fillStyle = report.painted(one.colour);
        one.cells.forEach((count, k) => {
          if (!count) return;
          c.globalAlpha = 0.06 + 0.5 * Math.sqrt(count / most);
          c.fillRect(p.x(box[0]) + (k % cells) * wide, p.y(box[3]) + Math.floor(k / cells) * tall, Math.max(wide, 0.8) + 0.3, Math.max(tall, 0.8) + 0.3);
        });
      }
      c.globalAlpha = 1;
    }

    function lines(c, p) {
      c.lineWidth = 1;
      found.series.forEach((one, k) => {
        if (!shown.has(k)) return;
        c.strokeStyle = report.painted(one.colour);
        c.globalAlpha = Math.min(Math.max(4 / Math.sqrt(one.tracks.length || 1), 0.15), 0.7);
        for (const { north, east } of one.tracks) {
          c.beginPath();
          for (let m = 0; m <= step; m += 1) if (Number.isFinite(north[m] + east[m])) c.lineTo(p.x(east[m]), p.y(north[m]));
          c.stroke();
        }
      });
      c.globalAlpha = 1;
    }

    function hull(c, p, north, east, heading) {
      const cos = Math.cos((heading * Math.PI) / 180), sin = Math.sin((heading * Math.PI) / 180);
      c.beginPath();
      found.hull[0].forEach((f, k) => { const s = found.hull[1][k]; c.lineTo(p.x(east + sin * f + cos * s), p.y(north + cos * f - sin * s)); });
      c.closePath();
    }

    function ships(c, p) {
      found.series.forEach((one, k) => {
        if (!shown.has(k)) return;
        for (const { north, east, heading } of one.tracks.filter((_, n) => n % Math.ceil(one.tracks.length / OUTLINES) === 0)) {
          if (!Number.isFinite(north[step] + east[step])) continue;
          if (Number.isFinite(heading[step])) hull(c, p, north[step], east[step], heading[step]);
          else { c.beginPath(); c.arc(p.x(east[step]), p.y(north[step]), 3, 0, TURN); }
          c.fillStyle = report.painted(`${one.colour}/0.12`); c.fill();
          c.strokeStyle = report.painted(`${one.colour}/0.8`); c.lineWidth = 1; c.stroke();
        }
      });
    }

    function grid(target, p) {
      const { context: c, width, height } = target;
      c.strokeStyle = colour("grid"); c.lineWidth = 1;
      const easts = study.ticks(p.west, p.east, Math.max(Math.floor(width / 90), 2)), norths = study.ticks(p.south, p.north, Math.max(Math.floor(height / 60), 2));
      for (const e of easts) { c.beginPath(); c.moveTo(p.x(e), 0); c.lineTo(p.x(e), height); c.stroke(); }
      for (const n of norths) { c.beginPath(); c.moveTo(0, p.y(n)); c.lineTo(width, p.y(n)); c.stroke(); }
      return { easts, norths };
    }

    const signed = (v) => `${+v.toPrecision(6)}`.replace("-", "−");
    function paint(target) {
      const { context: c, width, height } = target, p = projection(target), { easts, norths } = grid(target, p);
      target.layer([...shown].join(), (layer) => density(layer, p));
      lines(c, p);
      ships(c, p);
      for (const radius of circles) {
        c.setLineDash([5, 4]); c.strokeStyle = colour("vermillion"); c.lineWidth = 1.3;
        c.beginPath(); c.arc(p.x(0), p.y(0), radius * p.scale, 0, TURN); c.stroke(); c.setLineDash([]);
      }
      const said = [];
      for (const radius of circles) {  // on the circle, where there is room
        for (let turn = -0.375; turn < 0.625; turn += 0.0625) {
          const x = p.x(0) + radius * p.scale * Math.cos(turn * TURN), y = p.y(0) + radius * p.scale * Math.sin(turn * TURN);
          if (x < 60 || x > width - 30 || y < 12 || y > height - 28 || said.some(([a, b]) => Math.abs(a - x) < 46 && Math.abs(b - y) < 16)) continue;
          target.write(`${radius} m`, x, y, { align: "center", shade: "failed" });
          said.push([x, y]);
          break;
        }
      }
      c.beginPath(); c.strokeStyle = colour("ink"); c.lineWidth = 1.5; c.moveTo(p.x(0) - 6, p.y(0)); c.lineTo(p.x(0) + 6, p.y(0)); c.moveTo(p.x(0), p.y(0) - 6); c.lineTo(p.x(0), p.y(0) + 6); c.stroke();
      const unit = (list, k) => `${signed(list[k])}${k === list.length - 1 ? " m" : ""}`;
      easts.forEach((e, k) => { if (p.x(e) > 44 && p.x(e) < width - 24) target.write(unit(easts, k), p.x(e), height - 9, { align: "center" }); });
      norths.forEach((n, k) => { if (p.y(n) > 10 && p.y(n) < height - 24) target.write(unit(norths, k), 5, p.y(n)); });
    }

    const canvas = study.canvas(place, paint);
    function told() {
      clock.textContent = `${+time[step].toFixed(1)} s`;
      const head = ["", "runs", ...circles.map((radius) => `beyond ${radius} m`)];
      const rows = found.series.map((one) => [one.label, one.count, ...one.beyond.map((shares) => `${Math.round(100 * shares[step])} %`)]);
      const line = (cells, tag) => { const row = document.createElement("tr"); row.append(...cells.map((text) => Object.assign(document.createElement(tag), { textContent: text }))); return row; };
      const caption = Object.assign(document.createElement("caption"), { textContent: `Share of all runs that had left each circle by ${+time[step].toFixed(1)} s` });
      table.replaceChildren(caption, line(head, "th"), ...rows.map((row) => line(row, "td")));
    }
    Object.assign(slider, { min: 0, max: last, value: last });
    slider.addEventListener("input", () => { step = +slider.value; told(); canvas.soon(); });
    for (const check of section.querySelectorAll(".key input")) check.addEventListener("change", () => { shown[check.checked ? "add" : "delete"](+check.value); canvas.soon(); });
    const shade = () => { for (const swatch of section.querySelectorAll("[data-colour]")) swatch.style.borderColor = report.painted(swatch.dataset.colour); };
    addEventListener("scheme", shade);
    shade();
    told();
  }

  for (const section of document.querySelectorAll("[data-tracks]")) chart(section, data.tracks[+section.dataset.tracks]);
})();
