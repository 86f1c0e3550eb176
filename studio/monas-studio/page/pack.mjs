// Compresses the built page into the crate's assets; gzip without a time, so that equal pages are
// equal files.
import { readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

let total = 0;
for (const name of ['index.html', 'studio.js', 'studio.css']) {
  const packed = gzipSync(readFileSync(new URL(`dist/${name}`, import.meta.url)), { level: 9 });
  // the system that packed it
  packed[9] = 255;
  writeFileSync(new URL(`../assets/${name}.gz`, import.meta.url), packed);
  total += packed.length;
}
console.log(`assets: ${total} bytes`);
