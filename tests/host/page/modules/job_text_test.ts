import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { isRunning, jobState, numberIn, placeWord, unitOf, valueWithoutUnit, valueWord, waitOf, waitText } from '../../../../host/page/source/modules/job_text.js';
import { resultOf } from '../../../../host/page/source/wire/module_messages.js';
import { jobOf } from './module_job.js';

describe('a job', () => {
  it('goes on until it has ended', () => {
    assert.equal(isRunning(null), false);
    assert.equal(isRunning(jobOf({ state: 'ending' })), true);
    assert.equal(isRunning(jobOf({ state: 'ended' })), false);
  });

  it('waits for modules until no time is left', () => {
    const waits = (left_s: number) => ({ waits: { seconds: 8, left_s, seen: 4 } });
    assert.equal(waitOf(null), null);
    assert.equal(waitOf(jobOf({ kind: 'recover' })), null);
    assert.equal(waitOf(jobOf({ kind: 'recover', latest: waits(2.5) }))?.left_s, 2.5);
    assert.equal(waitOf(jobOf({ kind: 'recover', latest: waits(0) })), null);
    assert.equal(waitOf(jobOf({ kind: 'recover', state: 'ended', latest: waits(2.5) })), null);
    assert.deepEqual(waitText({ seconds: 8, left_s: 2.5, seen: 1 }), { text: '1 module was seen', left: '3 s left' });
    assert.equal(waitText({ seconds: 8, left_s: 2.5, seen: 0 }).text, 'no module was seen yet');
  });

  it('is in words what the document says', () => {
    const text = (words: Parameters<typeof jobOf>[0]) => jobState(jobOf(words)).text;
    assert.equal(text({ question: { number: 1, question: 'lower', node: 3 } }), 'waits for an answer');
    assert.equal(text({ state: 'ended', status: 0 }), 'done');
    assert.equal(text({ kind: 'examine', state: 'ended', status: 1, result: { findings: [] } }), 'done');
    assert.equal(text({ kind: 'flash', state: 'ended', status: 1, result: { modules: [] } }), 'ended: not all is well');
    assert.equal(text({ kind: 'recover', state: 'ended', status: 1, result: { dry_run: true, modules: [] } }), 'done, nothing was changed');
    assert.equal(text({ kind: 'load', state: 'ended', status: 1 }), 'failed');
    assert.equal(text({ state: 'ended', status: null }), 'ended by a signal');
    assert.equal(text({ state: 'ended', status: null, ended_by: 'STOP' }), 'ended early: STOP');
  });

  it('has a result only of its kind, and if it is complete', () => {
    const job = jobOf({ kind: 'flash', result: { modules: [] } });
    assert.notEqual(resultOf(job, 'flash'), null);
    assert.equal(resultOf(job, 'recover'), null);
    assert.equal(resultOf(jobOf({ kind: 'flash', result: {} }), 'flash'), null);
    assert.equal(resultOf(null, 'flash'), null);
  });
});

describe('what a person types', () => {
  it('is a joint by its name, whatever the case, or the word as it is', () => {
    const joints = [{ name: 'J1' }, { name: 'Hip' }];
    assert.equal(placeWord(' hip ', joints), 'Hip');
    assert.equal(placeWord('3', joints), '3');
  });

  it('may have a decimal comma', () => {
    assert.equal(valueWord(' 12,5 '), '12.5');
    assert.equal(valueWord('0x10'), '0x10');
    assert.equal(numberIn('7,5', 1, 30), 7.5);
    assert.equal(numberIn('31', 1, 30), "found '31', expected a number from 1 to 30");
    assert.equal(typeof numberIn('', 0, 30), 'string');
  });

  it('begins with the value without its unit', () => {
    assert.deepEqual(['2000 mA', '0x1 (1)', '-90 deg', '0'].map(valueWithoutUnit), ['2000', '0x1', '-90', '0']);
    assert.deepEqual(['2000 mA', '0x1 (1)', '-90 deg', '0', '592 (no power)'].map(unitOf), ['mA', '', 'deg', '', '']);
  });
});
