import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { imageStateText, roomText, versionText } from '../../../../../host/page/source/make/algorithm/image_text.js';
import type { AlgorithmImage, BuiltImage } from '../../../../../host/page/source/wire/messages.js';

const work = (part: Partial<AlgorithmImage>): AlgorithmImage => ({
  algorithms: [{ folder: 'my_wave', name: 'my_wave' }],
  state: 'failed',
  error: null,
  done: 0,
  of: 0,
  messages: [],
  image: null,
  ...part,
});

describe('the build of an image', () => {
  it('says how far it is, and why it has failed', () => {
    assert.equal(imageStateText(work({ state: 'running' })), 'The build of the image begins …');
    assert.equal(imageStateText(work({ state: 'running', done: 3, of: 125 })), 'Building the image: 3 of 125 …');
    assert.equal(imageStateText(work({ error: 'the disk of /a is full' })), 'The image was not built: the disk of /a is full.');
    const messages = [{ file: 'my_wave.cpp', line: 3, column: 1, severity: 'error', text: 'no' } as const];
    assert.equal(imageStateText(work({ error: 'ninja: build stopped', messages: [...messages] })), 'The image was not built: my_wave.cpp, line 3: no.');
  });

  it('names the room that is left, and the version', () => {
    assert.equal(roomText(82448, 90112), '82448 of 90112 bytes, 7664 are left');
    assert.equal(roomText(null, 90112), 'not known');
    const image = { version: '0.1.0', commit: '5267b59d'.padEnd(40, '0'), changed_sources: true } as BuiltImage;
    assert.equal(versionText(image), '0.1.0 (5267b59d + changes)');
    assert.equal(versionText({ ...image, changed_sources: false }), '0.1.0 (5267b59d)');
    assert.equal(versionText({ ...image, commit: null }), '0.1.0');
  });
});
