// The page of a static DP capability: polar plots and lines, drawn as they come into view.
(() => {
  const { data, axis, draw, layout, painted, traces } = report;
  const config = { responsive: true, displayModeBar: false };

  function layoutOf(figure) {
    const { xaxis, polar, ...own } = painted(figure.layout);
    const legend = { orientation: "h", x: 0.5, xanchor: "center", y: -0.08, yanchor: "top", font: { size: 12 } };
    if (polar) return layout({ margin: { l: 44, r: 44, t: 30, b: 12 }, legend, polar, dragmode: false, ...own });
    const shared = { margin: { l: 52, r: 16, t: 10, b: 36 }, hovermode: "x unified", dragmode: false };
    return layout({ ...shared, legend: { ...legend, y: -0.16 }, ...own, xaxis: axis(xaxis), yaxis: axis() });
  }

  for (const place of document.querySelectorAll(".plot")) {
    const figure = data[+place.dataset.figure];
    draw(place, () => Plotly.react(place, traces(figure.data), layoutOf(figure), config));
  }
})();
