// Leaves out of three.js the shaders of materials that the 3D view does not have: 10 kB of the compressed page.
import { readFileSync } from 'node:fs';

// What robot_scene.ts and robot_model.ts draw with: Lambert, basic and line materials, and shadows of a sun.
const materials = ['meshlambert', 'meshbasic', 'depth'];
const left = '#error this shader is left out of the page (host/page/unused_shaders.mjs)';

// Keeps the shaders of `materials` and what they include. Throws an Error if the file is not as this expects it.
function withoutUnusedShaders(text) {
  const table = /^const ShaderChunk = \{([^}]*)\};/m.exec(text)?.[1] ?? '';
  const variables = new Map([...table.matchAll(/(\w+): ([\w$]+)/g)].map(([, name, variable]) => [name, variable]));
  const texts = new Map([...text.matchAll(/^(?:var|const) ([\w$]+) = ("(?:[^"\\]|\\.)*");$/gm)].map(([, name, value]) => [name, value]));
  const pending = materials.flatMap((material) => [`${material}_vert`, `${material}_frag`]);
  // Those that the renderer adds by itself.
  pending.push(...[...text.matchAll(/ShaderChunk\[ '(\w+)' \]/g)].map(([, name]) => name));
  const used = new Set();
  while (pending.length > 0) {
    const name = pending.pop();
    const shader = texts.get(variables.get(name));
    if (shader === undefined) {
      throw new Error(`three.js: found no shader '${name}', expected it in ShaderChunk`);
    }
    if (!used.has(name)) {
      used.add(name);
      pending.push(...[...shader.matchAll(/#include <(\w+)>/g)].map(([, included]) => included));
    }
  }
  const unused = new Set([...variables].filter(([name]) => !used.has(name)).map(([, variable]) => variable));
  return text.replace(/^((?:var|const) ([\w$]+) = )"(?:[^"\\]|\\.)*";$/gm, (line, start, variable) =>
    unused.has(variable) ? `${start}${JSON.stringify(left)};` : line,
  );
}

export const unusedShaders = {
  name: 'unused shaders',
  setup({ onLoad }) {
    onLoad({ filter: /three\.module\.js$/ }, ({ path }) => ({ contents: withoutUnusedShaders(readFileSync(path, 'utf8')), loader: 'js' }));
  },
};
