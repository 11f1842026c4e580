// Puts the live page together: node build.mjs CORE.wasm LICENCES.txt OUTPUT.html
// NODE_MODULES is where npm has put what package.json names.
import { readFile, readdir, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";

const [core, licences, output] = process.argv.slice(2);
const modules = process.env.NODE_MODULES;
if (!core || !licences || !output || !modules) {
  throw new Error("usage: NODE_MODULES=... node build.mjs CORE.wasm LICENCES.txt OUTPUT.html");
}
const { build } = createRequire(join(modules, "here"))("esbuild");
const web = (name) => join(import.meta.dirname, "web", name);

/** The presets in SI units of the Python package, by name. */
async function presets() {
  const folder = join(import.meta.dirname, "..", "python", "dielectric_actuator", "presets");
  const files = (await readdir(folder)).filter((name) => name.endsWith(".json")).sort();
  const entries = await Promise.all(files.map(async (name) => [name.replace(".json", ""), JSON.parse(await readFile(join(folder, name), "utf8"))]));
  return Object.fromEntries(entries.filter(([, preset]) => preset.model === "si"));
}

const presetsModule = {
  name: "presets",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^presets$/ }, () => ({ path: "presets", namespace: "presets" }));
    onLoad({ filter: /.*/, namespace: "presets" }, async () => ({ contents: JSON.stringify(await presets()), loader: "json" }));
  },
};

/** Everything below an entry in one text. */
async function bundled(entry, options) {
  const { outputFiles } = await build({
    entryPoints: [entry],
    bundle: true,
    minify: true,
    write: false,
    charset: "utf8",
    legalComments: "inline",
    nodePaths: [modules],
    logLevel: "warning",
    ...options,
  });
  return outputFiles[0].text;
}

const script = await bundled(web("main.js"), {
  format: "esm",
  target: "es2022",
  alias: { "core.wasm": core },
  loader: { ".wasm": "binary" },
  plugins: [presetsModule],
});
const style = await bundled(web("style.css"), {});
const plotting = await readFile(join(modules, "uplot", "LICENSE"), "utf8");
const others = await readFile(licences, "utf8");
const parts = {
  style,
  script: script.replaceAll("</script", "<\\/script"),
  licences: `uPlot, which draws the plots\n\n${plotting}\n${others}`.replace(/[&<>]/g, (sign) => `&#${sign.charCodeAt(0)};`),
};
const template = await readFile(web("index.html"), "utf8");
await writeFile(output, template.replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]));
