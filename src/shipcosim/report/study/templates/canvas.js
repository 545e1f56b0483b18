// Canvases of the page of a study: sharp on every screen, drawn again when their size, the scheme or the paper asks.
study.canvas = (place, paint) => {
  const context = place.getContext("2d"), target = { context, place, width: 0, height: 0 };
  const boxes = [];
  study.boxes[place.id || place.className] = boxes;  // where texts are, for those who look from outside

  function measure() {
    const ratio = window.devicePixelRatio || 1;
    Object.assign(target, { width: place.clientWidth, height: place.clientHeight });
    Object.assign(place, { width: Math.round(target.width * ratio), height: Math.round(target.height * ratio) });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    context.textBaseline = "middle";
  }

  // What stays while a pointer moves is painted once, until its key says that it looks different.
  const kept = document.createElement("canvas"), layer = kept.getContext("2d");
  let known = null;
  target.layer = (key, draw) => {
    const wanted = `${key} ${place.width} ${place.height} ${report.colour("card")}`;
    if (known !== wanted) {
      known = wanted;
      Object.assign(kept, { width: place.width, height: place.height });
      layer.setTransform(context.getTransform());
      draw(layer);
    }
    context.drawImage(kept, 0, 0, target.width, target.height);
  };

  function now() {
    if (place.clientWidth !== target.width || place.clientHeight !== target.height || !target.width) measure();
    context.clearRect(0, 0, target.width, target.height);
    boxes.length = 0;
    if (target.width) paint(target);
  }

  // A text on a ground of its own colour, so that it can be read over lines.
  target.write = (text, x, y, { align = "left", shade = "soft", bold = false } = {}) => {
    context.textAlign = align;
    context.lineWidth = 3;
    context.lineJoin = "round";
    if (bold) context.font = context.font.replace(/^/, "600 ");
    context.strokeStyle = report.colour("card");
    context.fillStyle = report.colour(shade);
    context.strokeText(text, x, y);
    context.fillText(text, x, y);
    const wide = context.measureText(text).width, left = align === "right" ? x - wide : align === "center" ? x - wide / 2 : x;
    if (bold) context.font = context.font.replace(/^600 /, "");
    boxes.push({ text, left, right: left + wide, top: y - 6, bottom: y + 6 });
  };

  let waiting = false;
  const soon = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; now(); });
  };
  new ResizeObserver(() => { if (place.clientWidth !== target.width || place.clientHeight !== target.height) soon(); }).observe(place);
  report.draw(place, now);
  addEventListener("beforeprint", now);
  return { soon, now, target };
};

// Round steps of an axis: so many at most.
study.ticks = (low, high, most) => {
  const least = (high - low) / most, power = 10 ** Math.floor(Math.log10(least)), step = [1, 2, 5, 10].map((n) => n * power).find((one) => one >= least * 0.999);
  if (!(high > low) || !step) return [low];
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(+(k * step).toPrecision(12));
  return found;
};

// Where the pointer is on a canvas. [px]
study.at = (event, place) => {
  const box = place.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
};
