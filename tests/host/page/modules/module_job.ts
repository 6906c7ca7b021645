// Jobs for tests.
import type { ModuleJob } from '../../../../host/page/source/wire/messages.js';

export function jobOf(words: Partial<ModuleJob>): ModuleJob {
  return {
    number: 7,
    kind: 'scan',
    state: 'running',
    by: 'test',
    command: 'proleg scan',
    latest: {},
    question: null,
    lines: [],
    result: null,
    status: null,
    error: null,
    ended_by: null,
    ...words,
  };
}
