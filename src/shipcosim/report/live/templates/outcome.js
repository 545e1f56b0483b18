// What comes of a future. Rows: north, east and heading of the ship, and of where she is to be [m, m, rad]; seconds between them.
// Found: the largest distance [m] and turn [deg] from there, the limit that is crossed first and after how long, and her track.
function outcomeOf(rows, limits, seconds) {
  const found = { distance: 0, heading: 0, crossed: null, track: [] };
  rows.forEach(([n, e, h, na, ea, ha], row) => {
    const distance = Math.hypot(n - na, e - ea), heading = Math.abs(((((h - ha) * 180) / Math.PI + 540) % 360) - 180);
    found.distance = Math.max(found.distance, distance);
    found.heading = Math.max(found.heading, heading);
    const over = distance > limits.distance ? "position" : heading > limits.heading ? "heading" : null;
    if (over && !found.crossed) found.crossed = { what: over, after: row * seconds };
    found.track.push(n, e, h);
  });
  return found;
}
