// The notices of the npm packages whose code is in a bundle: names, versions and licences, which their terms ask for.
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const room = dirname(fileURLToPath(import.meta.url));

// The folders of the packages that have bytes in the outputs of esbuild's metafile.
function packagesOf({ outputs }) {
  const used = Object.values(outputs).flatMap(({ inputs }) => Object.entries(inputs).filter(([, { bytesInOutput }]) => bytesInOutput > 0));
  return used.flatMap(([file]) => /^.*node_modules\/(?:@[^/]+\/)?[^/]+/.exec(file)?.[0] ?? []);
}

function licenceOf(folder) {
  const file = readdirSync(join(room, folder)).find((name) => /^(licen[cs]e|copying)(\.\w+)?$/i.test(name));
  if (file === undefined) throw new Error(`${folder}: found no licence, expected the notice of a package that is in the page`);
  return readFileSync(join(room, folder, file), 'utf8').trim();
}

// Packages with the same licence share its text.
export function noticesOf(metafiles) {
  const named = new Map();
  for (const folder of [...new Set(metafiles.flatMap(packagesOf))].sort()) {
    const { name, version } = JSON.parse(readFileSync(join(room, folder, 'package.json'), 'utf8'));
    const licence = licenceOf(folder);
    named.set(licence, [...(named.get(licence) ?? []), `${name} ${version}`]);
  }
  const notices = [...named].map(([licence, names]) => `\n${names.join(', ')}\n\n${licence}\n`);
  return ['Contains code of these packages:\n', ...notices].join('');
}
