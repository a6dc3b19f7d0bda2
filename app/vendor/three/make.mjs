// Bundles what the page uses of three.js into one script that defines `THREE`:
//
//   npm ci --ignore-scripts && node make.mjs
//
// writes three-subset.min.js, the same bytes each time; `node make.mjs FILE` writes them elsewhere.
import { buildSync } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const near = name => fileURLToPath(new URL(name, import.meta.url));
const { version } = JSON.parse(readFileSync(near('node_modules/three/package.json'), 'utf8'));
const [{ text }] = buildSync({
  entryPoints: [near('entry.js')],
  bundle: true, minify: true, format: 'iife', globalName: 'THREE', target: 'es2022', charset: 'ascii', legalComments: 'none', write: false,
}).outputFiles;
const licence = readFileSync(near('LICENSE'), 'utf8').trim();
const banner = `/*!\nthree.js ${version}, a part of it, minified. https://threejs.org\n\n${licence}\n*/\n`;
// the script stands in a page, and must not end its element
writeFileSync(process.argv[2] ?? near('three-subset.min.js'), banner + text.replaceAll(/<(?=\/?script)/gi, '\\x3c'));
