import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { personName, viewerName, viewerNumber } from '../../../../host/page/source/state/viewer_name.js';
import { fittingName } from '../../../../host/page/source/wire/messages.js';

describe('the name of a viewer', () => {
  it('is browser, system and number, so that a person can tell two of them apart', () => {
    const chrome = 'Mozilla/5.0 (X11; Linux x86_64) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/120.0.0.0 Safari/537.36';
    assert.equal(viewerName(chrome, 417), 'Chrome on Linux #417');
    assert.equal(viewerName('curl', 1), 'A browser on another system #1');
  });

  it('is in a class that of the person', () => {
    const entered = { getItem: (key: string) => (key === 'proleg.name' ? 'Anna' : null) };
    assert.equal(personName(false, entered), 'Anna');
    assert.equal(personName(true, entered), 'Teacher', 'who looks at the robot of somebody else');
    assert.equal(personName(false, { getItem: () => null }), null);
  });

  it('has at most 60 characters, none of which is cut', () => {
    assert.equal(fittingName('STOP of Anna'), 'STOP of Anna');
    assert.equal(fittingName('🐛'.repeat(70)), '🐛'.repeat(60));
  });

  it('stays when the page is loaded again', () => {
    const kept = new Map<string, string>();
    const storage = { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => void kept.set(key, value) };
    const number = viewerNumber(storage);
    assert.ok(Number.isInteger(number) && number >= 1 && number <= 999, String(number));
    assert.equal(viewerNumber(storage), number);
    for (const wrong of ['', '0', '1000', '1.5', 'x']) {
      kept.set('viewer', wrong);
      const other = viewerNumber(storage);
      assert.ok(Number.isInteger(other) && other >= 1 && other <= 999, `${wrong}: ${other}`);
    }
  });
});
