// Plots of a page of results: lines, dots, bars and polar plots, drawn as they come into view.
(() => {
  const { data, axis, draw, layout, makeRoom, painted, traces } = report;
  const config = { responsive: true, displayModeBar: false };

  function layoutOf(figure) {
    const { xaxis, yaxis, polar, ...own } = painted(figure.layout);
    const legend = { orientation: "h", x: 0.5, xanchor: "center", y: -0.16, yanchor: "top", font: { size: 12 } };
    const shared = { legend, dragmode: false, margin: { l: 52, r: 16, t: 10, b: 40 } };
    if (polar) {
      const around = { legend: { ...legend, y: -0.08 }, margin: { l: 44, r: 44, t: 30, b: 12 } };
      return layout({ ...shared, ...around, polar, ...own });
    }
    return layout({ ...shared, hovermode: "x unified", ...own, xaxis: axis(xaxis), yaxis: axis(yaxis) });
  }

  for (const place of document.querySelectorAll(".plot")) {
    const figure = data[+place.dataset.figure];
    makeRoom(place, figure);
    draw(place, () => Plotly.react(place, traces(figure.data), layoutOf(figure), config));
  }
})();
