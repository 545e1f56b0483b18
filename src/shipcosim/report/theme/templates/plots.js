// Plots of a page of results: lines, dots, bars and polar plots, drawn as they come into view.
(() => {
  const { data, axis, draw, layout, makeRoom, narrow, painted, traces } = report;
  const figures = data.figures ?? data;
  const config = { responsive: true, displayModeBar: false };

  function polarLayout(own) {
    const legend = { orientation: "h", x: 0.5, xanchor: "center", y: -0.08, yanchor: "top", font: { size: 12 } };
    return layout({ legend, dragmode: false, margin: { l: 44, r: 44, t: 30, b: 12 }, ...own });
  }

  function layoutOf(figure, isNarrow) {
    const { xaxis, yaxis, ...own } = painted(figure.layout);
    if (own.polar) return polarLayout(own);
    const named = figure.data.filter((t) => t.showlegend !== false).length > 1;
    const isOverTime = figure.data[0] && figure.data[0].mode === "lines" && !(yaxis && yaxis.scaleanchor);
    return layout({
      margin: { l: 48, r: 16, t: named ? 8 : 10, b: 36 }, showlegend: named, dragmode: isNarrow ? false : "zoom",
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: { size: 11 }, traceorder: "normal" },
      hovermode: isOverTime ? "x unified" : "closest",
      ...own, xaxis: axis(xaxis), yaxis: axis(yaxis),
    });
  }

  for (const place of document.querySelectorAll(".plot")) {
    const figure = figures[+place.dataset.figure];
    makeRoom(place, figure);
    draw(place, () => {
      Plotly.react(place, traces(figure.data), layoutOf(figure, narrow(place)), config);
      place.tells ??= place.on("plotly_click", ({ points }) => dispatchEvent(new CustomEvent("figure-point", { detail: points[0] })));
    });
  }
})();
