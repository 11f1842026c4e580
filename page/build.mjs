// Puts the live page together: node build.mjs CORE.wasm LICENCES.txt OUTPUT.html
// NODE_MODULES is where npm has put what package.json names.
import { readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";

const [core, licences, output] = process.argv.slice(2);
const modules = process.env.NODE_MODULES;
if (!core || !licences || !output || !modules) {
  throw new Error("usage: NODE_MODULES=... node build.mjs CORE.wasm LICENCES.txt OUTPUT.html");
}
const { build } = createRequire(join(modules, "here"))("esbuild");
const web = (name) => join(import.meta.dirname, "web", name);

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
