// SPDX-License-Identifier: Apache-2.0
// Makes page.js and page.css of the sources, beside index.html, in the folder that is named; each also as gzip.
import { build } from "esbuild";
import { cp, mkdir, readFile, writeFile } from "node:fs/promises";
import { gzipSync } from "node:zlib";

const out = process.argv[2] ?? "../build/release/page";
await mkdir(out, { recursive: true });
await build({
  entryPoints: { page: "src/main.ts" },
  bundle: true, minify: true, format: "esm", target: "es2022", outdir: out, legalComments: "none",
});
for (const file of ["index.html", "icon.svg"]) await cp(file, `${out}/${file}`);
for (const file of ["index.html", "icon.svg", "page.js", "page.css"])
  await writeFile(`${out}/${file}.gz`, gzipSync(await readFile(`${out}/${file}`), { level: 9 }));
