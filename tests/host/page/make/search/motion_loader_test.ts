import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { MotionLoader } from '../../../../../host/page/source/make/search/motion_loader.js';
import type { RobotDocument } from '../../../../../host/page/source/wire/messages.js';
import { motionBytes } from '../../support/motion_bytes.js';
import { caterpillar, SearchProgram } from '../../support/search_program.js';

const wave = { name: 'searches/wave', run: 0, joints: 5 };
const soon = 250; // milliseconds, longer than the loader waits

function loaderOf() {
  const program = new SearchProgram();
  const loader = new MotionLoader(program.host, program.after);
  // The requests for motions of candidates, and of the draft.
  const ofCandidates = () => program.ofName('search.motion').filter(({ words }) => words['name'] !== undefined);
  const ofDraft = () => program.ofName('search.motion').filter(({ words }) => words['name'] === undefined);
  return { program, loader, ofCandidates, ofDraft };
}

async function shown() {
  const { program, loader, ofCandidates, ofDraft } = loaderOf();
  loader.want({ ...wave, number: 7 });
  await program.pass(soon);
  await ofCandidates().at(-1)?.answer(motionBytes());
  await ofDraft().at(-1)?.answer(motionBytes());
  return { program, loader, ofCandidates, ofDraft, motion: program.motion };
}

describe('what the 3D view plays', () => {
  it('is the draft and the chosen candidate, when both are there', async () => {
    const { program, loader, ofCandidates, ofDraft } = loaderOf();
    await program.pass(soon);
    assert.equal(program.asked.length, 0, 'nothing is computed before a candidate is chosen');
    loader.want({ ...wave, number: 7 });
    await program.pass(soon);
    assert.deepEqual(ofCandidates()[0]?.words, { name: 'searches/wave', run: 0, number: 7 });
    await ofCandidates().at(-1)?.answer(motionBytes());
    assert.deepEqual([program.host.motion.value, loader.isWaiting.value], [null, true]);
    await ofDraft().at(-1)?.answer(motionBytes());
    assert.equal(program.host.motion.value?.compared.legend, 'candidate');
    assert.deepEqual([loader.isWaiting.value, loader.problem.value], [false, null]);
  });

  it('is the newest candidate of several; the one before stays until it is there', async () => {
    const { program, loader, ofCandidates, motion } = await shown();
    const before = motion.value;
    loader.want({ ...wave, number: 8 });
    loader.want({ ...wave, number: 9 });
    await program.pass(soon);
    assert.equal(motion.value, before);
    assert.deepEqual(ofCandidates().map(({ words }) => words['number']), [7, 9]);
    await ofCandidates().at(-1)?.answer(motionBytes({ angle: 5 }));
    assert.notEqual(motion.value, before);
    assert.equal(motion.value?.draft, before?.draft);
  });

  it('follows a change of the draft without beginning anew', async () => {
    const { program, ofCandidates, ofDraft, motion } = await shown();
    motion.value?.seekSeconds(0.02);
    if (motion.value !== null) motion.value.time.isPlaying.value = false;
    program.draft.value = caterpillar({ revision: 2 });
    await program.pass(soon);
    await ofDraft().at(-1)?.answer(motionBytes({ angle: 20 }));
    assert.equal(ofCandidates().length, 1);
    assert.deepEqual([motion.value?.seconds, motion.value?.time.isPlaying.value], [0.02, false]);
  });

  it('is nothing while another part of the page is shown, or no candidate is chosen', async () => {
    const { program, loader, motion } = await shown();
    program.isShown.value = false;
    assert.equal(motion.value, null);
    program.isShown.value = true;
    assert.notEqual(motion.value, null);
    loader.want(null);
    assert.equal(motion.value, null);
    assert.equal(loader.problem.value, null);
  });

  it('is nothing if the robot of the search has another number of joints: one line says so', async () => {
    const { program, loader, ofCandidates, motion } = await shown();
    loader.want({ ...wave, joints: 8, number: 7 });
    await program.pass(soon);
    assert.deepEqual([motion.value, ofCandidates().length], [null, 1]);
    assert.equal(loader.problem.value, 'The robot of this search has 8 joints, that of the draft 5: they are not shown together.');
    program.draftRobot.value = { joints: new Array(8).fill({}) } as unknown as RobotDocument;
    await program.pass(soon);
    assert.deepEqual([loader.problem.value, ofCandidates().length], [null, 2]);
  });

  it('is nothing if the candidate has no motion; the reason is shown', async () => {
    const { program, loader, ofCandidates, motion } = await shown();
    loader.want({ ...wave, number: 8 });
    await program.pass(soon);
    await ofCandidates().at(-1)?.refuse('the robot left the ground');
    assert.equal(motion.value, null);
    assert.equal(loader.problem.value, 'the robot left the ground');
  });

  it('comes again when the connection is there again', async () => {
    const { program, loader, ofCandidates, ofDraft } = loaderOf();
    loader.want({ ...wave, number: 7 });
    await program.pass(soon);
    program.connect(false);
    await ofCandidates().at(-1)?.refuse('the connection was lost before the answer');
    await ofDraft().at(-1)?.refuse('the connection was lost before the answer');
    program.connect(true);
    await program.pass(soon);
    await ofCandidates().at(-1)?.answer(motionBytes());
    await ofDraft().at(-1)?.answer(motionBytes());
    assert.notEqual(program.host.motion.value, null);
    assert.equal(loader.problem.value, null);
  });
});
