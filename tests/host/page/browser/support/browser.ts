// Debian's Chromium, without a display and with WebGL in software.
import { chromium, type Browser } from 'playwright-core';
import { longest } from './waiting.js';

export function launchBrowser(): Promise<Browser> {
  return chromium.launch({
    // The binary itself: /usr/bin/chromium is a script that adds options.
    executablePath: process.env['PROLEG_CHROMIUM'] ?? '/usr/lib/chromium/chromium',
    args: ['--enable-unsafe-swiftshader'],
    timeout: longest,
  });
}
