// Makes openbridge.min.js: the instruments of OpenBridge that our pages show, and of its four palettes the variables that
// these instruments read. In an empty folder, with this file in it:
//   npm install --ignore-scripts @oicl/openbridge-webcomponents@1.0.1 lit@3.3.3 @lit-labs/observers@2.1.0 esbuild@0.28.2
//   node openbridge.build.mjs
// Licences of all that is in it: OPENBRIDGE-LICENSES.txt.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";

const PACKAGE = "@oicl/openbridge-webcomponents/dist";
const INSTRUMENTS = ["azimuth-thruster", "thruster", "compass"];
const FILE = "openbridge.min.js";

// The instruments, with all that they import.
writeFileSync("entry.mjs", INSTRUMENTS.map((name) => `import "${PACKAGE}/navigation-instruments/${name}/${name}.js";\n`).join(""));
const options = ["--bundle", "--minify", "--format=iife", "--target=es2022", "--legal-comments=none", `--outfile=${FILE}`];
execFileSync("node_modules/@esbuild/linux-x64/bin/esbuild", ["entry.mjs", ...options], { stdio: "inherit" });
const script = readFileSync(FILE, "utf8");

// The variables that they read, and those that these are made of.
const styles = readFileSync(`node_modules/${PACKAGE}/openbridge.css`, "utf8");
const palettes = [...styles.matchAll(/(:root\[data-obc-theme="\w+"\])\s*\{([^{}]*)\}/g)].map(([, selector, body]) => ({
  selector, variables: [...body.matchAll(/(--[\w-]+)\s*:\s*([^;]+);/g)].map(([, name, value]) => [name, value.trim()]),
}));
const readBy = (text) => [...text.matchAll(/var\(\s*(--[\w-]+)/g)].map(([, name]) => name);
const used = new Set(readBy(script));
for (const { variables } of palettes) for (const name of used) for (const [key, value] of variables) if (key === name) readBy(value).forEach((other) => used.add(other));

// What the script adds: a style sheet of the page with the palettes, and one of each component for readers who want no motion.
const rules = palettes.map(({ selector, variables }) => `${selector}{${variables.filter(([name]) => used.has(name)).map((pair) => pair.join(":")).join(";")}}`);
const still = "@media (prefers-reduced-motion:reduce){*{transition:none!important;animation:none!important}}";
const tags = ["watch", ...INSTRUMENTS].map((name) => `obc-${name}`);
writeFileSync(FILE, `${script}{
const sheet=(rules)=>{const made=new CSSStyleSheet();made.replaceSync(rules);return made;};
document.adoptedStyleSheets.push(sheet(${JSON.stringify(rules.join(""))}));
for(const tag of ${JSON.stringify(tags)})customElements.get(tag).elementStyles.push(sheet(${JSON.stringify(still)}));
}
`);
