// Makes the bundle that report.html holds: node build.mjs OUT.js, with the licences of what is in it
// in front. Node 18 or later.
import { build } from 'esbuild';
import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2];
const modules = process.argv[3] ?? join(here, 'node_modules');

function licence(name) {
  const folder = join(modules, name);
  const version = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8')).version;
  return `${name} ${version}\n\n${readFileSync(join(folder, 'LICENSE'), 'utf8').trim()}`;
}

const licences = ['three', 'uplot'].map(licence).join('\n\n----\n\n');
await build({
  entryPoints: [join(here, 'main.js')],
  outfile: out,
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'ascii',
  legalComments: 'none',
  loader: { '.css': 'text' },
  nodePaths: [modules],
  banner: { js: `/*! This file holds:\n\n${licences}\n*/` },
});
