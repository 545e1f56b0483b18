// What plotly.min.js is built from: plotly.js with the kinds of traces that our pages draw, lines, bars and polar
// curves, instead of all fifty. In an empty folder, with this file in it:
//   npm install --ignore-scripts plotly.js@4.1.1 esbuild@0.28.2
//   node_modules/@esbuild/linux-x64/bin/esbuild plotly.entry.js --bundle --minify --format=iife --global-name=Plotly \
//     --define:global=window --target=es2020 --legal-comments=none --outfile=plotly.min.js
// Licences of all that is in it: PLOTLY-LICENSES.txt.
"use strict";
const Plotly = require("plotly.js/lib/core");
Plotly.register([require("plotly.js/lib/bar"), require("plotly.js/lib/scatterpolar")]);
module.exports = Plotly;
