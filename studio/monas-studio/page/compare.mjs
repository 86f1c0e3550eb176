// Fails unless the committed assets are what the present sources build. Compares what is in the
// files, since versions of Node compress differently.
import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';

let differs = false;
for (const name of ['index.html', 'studio.js', 'studio.css']) {
  const built = readFileSync(new URL(`dist/${name}`, import.meta.url));
  const kept = gunzipSync(readFileSync(new URL(`../assets/${name}.gz`, import.meta.url)));
  if (!built.equals(kept)) {
    console.error(`assets/${name}.gz differs from the page: run \`npm run build\` in studio/monas-studio/page`);
    differs = true;
  }
}
process.exit(differs ? 1 : 0);
