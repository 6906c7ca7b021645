// A second recording beside the first: what is said of the two, and when it is asked again.
import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { ComparedRecording, comparisonText, isDecided, wayText } from '../../../../host/page/source/recordings/compared_recording.js';
import type { RecordingClient } from '../../../../host/page/source/recordings/recording_client.js';
import { Playback } from '../../../../host/page/source/state/playback.js';
import type { RunComparison } from '../../../../host/page/source/wire/messages.js';

const begun: RunComparison = { first_tick: 10, last_tick: 209, compared: 50, difference: null, damage: null, head_m: [0.5, null] };

describe('the line about two recordings', () => {
  it('names the common ticks, and how far the comparison is', () => {
    assert.equal(comparisonText(begun), 'ticks 10 to 209 are in both; comparing … 25 %');
  });

  it('says that all set-points are the same only when all were compared', () => {
    assert.equal(isDecided(begun), false);
    const all = { ...begun, compared: 200 };
    assert.equal(isDecided(all), true);
    assert.match(comparisonText(all), /the same set-points in all 200 ticks, bit for bit$/);
  });

  it('names the first difference', () => {
    const different = { ...begun, difference: { tick: 42, joint: 'J2' } };
    assert.equal(isDecided(different), true);
    assert.match(comparisonText(different), /the set-points differ from tick 42 on \(J2\)$/);
  });

  it('says where the motion departs, although all set-points are the same', () => {
    const moved = { ...begun, compared: 200, motion: { difference: { tick: 57, part: "link 'Tail'" } } };
    assert.match(comparisonText(moved), /the motion departs from tick 57 on \(link 'Tail'\); the same set-points in all 200 ticks, bit for bit$/);
    const same = { ...begun, compared: 200, motion: { difference: null } };
    assert.match(comparisonText(same), /the same motion and the same set-points in all 200 ticks, bit for bit$/);
    assert.match(comparisonText({ ...begun, motion: null }), /the motion was not compared, because a robot was not simulated; comparing … 25 %$/);
  });

  it('goes on until the motion departs, too', () => {
    const different = { ...begun, difference: { tick: 42, joint: 'J2' }, motion: { difference: null } };
    assert.equal(isDecided(different), false);
    assert.equal(isDecided({ ...different, motion: { difference: { tick: 43, part: "link '1Seg'" } } }), true);
    assert.equal(isDecided({ ...different, motion: null }), true);
  });

  it('says how far the heads moved, if that is known', () => {
    assert.equal(wayText(begun), 'head: 0.500 m, second not known');
  });
});

// A recording without signals, as the program answers.
function client(compare: RecordingClient['compare']): RecordingClient {
  const recording = { first_tick: 10, last_tick: 209, finished: true, indexed: 200, damage: null, has_path: false };
  const documents = { robot: {}, telemetry: { signals: [], tick_us: 10000 }, recording, parameters: [] };
  return { file: 'second.proleg', open: async () => documents, compare } as unknown as RecordingClient;
}

const settle = () => new Promise((done) => setImmediate(done));

describe('a second recording', () => {
  it('is not opened if the two cannot be compared', async () => {
    const first = client(() => Promise.reject(new Error('found 20 joints, expected 5')));
    await assert.rejects(ComparedRecording.open(first, client(first.compare)), /found 20 joints/);
  });

  it('is asked about from time to time, until all is compared', async () => {
    const answers = [begun, { ...begun, compared: 120 }, { ...begun, compared: 200 }];
    let asked = 0;
    const first = client(async () => answers[asked++] as RunComparison);
    let now = 0;
    const compared = await ComparedRecording.open(first, client(first.compare), () => now);
    const time = new Playback(10, 209, 100);
    const frame = async () => {
      compared.advance(time, new Set());
      compared.advance(time, new Set());
      await settle();
    };
    await frame();
    assert.equal(asked, 1, 'not at each frame');
    for (now = 1000; now < 10_000; now += 1000) {
      await frame();
    }
    assert.equal(asked, 3, 'nothing is left to compare');
    assert.equal(compared.comparison.value.compared, 200);
  });
});
