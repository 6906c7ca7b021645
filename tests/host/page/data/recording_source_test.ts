import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { pyramidBlock } from '../../../../host/page/source/data/min_max_pyramid.js';
import {
  historyFor,
  loadTicks,
  type RecordedRows,
  type RecordingDocuments,
  type RecordingSource,
} from '../../../../host/page/source/data/recording_source.js';
import { makeSignal } from '../support/telemetry.js';

// Pieces of a recording with one value in a tick.
function sourceOf(pieces: readonly { tick: number; values: number[] }[]): RecordingSource {
  return {
    documents: { telemetry: { hash: 0, tick_us: 10000, signals: [makeSignal('angle', 1)] } } as RecordingDocuments,
    async *rows(): AsyncIterable<RecordedRows> {
      for (const { tick, values } of pieces) {
        yield { tick, rows: values.length, width: 1, values: Int32Array.from(values) };
      }
    },
  };
}

describe('a recording', () => {
  it('is read piece by piece, and keeps its ticks', async () => {
    const history = historyFor(5);
    const seen: number[] = [];
    const source = sourceOf([
      { tick: 3, values: [10, 11] },
      { tick: 5, values: [12, 13, 14] },
    ]);
    await loadTicks(source, history, 3, 7, (tick) => seen.push(tick));
    assert.deepEqual(seen, [4, 7]);
    assert.equal(history.end, 5);
    assert.equal(history.valueAt('angle', 0, history.rowAtTick(6)), 13);
  });

  it('has room for all of its ticks', () => {
    for (const ticks of [1, pyramidBlock, pyramidBlock + 1]) {
      assert.ok(historyFor(ticks).capacity >= ticks);
    }
  });

  it('is refused if ticks are missing', async () => {
    const gap = sourceOf([
      { tick: 0, values: [1, 2] },
      { tick: 3, values: [3] },
    ]);
    await assert.rejects(loadTicks(gap, historyFor(4), 0, 3), /found tick 3, expected tick 2/);
    await assert.rejects(loadTicks(sourceOf([{ tick: 0, values: [1, 2] }]), historyFor(4), 0, 3), /up to 1, expected ticks up to 3/);
  });
});
