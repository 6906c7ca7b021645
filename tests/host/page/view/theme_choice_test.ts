import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { otherTheme } from '../../../../host/page/source/view/theme_choice.js';

describe('the key of the theme', () => {
  it('changes how the page looks with each press, and goes back to the system', () => {
    for (const systemIsDark of [false, true]) {
      let isDark = systemIsDark;
      for (let press = 0; press < 4; press += 1) {
        const choice = otherTheme(isDark, systemIsDark);
        const looksDark = choice === 'system' ? systemIsDark : choice === 'dark';
        assert.equal(looksDark, !isDark);
        assert.equal(choice === 'system', looksDark === systemIsDark);
        isDark = looksDark;
      }
    }
  });
});
