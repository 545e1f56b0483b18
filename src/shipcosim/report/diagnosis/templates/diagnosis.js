// The page of a diagnosis: its figures, drawn as they come into view.
(() => {
  const { data, axis, draw, layout, makeRoom, narrow, painted, traces } = report;
  const config = { responsive: true, displayModeBar: false };

  function layoutOf(figure, isNarrow) {
    const { xaxis, yaxis, ...own } = painted(figure.layout);
    const named = figure.data.filter((t) => t.showlegend !== false).length > 1;
    return layout({
      margin: { l: 48, r: 16, t: named ? 8 : 10, b: 36 }, showlegend: named, dragmode: isNarrow ? false : "zoom",
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: { size: 11 } },
      hovermode: figure.data[0] && figure.data[0].mode === "lines" && !(yaxis && yaxis.scaleanchor) ? "x unified" : "closest",
      ...own, xaxis: axis(xaxis), yaxis: axis(yaxis),
    });
  }

  for (const place of document.querySelectorAll(".plot")) {
    const figure = data[+place.dataset.figure];
    makeRoom(place, figure);
    draw(place, () => Plotly.react(place, traces(figure.data), layoutOf(figure, narrow(place)), config));
  }
})();
