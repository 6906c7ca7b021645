// The page Make: meshes of one's own. A file that is dropped becomes an object of the world, or a module of the robot; what
// is saved is what the command line reads. A file that cannot be used is one line, and changes nothing.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { seriousProblems } from './support/accessibility.js';
import { assertNothingIsCut } from './support/layout.js';
import { useUi } from './support/ui_fixture.js';
import { program, UiProgram } from './support/ui_program.js';
import { waitUntil } from './support/waiting.js';

type Triangle = readonly (readonly [number, number, number])[];

// A closed box with a corner at 0.
function boxTriangles(x: number, y: number, z: number): Triangle[] {
  const corner = (i: number) => [i & 4 ? x : 0, i & 2 ? y : 0, i & 1 ? z : 0] as const;
  const sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] as const;
  return sides.flatMap(([a, b, c, d]) => [[corner(a), corner(b), corner(c)], [corner(a), corner(c), corner(d)]]);
}

function stl(triangles: readonly Triangle[]): Buffer {
  const bytes = Buffer.alloc(84 + 50 * triangles.length);
  bytes.writeUInt32LE(triangles.length, 80);
  triangles.forEach((triangle, t) => triangle.flat().forEach((value, i) => bytes.writeFloatLE(value, 84 + 50 * t + 12 + 4 * i)));
  return bytes;
}

describe('a mesh of one’s own', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  cpSync('sim/scenarios/travelling_wave', join(folder, 'mine'), { recursive: true });
  const scenario = join(folder, 'mine/uniform.simulation.xml');
  const files = join(folder, 'files');
  execFileSync('mkdir', [files]);
  const write = (name: string, bytes: Buffer | string) => {
    writeFileSync(join(files, name), bytes);
    return join(files, name);
  };
  const box = stl(boxTriangles(300, 60, 40));
  const ui = useUi(() => UiProgram.start(scenario, ['--recordings', folder]), { takesControl: true });

  after(() => rmSync(folder, { recursive: true }));

  const page = () => ui.viewer.page;
  const region = (name: string) => page().getByRole('region', { name, exact: true });
  const state = async () => page().getByTestId('draft-state').textContent();
  const rowCount = () => region('Objects').getByRole('listitem').count();
  const refusal = () => page().getByRole('form', { name: 'New mesh' }).getByRole('alert');
  const choose = (paths: string[]) => page().getByTestId('mesh-file').setInputFiles(paths);

  // As a drag from the desktop ends.
  async function drop(name: string, bytes: Buffer): Promise<void> {
    const data = await page().evaluateHandle(
      ([fileName, base64]) => {
        const transfer = new DataTransfer();
        const binary = Uint8Array.from(atob(base64 as string), (character) => character.charCodeAt(0));
        transfer.items.add(new File([binary], fileName as string));
        return transfer;
      },
      [name, bytes.toString('base64')],
    );
    await page().locator('.make').dispatchEvent('dragover', { dataTransfer: data });
    await page().locator('.mesh-drop').waitFor();
    await page().locator('.make').dispatchEvent('drop', { dataTransfer: data });
  }

  it('is dropped on the world; nothing is added before somebody has said its unit', async () => {
    await page().keyboard.press('3');
    await page().getByTestId('map-top').waitFor();
    await drop('my wall.stl', box);
    const form = page().getByRole('form', { name: 'New mesh' });
    await form.getByRole('button', { name: 'mm: 300 × 60 × 40 mm (likely)' }).waitFor();
    await form.getByRole('button', { name: 'm: 300 × 60 × 40 m', exact: true }).waitFor();
    await form.getByRole('button', { name: 'inch: 7.62 × 1.52 × 1.02 m' }).waitFor();
    assert.equal(await rowCount(), 1);
    assert.equal(await state(), 'saved');
    await page().getByTestId('mesh-preview').waitFor();
    await ui.viewer.screenshot('mesh_world');
    await assertNothingIsCut(ui.viewer);
    assert.deepEqual(await seriousProblems(ui.viewer), []);
  });

  it('stands in front of the robot then, as large as its unit makes it', async () => {
    await page().getByRole('button', { name: 'Add my wall.stl' }).click();
    await region('Objects').getByRole('button', { name: 'my wall', exact: true }).waitFor();
    const field = (name: string) => region('Objects').getByRole('textbox', { name, exact: true });
    assert.ok(await waitUntil(async () => (await field('size x in m').inputValue()) === '0.3'), await field('size x in m').inputValue());
    assert.equal(await field('size z in m').inputValue(), '0.04');
    assert.equal(await state(), '2 files changed');
    assert.ok(!existsSync(join(folder, 'mine/meshes')), 'nothing on disk changes before Save');
    await field('scale by').fill('2');
    await field('scale by').press('Enter');
    assert.ok(await waitUntil(async () => (await field('size x in m').inputValue()) === '0.6'), await field('size x in m').inputValue());
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await field('size x in m').inputValue()) === '0.3'));
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await state()) === 'saved'), 'its file goes with it');
    await page().keyboard.press('Control+y');
    assert.ok(await waitUntil(async () => (await rowCount()) === 2));
  });

  it('of a usual size in metres is added at once; an OBJ file comes with its materials', async () => {
    await page().getByRole('button', { name: 'Mesh …' }).click();
    const obj = write('post.obj', 'mtllib post.mtl\nusemtl red\nv 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n');
    await choose([obj, write('post.mtl', 'newmtl red\nKd 1 0 0\n')]);
    await region('Objects').getByRole('button', { name: 'post', exact: true }).waitFor();
    assert.equal(await state(), '4 files changed');
  });

  it('that cannot be used is one line, and nothing is added', async () => {
    await page().getByRole('button', { name: 'Mesh …' }).click();
    const before = await rowCount();
    const twoMillion = Buffer.alloc(84 + 50 * 2_000_000);
    twoMillion.writeUInt32LE(2_000_000, 80);
    const bad: [string, Buffer | string, RegExp][] = [
      ['large.stl', twoMillion, /'large.stl' of 96 MiB, expected at most 16 MiB and 100000 triangles/],
      ['many.stl', stl(Array<Triangle>(100_001).fill(boxTriangles(1, 1, 1)[0] as Triangle)), /many.stl.*100000/],
      ['cut.stl', box.subarray(0, 300), /cut.stl/],
      ['noise.obj', Buffer.from(Array.from({ length: 3000 }, (_, i) => (i * 7919) % 256)), /noise.obj/],
      ['empty.stl', '', /'empty.stl', which is empty/],
      ['text.txt', 'a', /'text.txt', expected a name that ends with .stl, .obj, .dae or .off/],
      ['.hidden.stl', box, /the name '.hidden.stl'/],
    ];
    for (const [name, bytes, line] of bad) {
      await choose([write(name, bytes)]);
      await refusal().filter({ hasText: line }).waitFor();
      assert.equal((await refusal().textContent())?.includes('\n'), false);
    }
    await choose([write('a.stl', box), write('b.stl', box)]);
    await refusal().filter({ hasText: "'a.stl' and 'b.stl', expected one mesh at a time" }).waitFor();
    assert.equal(await rowCount(), before);
    assert.equal(await state(), '4 files changed');
  });

  it('that is a sheet is added only as one, and only if it faces up', async () => {
    const sheet = (up: boolean): Triangle[] => {
      const corners = [[0, 0, 0], [0.5, 0, 0], [0.5, 0.5, 0], [0, 0.5, 0]] as const;
      const order = up ? [[0, 1, 2], [0, 2, 3]] : [[0, 2, 1], [0, 3, 2]];
      return order.map((triangle) => triangle.map((i) => corners[i]!));
    };
    const before = await rowCount();
    await choose([write('down.stl', stl(sheet(false)))]);
    await refusal().filter({ hasText: 'a mesh with holes' }).waitFor();
    const add = page().getByRole('button', { name: 'Add down.stl' });
    assert.ok(await add.isDisabled());
    await page().getByRole('checkbox', { name: /it is a sheet/ }).check();
    await add.click();
    await refusal().filter({ hasText: 'face down' }).waitFor();
    assert.equal(await rowCount(), before);
    await page().getByRole('button', { name: 'turn about x: 0°' }).click();
    await page().getByRole('button', { name: 'turn about x: 90°' }).click();
    await add.click();
    assert.ok(await waitUntil(async () => (await rowCount()) === before + 1));
    await page().getByTestId('map-top').focus();
    await page().keyboard.press('Control+z');
    assert.ok(await waitUntil(async () => (await rowCount()) === before));
  });

  it('becomes a module of the robot', async () => {
    await page().getByRole('tab', { name: 'Robot' }).click();
    const link = stl(boxTriangles(40, 30, 62));
    await drop('shell.stl', link);
    const form = page().getByRole('form', { name: 'Module of my own' });
    await form.getByRole('button', { name: 'mm: 40 × 30 × 62 mm (likely)' }).waitFor();
    const along = form.getByRole('textbox', { name: 'from joint to joint in m' });
    assert.equal(await along.inputValue(), '0.03');
    await form.getByRole('button', { name: 'turn about x: 0°' }).click();
    assert.ok(await waitUntil(async () => (await along.inputValue()) === '0.062'), await along.inputValue());
    assert.equal(await form.getByRole('textbox', { name: 'mass in kg' }).inputValue(), '0.0372');
    await along.fill('0,07');
    await along.press('Enter');
    await ui.viewer.screenshot('mesh_module');
    await assertNothingIsCut(ui.viewer);
    assert.deepEqual(await seriousProblems(ui.viewer), []);
    await form.getByRole('button', { name: 'Head', exact: true }).click();
    await form.getByRole('button', { name: 'Use it for 1 link' }).click();
    const kinds = page().getByRole('group', { name: 'Modules of the robot' });
    await kinds.getByRole('button', { name: 'shell', exact: true }).waitFor();
    await kinds.getByRole('button', { name: 'shell', exact: true }).click();
    // The robot, three modules and their mesh; the world and two meshes, one with materials.
    assert.ok(await waitUntil(async () => (await state()) === '9 files changed'), (await state()) ?? '');
    await ui.viewer.screenshot('mesh_robot');
  });

  it('is saved as it came, and the command line computes the same run', async () => {
    await page().keyboard.press('Control+s');
    const panel = page().getByTestId('save-panel');
    await panel.getByText('bytes that are not shown as text').first().waitFor();
    await panel.getByRole('button', { name: 'Save', exact: true }).click();
    assert.ok(await waitUntil(async () => (await state()) === 'saved'));
    assert.deepEqual(readFileSync(join(folder, 'mine/meshes/my wall.stl')), box);
    await page().getByRole('button', { name: 'Simulate' }).click();
    await page().getByRole('navigation').locator('[aria-current=page]', { hasText: 'Live' }).waitFor();
    for (let i = 0; i < 3; i += 1) await page().keyboard.press('.'); // a step, then it pauses
    await ui.viewer.waitForTick(1);
    await page().keyboard.press('x');
    await page().getByTestId('setpoint-hash').waitFor();
    const command = (await page().getByTestId('command').textContent()) ?? '';
    const seconds = /--seconds ([\d.]+)/.exec(command)?.[1];
    assert.ok(seconds !== undefined, command);
    const json = execFileSync(program, ['simulate', scenario, '--seconds', seconds, '--json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
    const run = JSON.parse(json) as { setpoint_hash: string; servo_hash: string };
    assert.equal(await page().getByTestId('setpoint-hash').textContent(), run.setpoint_hash);
    assert.equal(await page().getByTestId('servo-hash').textContent(), run.servo_hash);
  });
});
