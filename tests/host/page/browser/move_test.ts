// A paused robot is moved by hand. The recording has it, and the command of the page repeats it.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { resultOf, shownCommand } from './support/command_line.js';
import { countDifferences, isBlue, pixelsInside, pixelsOf } from './support/pixels.js';
import { useUi } from './support/ui_fixture.js';
import { UiProgram, uniform } from './support/ui_program.js';
import { waitForFrames, waitUntil } from './support/waiting.js';

describe('moving the robot', () => {
  const folder = mkdtempSync(join(tmpdir(), 'proleg-page-'));
  const ui = useUi(() => UiProgram.start(uniform, ['--recordings', folder]), { takesControl: true });

  after(() => rmSync(folder, { recursive: true }));

  const form = () => ui.viewer.page.getByRole('form', { name: 'Place of the head' });
  type Place = [number, number, number];
  // Where the program says that the head is: metres.
  const headOfProgram = async () => {
    const values = await Promise.all(['x', 'y', 'z'].map((axis) => form().locator(`[name="${axis}"]`).inputValue()));
    return values.map(Number) as Place;
  };
  const distance = (a: Place, b: Place) => Math.hypot(...a.map((value, axis) => value - (b[axis] as number)));
  // Waits until the program has the head nearer than 2 mm to a place.
  const waitForHead = async (place: Place) => {
    let head = await headOfProgram();
    const isThere = await waitUntil(async () => distance((head = await headOfProgram()), place) <= 0.002);
    assert.ok(isThere, `found the head at ${head.join()}, expected ${place.join()}`);
  };
  // Waits until the program has the head at another place than this, and returns where.
  const headOtherThan = async (before: Place) => {
    let head = await headOfProgram();
    const isElsewhere = await waitUntil(async () => distance((head = await headOfProgram()), before) >= 0.02);
    assert.ok(isElsewhere, `the program has the head at ${head.join()}`);
    return head;
  };
  // Waits until the 3D view shows the head at another place than this, and returns where.
  const shownHeadOtherThan = async (before: Place) => {
    await ui.viewer.page.waitForFunction(
      (old) => {
        const numbers = [...(document.querySelector('[data-testid=head]')?.textContent ?? '').matchAll(/-?\d+\.\d+/g)].map(Number);
        return numbers.length === 3 && numbers.some((value, i) => Math.abs(value - (old[i] as number)) > 0.004);
      },
      before,
    );
    return ui.viewer.head();
  };
  // The picture of where the program has the robot: the view of a busy computer comes later.
  const stillPicture = async () => {
    assert.ok(await waitUntil(async () => distance(await ui.viewer.head(), await headOfProgram()) <= 0.002));
    const scene = ui.viewer.page.getByTestId('scene');
    let picture = await pixelsOf(ui.viewer.page, scene);
    const isStill = await waitUntil(async () => {
      const before = picture;
      await waitForFrames(ui.viewer.page, 20);
      picture = await pixelsOf(ui.viewer.page, scene);
      return countDifferences(before, picture) === 0;
    });
    assert.ok(isStill, 'the picture of a paused robot stands still');
    return picture;
  };
  // A point of the robot on the page, near its middle. Not at an edge: between two links the robot has gaps.
  const middleOfRobot = async () => {
    const scene = ui.viewer.page.getByTestId('scene');
    const box = await scene.boundingBox();
    const inside = pixelsInside(await stillPicture(), isBlue);
    assert.ok(inside.length > 20, 'the robot is in the picture');
    const mean = (axis: 'x' | 'y') => inside.reduce((sum, point) => sum + point[axis], 0) / inside.length;
    const [meanX, meanY] = [mean('x'), mean('y')];
    const awayOf = ({ x, y }: { x: number; y: number }) => Math.hypot(x - meanX, y - meanY);
    const { x, y } = inside.reduce((nearest, point) => (awayOf(point) < awayOf(nearest) ? point : nearest));
    return { x: (box?.x ?? 0) + x + 0.5, y: (box?.y ?? 0) + y + 0.5 };
  };

  it('is not possible while it runs', async () => {
    await ui.viewer.run();
    await ui.viewer.waitForTick(60);
    assert.equal(await ui.viewer.button('Move').isDisabled(), true);
    await ui.viewer.pause();
    assert.equal(await ui.viewer.button('Move').isEnabled(), true);
  });

  it('follows a drag over the ground, and keeps the height', async () => {
    const { mouse } = ui.viewer.page;
    await ui.viewer.button('Move').click();
    const before = await headOfProgram();
    const picture = await stillPicture();
    const { x, y } = await middleOfRobot();
    await mouse.move(x, y);
    await mouse.down();
    for (let step = 1; step <= 8; step += 1) await mouse.move(x + 12 * step, y + 2 * step);
    await shownHeadOtherThan(before);
    await ui.viewer.screenshot('move');
    await mouse.up();
    const after = await headOtherThan(before);
    assert.ok(Math.abs(after[2] - before[2]) < 0.002, `the height ${before[2]} m is now ${after[2]} m`);
    assert.ok(countDifferences(picture, await stillPicture()) > 200);
  });

  it('follows a drag that is over before a busy view has drawn anything of it', async () => {
    const before = await headOfProgram();
    const { x, y } = await middleOfRobot();
    await ui.viewer.page.getByTestId('scene').evaluate((scene, [fromX, fromY]) => {
      const fire = (type: string, clientX: number) => {
        const options = { bubbles: true, pointerId: 1, button: 0, isPrimary: true, clientX, clientY: fromY };
        scene.dispatchEvent(new PointerEvent(type, options));
      };
      scene.setPointerCapture = () => {}; // the pointer of a script cannot be captured
      fire('pointerdown', fromX);
      fire('pointermove', fromX - 60);
      fire('pointerup', fromX - 60);
    }, [x, y] as const);
    await headOtherThan(before);
  });

  it('goes by keys, each of which counts', async () => {
    const [x, y, z] = await headOfProgram();
    const { keyboard } = ui.viewer.page;
    // Wherever the focus is: on the button that was pressed, on the view.
    await ui.viewer.button('Move').focus();
    for (const key of ['ArrowRight', 'ArrowRight']) await keyboard.press(key);
    await ui.viewer.page.getByTestId('scene').focus();
    for (const key of ['ArrowRight', 'ArrowUp', 'Shift+ArrowUp', 'Shift+ArrowUp']) await keyboard.press(key);
    await waitForHead([x + 0.03, y + 0.01, z + 0.02]);
    await keyboard.press('ArrowLeft');
    await waitForHead([x + 0.02, y + 0.01, z + 0.02]);
    assert.equal(await ui.viewer.page.getByTestId('frozen').count(), 0, 'the time cursor is not moved');
  });

  it('goes to a typed place, and refuses one without ground', async () => {
    const type = async (place: Record<string, string>) => {
      for (const [name, value] of Object.entries(place)) await form().locator(`[name="${name}"]`).fill(value);
    };
    await type({ x: '0,4', y: '-0.3', z: '0.1', turn: '45' });
    // What is typed stays while the program says where the robot is.
    await ui.viewer.page.waitForTimeout(1200);
    await form().getByRole('button', { name: 'Put there' }).click();
    await waitForHead([0.4, -0.3, 0.1]);
    await ui.viewer.page.getByTestId('head').getByText('x 0.400 y -0.300 z 0.100 m').waitFor();
    await type({ x: '1900', y: '0', z: '0', turn: '0' });
    await form().getByRole('button', { name: 'Put there' }).click();
    await ui.viewer.page.getByText(/found nothing below the robot/).first().waitFor();
    assert.deepEqual(await ui.viewer.head(), [0.4, -0.3, 0.1]);
    assert.equal(await form().locator('[name="x"]').inputValue(), '1900', 'the numbers can be corrected');
  });

  it('is recorded, and repeated by the command of the page', async () => {
    await ui.viewer.button('Record').click();
    await ui.viewer.button('Recording').waitFor();
    await ui.viewer.run();
    await ui.viewer.waitForTick((await ui.viewer.tick()) + 80);
    await ui.viewer.pause();
    const command = await shownCommand(ui.viewer);
    await ui.viewer.button('Recording').click();
    await ui.viewer.button('Record').waitFor();
    assert.ok((command.match(/--move /g)?.length ?? 0) >= 4, command);
    const [file] = readdirSync(folder);
    const replayed = resultOf(`proleg replay ${join(folder, file as string)}`);
    assert.equal(replayed['differences'], 0);
    assert.equal(replayed['verified'], true);
    const repeated = resultOf(command);
    assert.equal(repeated['servo_hash'], replayed['recorded_servo_hash']);
    // The hash is of what the joints are told; the measures are of what the robot does.
    const distance = (result: Record<string, unknown>) => `${(result['measures'] as { distance: number }).distance.toFixed(3)} m`;
    await ui.viewer.page.locator('dl', { hasText: 'distance' }).getByText(distance(repeated)).waitFor();
    assert.notEqual(distance(resultOf(command.replace(/ --move \S+/g, ''))), distance(repeated));
  });
});
