// A class: each learner has a robot, the teacher sees, helps and stops them all.
import assert from 'node:assert/strict';
import { existsSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import type { Browser } from 'playwright-core';
import { seriousProblems } from './support/accessibility.js';
import { launchBrowser } from './support/browser.js';
import { ClassProgram, Learner, Teacher } from './support/class_program.js';
import { assertNothingIsCut } from './support/layout.js';
import { countDifferences, pixelsOf } from './support/pixels.js';
import type { Look, Viewer } from './support/viewer.js';
import { waitUntil } from './support/waiting.js';

const looks: readonly Look[] = [
  { name: 'wide_light', width: 1400, colours: 'light' },
  { name: 'tablet_dark', width: 800, colours: 'dark' },
  { name: 'phone_light', width: 360, colours: 'light' },
  { name: 'phone_dark', width: 360, colours: 'dark' },
];
const allStopped = /3 of 3 robots confirmed/;
const unfriendly = '<script>alert(1)</script>';

async function assertLooksWell(viewer: Viewer, name: string): Promise<void> {
  for (const look of looks) {
    await viewer.lookAs(look);
    assert.deepEqual(await seriousProblems(viewer), [], look.name);
    await assertNothingIsCut(viewer);
    await viewer.screenshot(`class_${name}_${look.name}`);
  }
  await viewer.lookAs(looks[0] as Look);
}

// Controls smaller than a finger, in pixels.
async function smallTargets(viewer: Viewer): Promise<string[]> {
  return viewer.page.evaluate(() =>
    [...document.querySelectorAll<HTMLElement>('button, input, select, a.button')]
      .filter((element) => element.checkVisibility() && element.getBoundingClientRect().height < 42)
      .map((element) => `${element.tagName} ${element.textContent ?? ''} ${element.getBoundingClientRect().height}`),
  );
}

describe('a class', () => {
  let browser!: Browser;
  let program!: ClassProgram;
  let teacher!: Teacher;
  let anna!: Learner;
  let ben!: Learner;
  const people: { viewer: Viewer }[] = [];

  const come = async (address = program.entry) => {
    const learner = await Learner.at(browser, address);
    people.push(learner);
    return learner;
  };
  const leave = async (person: { viewer: Viewer }) => {
    people.splice(people.indexOf(person), 1);
    await person.viewer.close();
  };

  before(async () => {
    browser = await launchBrowser();
    program = await ClassProgram.start(12);
    teacher = await Teacher.at(browser, program.address);
    people.push(teacher);
    anna = await come();
  });

  after(async () => {
    try {
      for (const { viewer } of people) await viewer.close();
    } finally {
      await program.end();
      await browser.close();
    }
  });

  it('begins with the address and the code, to be read from afar', async () => {
    assert.equal((await teacher.page.getByTestId('address').textContent()) ?? '', program.entry);
    const code = `${program.code.slice(0, 3)} ${program.code.slice(3)}`;
    assert.equal(await teacher.page.getByTestId('code').textContent(), code);
    await teacher.viewer.button('Show large').click();
    const large = teacher.page.getByRole('dialog', { name: 'How to join' });
    await large.getByText(code).waitFor();
    await large.locator(`[data-link="${program.entry}#join=${program.code}"]`).waitFor();
    await assertLooksWell(teacher.viewer, 'way_in');
    await teacher.viewer.button(/^STOP/).click({ trial: true });
    await teacher.page.keyboard.press('Escape');
    await large.waitFor({ state: 'detached' });
  });

  it('has an entry for tablets and for the keyboard alone', async () => {
    await assertLooksWell(anna.viewer, 'entry');
    assert.deepEqual(await smallTargets(anna.viewer), []);
    await anna.page.getByLabel('Your name').focus();
    await anna.page.keyboard.type('Anna');
    await anna.page.keyboard.press('Tab');
    await anna.page.keyboard.type(program.wrongCode);
    await anna.page.keyboard.press('Enter');
    await anna.problem('code', /not the code/);
    await anna.viewer.screenshot('class_wrong_code');
  });

  it('says with one line what is wrong, where it is', async () => {
    await anna.write('', program.code);
    await anna.problem('name', /Write your name/);
    await anna.write('Anna', '12');
    await anna.problem('code', /6 digits/);
    const name = anna.page.getByLabel('Your name');
    await name.fill('x'.repeat(10_000));
    assert.equal((await name.inputValue()).length, 40, 'the field takes no more');
    // A program that is not the page.
    const answer = await anna.page.evaluate(async (code) => {
      const response = await fetch('/join', { method: 'POST', body: JSON.stringify({ name: 'x'.repeat(10_000), code }) });
      return { status: response.status, text: await response.text() };
    }, program.code);
    assert.ok([400, 413].includes(answer.status), String(answer.status));
    assert.equal(answer.text.trim().includes('\n'), false);
  });

  it('gives a robot and control of it to who has the code', async () => {
    await anna.join('Anna', program.code);
    assert.equal(anna.seat(), '/robots/1/');
    assert.equal(new URL(anna.page.url()).hash, '', 'the token has left the address');
    await anna.viewer.button('Release').waitFor();
    assert.equal(await anna.viewer.button('Modules').count(), 0);
    await anna.viewer.screenshot('class_learner');
    ben = await come(`${program.entry}#join=${program.code}`);
    await ben.viewer.screenshot('class_entry_by_link');
    await ben.join('Ben', null);
    assert.equal(ben.seat(), '/robots/2/');
  });

  it('gives a name once', async () => {
    const other = await come();
    await other.write('ANNA', program.code);
    await other.problem('name', /has the name/);
    await leave(other);
  });

  it('shows any name as text', async () => {
    const other = await come(`${program.entry}#join=${program.code}`);
    await other.join(unfriendly, null);
    await teacher.waitForState(unfriendly, 'runs');
    assert.equal(await teacher.page.locator('script').count(), 1, 'that of the page');
    assert.equal(await other.page.locator('script').count(), 1);
    await other.page.goto(program.entry);
    await other.viewer.button(`Go on as ${unfriendly}`).waitFor();
    await assertLooksWell(other.viewer, 'go_on');
    await other.viewer.button(`Forget ${unfriendly} on this computer`).click();
    await other.viewer.button(`Go on as ${unfriendly}`).waitFor({ state: 'detached' });
    await leave(other);
    await teacher.waitForState(unfriendly, 'not there, robot runs');
    await teacher.act(unfriendly, 'Remove');
    await teacher.tile(unfriendly).waitFor({ state: 'detached' });
  });

  it('lets each drive a robot of his or her own', async () => {
    const before = await ben.amplitude();
    await anna.setAmplitude('21');
    assert.equal(await anna.amplitude(), '21');
    await ben.viewer.pause();
    await anna.viewer.waitForState('running');
    assert.equal(await ben.amplitude(), before);
    await ben.viewer.run();
  });

  it('gives the same robot and control after a reload, and to who comes back', async () => {
    await anna.page.reload();
    await anna.waitForRobot('Anna');
    await anna.viewer.button('Release').waitFor();
    assert.equal(await anna.amplitude(), '21');
    await anna.page.goto(program.entry);
    await teacher.waitForState('Anna', 'not there, robot runs');
    await anna.viewer.button('Go on as Anna').click();
    await anna.waitForRobot('Anna');
    await anna.viewer.button('Release').waitFor();
    assert.equal(anna.seat(), '/robots/1/');
    assert.equal(await anna.amplitude(), '21');
    await teacher.waitForState('Anna', 'runs');
  });

  it('shows a page without a token the way to the start page', async () => {
    const lost = await come(`${program.entry}robots/1/`);
    await lost.page.getByRole('link', { name: 'Go to the start page of the class' }).click();
    await lost.page.getByLabel('Your name').waitFor();
    await leave(lost);
  });

  it('shows the teacher every robot as it moves', async () => {
    for (const name of ['My robot', 'Anna', 'Ben']) {
      await teacher.waitForState(name, 'runs');
      const picture = teacher.tile(name).locator('canvas');
      const first = await pixelsOf(teacher.page, picture);
      assert.ok(await waitUntil(async () => countDifferences(first, await pixelsOf(teacher.page, picture)) > 100), name);
    }
    await teacher.tile('Ben').getByTestId('speed').getByText(/^\d+ mm\/s$/).waitFor();
    await assertLooksWell(teacher.viewer, 'tiles');
    assert.deepEqual(await smallTargets(teacher.viewer), []);
  });

  it('sorts the tiles by who is fastest', async () => {
    await teacher.page.getByLabel('Sort by').selectOption('speed');
    const names = async () => (await teacher.page.locator('.tile h2').allTextContents()).join();
    // With half the amplitude, Anna's robot is slower.
    assert.ok(await waitUntil(async () => (await names()) === 'My robot,Ben,Anna'), await names());
    await teacher.page.getByLabel('Sort by').selectOption('name');
    assert.ok(await waitUntil(async () => (await names()) === 'My robot,Anna,Ben'), await names());
  });

  it('lets the teacher look at a robot while its learner drives', async () => {
    const looking = await teacher.open('Anna');
    await looking.page.getByTestId('person').getByText('Anna', { exact: true }).waitFor();
    await looking.page.getByTestId('control').filter({ hasText: 'Anna has control' }).waitFor();
    await looking.button('Ask for control').click();
    await anna.page.getByText('Teacher asks for control').waitFor();
    await anna.viewer.button('Keep control').click();
    await anna.page.getByText('Teacher asks for control').waitFor({ state: 'detached' });
    await anna.page.reload();
    await anna.waitForRobot('Anna');
    await anna.viewer.button('Release').waitFor();
    await looking.page.close();
  });

  it('hands out a scenario, which a learner opens or not', async () => {
    await teacher.viewer.button('Hand out …').click();
    await teacher.page.getByLabel('Find a scenario').fill('turning');
    await teacher.dialog().getByRole('button', { name: /^Turning/ }).first().click();
    assert.deepEqual(await seriousProblems(teacher.viewer), []);
    await teacher.viewer.screenshot('class_hand_out');
    await teacher.dialog().getByRole('button', { name: 'Hand out', exact: true }).click();
    const result = teacher.page.getByTestId('hand-out-result').getByRole('listitem');
    await result.nth(1).waitFor();
    assert.match((await result.first().textContent()) ?? '', /^Anna .*turning\.simulation\.xml$/);
    await teacher.viewer.button('Done').click();
    const band = (learner: Learner) => learner.page.getByTestId('handed-out');
    await band(ben).getByRole('button', { name: 'Later' }).click();
    await band(ben).waitFor({ state: 'detached' });
    await band(anna).getByText('Your teacher has handed out “turning”.').waitFor();
    await anna.viewer.screenshot('class_handed_out');
    await band(anna).getByRole('button', { name: 'Open' }).click();
    await anna.page.getByTestId('draft-file').getByText('turning.simulation.xml').waitFor();
    await band(anna).waitFor({ state: 'detached' });
    await ben.page.reload();
    await ben.waitForRobot('Ben');
    assert.equal(await band(ben).count(), 0);
    await anna.viewer.button('Live').click();
  });

  it('hands out to one learner, whose unsaved draft is asked about', async () => {
    await ben.viewer.button('Make').click();
    await ben.page.getByRole('region', { name: 'Library' }).getByRole('button', { name: 'box', exact: true }).click();
    await ben.viewer.button('Add box').click();
    assert.ok(await waitUntil(() => ben.viewer.button('Undo').isEnabled()));
    await teacher.tile('Ben').getByRole('button', { name: /Hand out$/ }).click();
    await teacher.dialog().getByRole('button', { name: /^Forward/ }).first().click();
    await teacher.dialog().getByRole('button', { name: 'Hand out', exact: true }).click();
    await teacher.page.getByTestId('hand-out-result').getByRole('listitem').first().waitFor();
    assert.equal(await teacher.page.getByTestId('hand-out-result').getByRole('listitem').count(), 1);
    await teacher.viewer.button('Done').click();
    await ben.page.getByTestId('handed-out').getByRole('button', { name: 'Open' }).click();
    await ben.page.getByTestId('loss-question').getByRole('button', { name: 'Go on without them' }).click();
    await ben.page.getByTestId('draft-file').getByText('forward.simulation.xml').waitFor();
    assert.equal(await anna.page.getByTestId('handed-out').count(), 0);
    await ben.viewer.button('Live').click();
  });

  it('sends a message to one or all', async () => {
    await teacher.tile('Ben').getByRole('button', { name: /Message$/ }).click();
    await teacher.page.getByLabel('Text').fill('Well done');
    await teacher.page.keyboard.press('Enter');
    await teacher.dialog().waitFor({ state: 'detached' });
    await ben.page.getByText('Your teacher: Well done').waitFor();
    await teacher.viewer.button('Message …').click();
    await teacher.page.getByLabel('Text').fill('Look at the board');
    assert.deepEqual(await seriousProblems(teacher.viewer), []);
    await teacher.viewer.button('Send').click();
    for (const { page } of [anna, ben]) await page.getByText('Your teacher: Look at the board').waitFor();
    assert.equal(await anna.page.getByText('Well done').count(), 0);
  });

  it('collects what learners have recorded', async () => {
    await teacher.viewer.button('Collect recordings').click();
    await teacher.page.getByTestId('collected').getByText('There are no recordings yet.').waitFor();
    await teacher.viewer.button('Done').click();
    await anna.viewer.button('Record').click();
    await teacher.tile('Anna').getByText('records').waitFor();
    await anna.viewer.button('Recording').click();
    await anna.viewer.button('Record').waitFor();
    const collect = async (expected: string) => {
      await teacher.viewer.button('Collect recordings').click();
      await teacher.page.getByTestId('collected').getByText(expected, { exact: true }).waitFor();
    };
    await collect('1 recording copied.');
    await teacher.viewer.screenshot('class_collected');
    const opened = teacher.page.context().waitForEvent('page');
    await teacher.page.getByRole('link', { name: 'Show them' }).click();
    const recordings = await opened;
    await recordings.getByTestId('recordings').getByText(/collected\/Anna\//).first().waitFor();
    await recordings.close();
    await teacher.viewer.button('Done').click();
    await collect('0 recordings copied, 1 was there.');
    await teacher.viewer.button('Done').click();
  });

  it('has a STOP for all, also from a second page of the teacher', async () => {
    await teacher.page.keyboard.press('Space');
    assert.match(await teacher.viewer.stopReport(allStopped), allStopped);
    for (const { viewer } of [anna, ben]) await viewer.waitForState('STOPPED');
    for (const name of ['My robot', 'Anna', 'Ben']) await teacher.waitForState(name, 'STOPPED');
    await teacher.viewer.screenshot('class_stopped');
    const second = await Teacher.at(browser, program.address);
    people.push(second);
    await second.waitForState('Anna', 'STOPPED');
    await anna.viewer.run();
    await second.waitForState('Anna', 'runs');
    await second.viewer.button(/^STOP/).click();
    await anna.viewer.waitForState('STOPPED');
    assert.match(await second.viewer.stopReport(allStopped), allStopped);
    await leave(second);
  });

  it('stops the robot of one learner by the learner alone', async () => {
    await anna.viewer.run();
    await ben.viewer.run();
    await anna.viewer.button(/^STOP/).click();
    await anna.viewer.waitForState('STOPPED');
    await ben.viewer.waitForState('running');
    await teacher.waitForState('Ben', 'runs');
  });

  it('can be locked', async () => {
    await teacher.viewer.button('Lock').click();
    await teacher.page.getByText('Nobody new can join.').waitFor();
    const other = await come(`${program.entry}#join=${program.code}`);
    await other.write('Carla', null);
    await other.problem('name', /locked/);
    await leave(other);
    await ben.page.goto(program.entry);
    await ben.viewer.button('Go on as Ben').click();
    await ben.waitForRobot('Ben');
    await teacher.viewer.button('Locked').click();
    await teacher.viewer.button('Lock').waitFor();
  });

  it('starts a robot again, and its page goes on', async () => {
    const lost = ben.page.waitForFunction(() => document.querySelector('[data-testid=connection-band]') !== null); // in each frame
    await teacher.act('Ben', 'Start again');
    await lost;
    await ben.page.getByTestId('connection-band').waitFor({ state: 'detached' });
    await ben.viewer.button('Release').waitFor();
    await teacher.waitForState('Ben', /^(runs|paused)$/);
  });

  it('lets a learner in again with another browser', async () => {
    await teacher.tile('Anna').getByRole('button', { name: /More$/ }).click();
    assert.deepEqual(await seriousProblems(teacher.viewer), []);
    await teacher.viewer.screenshot('class_more');
    await teacher.dialog().getByRole('button', { name: 'Close', exact: true }).click();
    await teacher.act('Anna', 'Let in again');
    const other = await come();
    await other.join('Anna', program.code);
    assert.equal(other.seat(), '/robots/1/');
    await anna.page.getByTestId('connection-band').filter({ hasText: 'This page has lost its robot' }).waitFor();
    await anna.viewer.screenshot('class_lost');
    await anna.page.getByRole('link', { name: 'Go to the start page of the class' }).click();
    await anna.viewer.button('Go on as Anna').click();
    await anna.problem('code', /no robot of this name any more/);
    await leave(anna);
    anna = other;
    await teacher.waitForState('Anna', /^(runs|paused)$/);
    assert.ok(readdirSync(join(program.folder, 'Anna')).some((name) => name.endsWith('.proleg')), 'the files stay');
  });

  it('removes a learner, whose name is free then and whose files stay', async () => {
    await teacher.act('Anna', 'Remove');
    await teacher.tile('Anna').waitFor({ state: 'detached' });
    await anna.page.getByTestId('connection-band').waitFor();
    assert.ok(existsSync(join(program.folder, 'Anna')));
    const next = await come(`${program.entry}#join=${program.code}`);
    await next.join('Anna', null);
    await teacher.waitForState('Anna', 'runs');
  });

  it('says that the teacher’s address is another one, and lets this tab show the entry', async () => {
    const other = await come(`${program.entry}#${'x'.repeat(43)}`);
    await other.page.getByTestId('connection-band').filter({ hasText: 'does not accept this page' }).waitFor();
    await other.page.getByRole('link', { name: 'To the entry of learners' }).click();
    await other.page.getByLabel('Your name').waitFor();
    await leave(other);
  });
});
