import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { objections, resultText, verdictText } from '../../../../../host/page/source/make/algorithm/proof_text.js';
import type { AlgorithmCheck, Proof, ProofBuild } from '../../../../../host/page/source/wire/messages.js';

const build = (result: ProofBuild['result'], text: string | null = null): ProofBuild => ({
  build: 'g++ -O2',
  kernels: 5,
  result,
  ticks: 50000,
  setpoint_hash: 'a'.repeat(64),
  servo_hash: 'b'.repeat(64),
  text,
});

const good: Proof = {
  algorithm: 'my_wave',
  id: 119,
  sources: '0xCC31605C',
  cases: 50,
  ticks: 1000,
  verified: true,
  builds: [build('reference'), build('equal')],
  missing: [],
  test: { name: 'my_wave_test', passed: true, error: null },
  forbidden: [],
  instructions: { worst: 617, mean: 617, limit: 2500, fits: true, error: null },
  stack: { bytes: 336, function: 'proleg::Kernel::advance', limit: 512, fits: true },
  flash_bytes: 604,
};

const check = (part: Partial<AlgorithmCheck>): AlgorithmCheck => ({
  folder: 'my_wave',
  name: 'my_wave',
  version: 'a',
  state: 'failed',
  error: null,
  done: 17,
  of: 17,
  step: null,
  proof: null,
  ...part,
});

describe('the proof of an algorithm', () => {
  it('says the verdict in a line', () => {
    assert.equal(verdictText(check({ state: 'running', done: 3, step: 'building with g++' })), 'Proving, step 3 of 17: building with g++ …');
    assert.equal(verdictText(check({ state: 'running', done: 0, of: 0 })), 'The proof begins …');
    assert.equal(verdictText(check({ state: 'passed', proof: good })), 'Verified: the same bits everywhere.');
    assert.equal(verdictText(check({ error: 'my_wave.cpp:3: error' })), 'Not verified: my_wave.cpp:3: error.');
    const differs = { ...good, verified: false, builds: [build('reference'), build('differs')] };
    assert.equal(verdictText(check({ proof: differs })), 'Not verified: 1 build of 2 computed other bits.');
  });

  it('names everything that speaks against the algorithm', () => {
    assert.deepEqual(objections(good), []);
    const bad: Proof = {
      ...good,
      verified: false,
      builds: [build('reference'), build('failed'), build('not run', 'clang++'), build('not run', 'clang++')],
      missing: ['clang++'],
      test: { name: 'my_wave_test', passed: false, error: 'line 3' },
      forbidden: ['uses the heap (malloc)'],
      instructions: { worst: 2501, mean: 600, limit: 2500, fits: false, error: null },
      stack: { bytes: 520, function: 'proleg::Kernel::advance', limit: 512, fits: false },
    };
    assert.deepEqual(objections(bad), [
      '1 build of 4 failed',
      'clang++ is not installed',
      'its test fails',
      'its code uses what a module does not have',
      'a tick takes too long on the chip',
      'it needs too much stack on the chip',
    ]);
  });

  it('says of each build what came out', () => {
    assert.equal(resultText(build('equal')), 'equal');
    assert.equal(resultText(build('differs', 'case 0, tick 3, joint 2: set-point 5 instead of 4')), 'differs: case 0, tick 3, joint 2: set-point 5 instead of 4');
    assert.equal(resultText(build('not run', 'clang++')), 'not run: clang++ is not installed');
  });
});
