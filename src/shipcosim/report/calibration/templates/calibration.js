// The page of a calibration: dots and bars, drawn as they come into view.
(() => {
  const { data, axis, draw, layout, painted, traces } = report;
  const config = { responsive: true, displayModeBar: false };

  function layoutOf(figure) {
    const { xaxis, yaxis, ...own } = painted(figure.layout);
    const legend = { orientation: "h", x: 0.5, xanchor: "center", y: -0.14, yanchor: "top", font: { size: 12 } };
    const shared = { margin: { l: 52, r: 16, t: 10, b: 40 }, hovermode: "x unified", dragmode: false, legend };
    return layout({ ...shared, ...own, xaxis: axis(xaxis), yaxis: axis(yaxis) });
  }

  for (const place of document.querySelectorAll(".plot")) {
    const figure = data[+place.dataset.figure];
    draw(place, () => Plotly.react(place, traces(figure.data), layoutOf(figure), config));
  }
})();
