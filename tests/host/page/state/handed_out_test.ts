import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { newestUnseen, readSeen, storeSeen } from '../../../../host/page/source/state/handed_out.js';

const stairs = { number: 1, file: 'stairs/a.simulation.xml', title: 'stairs' };
const hills = { number: 2, file: 'hills/b.simulation.xml', title: 'hills' };

describe('what a teacher has handed out', () => {
  it('is told about once, the newest first', () => {
    assert.equal(newestUnseen([], null), null);
    assert.equal(newestUnseen([stairs], null), stairs);
    assert.equal(newestUnseen([stairs, hills], null), hills);
    assert.equal(newestUnseen([stairs, hills], stairs.file), hills);
    assert.equal(newestUnseen([stairs, hills], hills.file), null);
  });

  it('is new after the program has started again and counts from 1', () => {
    assert.deepEqual(newestUnseen([{ ...hills, number: 1 }], stairs.file), { ...hills, number: 1 });
  });

  it('is remembered for each seat in the tab', () => {
    const kept = new Map<string, string>();
    const storage = { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => void kept.set(key, value) };
    storeSeen('/robots/3/', hills.file, storage);
    assert.equal(readSeen('/robots/3/', storage), hills.file);
    assert.equal(readSeen('/robots/4/', storage), null);
  });
});
