// The command that the page shows, and what a command of proleg reports.
import { execFileSync } from 'node:child_process';
import { dirname, resolve } from 'node:path';
import { program } from './ui_program.js';
import type { Viewer } from './viewer.js';

const environment = { ...process.env, PATH: `${resolve(dirname(program))}:${process.env['PATH']}` };

export function resultOf(command: string): Record<string, unknown> {
  return JSON.parse(execFileSync('sh', ['-c', `${command} --json`], { env: environment, encoding: 'utf8' }));
}

export async function shownCommand(viewer: Viewer): Promise<string> {
  await viewer.page.keyboard.press('x');
  const shown = viewer.page.getByTestId('command').filter({ hasText: 'proleg simulate' });
  const command = (await shown.textContent()) ?? '';
  await viewer.page.keyboard.press('x');
  return command;
}
