import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { advanceWith, flashRows, flashWarnings } from '../../../../host/page/source/modules/flash_rows.js';
import type { JobEvents } from '../../../../host/page/source/wire/messages.js';
import { jobOf } from './module_job.js';

const verdict = (node: number, action: 'flash' | 'refuse' = 'flash') => ({ node, serial: node, board: 1, before: { version: '1.0.0' }, action, reason: 'older' });
const verdicts = { version: '2.0.0', sha256: '', modules: [verdict(1), verdict(2), verdict(3, 'refuse')] };
const flashing = (latest: JobEvents) => jobOf({ kind: 'flash', latest: { verdicts, ...latest } });
const progress = (node: number, part: number) => ({ modules: [{ node, serial: node, part, state: 'receives' }] });
const ended = (node: number, good: boolean) => ({ modules: [{ node, serial: node, outcome: good ? 'runs the image' : 'is lost', good }] });

describe('how far modules are with an image', () => {
  it('is their progress, and the outcome of one that was first stays', () => {
    let known = advanceWith(null, flashing({ progress: progress(1, 0.5) }));
    assert.deepEqual(known.bySerial.get(1), { part: 0.5, text: 'receives', isGood: null });
    known = advanceWith(known, flashing({ progress: progress(1, 1), ended: ended(1, true) }));
    assert.equal(known.bySerial.get(1)?.isGood, true);
    // The document has only the newest event of each name: the second module begins.
    known = advanceWith(known, flashing({ progress: progress(2, 0.1), ended: ended(1, true) }));
    known = advanceWith(known, flashing({ progress: progress(2, 1), ended: ended(2, false) }));
    assert.deepEqual([1, 2].map((serial) => known.bySerial.get(serial)?.isGood), [true, false]);
    const rows = flashRows(flashing({}), known);
    assert.deepEqual(
      rows.map(({ node, advance }) => [node, advance?.text ?? null]),
      [
        [1, 'runs the image'],
        [2, 'is lost'],
        [3, null],
      ],
    );
  });

  it('is forgotten with the next job', () => {
    const known = advanceWith(null, flashing({ ended: ended(1, true) }));
    const next = { ...flashing({}), number: 8 };
    assert.equal(advanceWith(known, next).bySerial.size, 0);
    assert.equal(flashRows(next, known)[0]?.advance, null);
  });

  it('is in the result in the end; a dry run has no outcome', () => {
    const modules = [{ ...verdict(1), outcome: 'runs the image', good: true, now: { version: '2.0.0' } }];
    const result = (dryRun: boolean) => flashRows(jobOf({ kind: 'flash', state: 'ended', result: { dry_run: dryRun, version: '2.0.0', modules } }), null)[0];
    assert.deepEqual([result(false)?.advance?.isGood, result(false)?.now], [true, '2.0.0']);
    assert.equal(result(true)?.advance, null);
  });

  it('ends with a warning for each setting that is another one, and for silent nodes', () => {
    const modules = [{ ...verdict(1), outcome: 'runs the image', good: true, now: null, changed_settings: ['0x6080: 720, now 300'] }];
    const job = jobOf({ kind: 'flash', state: 'ended', result: { dry_run: false, version: '2.0.0', modules, silent_nodes: [7] } });
    assert.deepEqual(flashWarnings(job), ['node 1: 0x6080: 720, now 300', 'No answer from node 7: Recover looks what it has.']);
    assert.deepEqual(flashWarnings(null), []);
  });
});
