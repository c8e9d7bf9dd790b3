// SPDX-License-Identifier: Apache-2.0
// Makes page.js and page.css of the sources, beside index.html, in the folder that is named.
import { build } from "esbuild";
import { cp, mkdir } from "node:fs/promises";

const out = process.argv[2] ?? "../build/release/page";
await mkdir(out, { recursive: true });
await build({
  entryPoints: { page: "src/main.ts" },
  bundle: true, minify: true, format: "esm", target: "es2022", outdir: out, legalComments: "none",
});
for (const file of ["index.html", "icon.svg"]) await cp(file, `${out}/${file}`);
