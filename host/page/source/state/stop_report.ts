// The text of the page after STOP.
import { signal } from '@preact/signals-core';
import type { StopChannel, StopOutcome } from '../wire/stop_channel.js';

export type StopReport =
  | { state: 'none' }
  | { state: 'sent' }
  | { state: 'stopped'; outcome: StopOutcome }
  | { state: 'unconfirmed'; reason: string };

export class StopControl {
  readonly report = signal<StopReport>({ state: 'none' });
  private presses = 0;

  constructor(private readonly channel: StopChannel) {}

  press(): void {
    const press = ++this.presses;
    const show = (report: StopReport) => {
      if (press === this.presses) this.report.value = report;
    };
    const showOutcome = (outcome: StopOutcome) => show({ state: 'stopped', outcome });
    show({ state: 'sent' });
    this.channel.press(showOutcome).then(
      showOutcome,
      (error: Error) => show({ state: 'unconfirmed', reason: error.message }),
    );
  }

  clear(): void {
    this.report.value = { state: 'none' };
  }
}

// Whether the stop is confirmed, so that the power switch is not needed.
export function isConfirmed(report: StopReport): boolean {
  return report.state === 'stopped' && (report.outcome.confirmed === null || report.outcome.confirmed === report.outcome.of);
}

// `whose`: what has confirmed, if it is not said.
export function describeStop(report: StopReport, whose = ''): string {
  switch (report.state) {
    case 'none':
      return '';
    case 'sent':
      return 'STOP sent …';
    case 'unconfirmed':
      return `STOP is not confirmed: ${report.reason}. Use the power switch.`;
    case 'stopped': {
      const { ms, confirmed, of } = report.outcome;
      const numbers = confirmed === null ? '' : `, ${confirmed} of ${of}${whose} confirmed`;
      const advice = isConfirmed(report) ? '' : '. Use the power switch.';
      return `stopped in ${Math.max(1, Math.round(ms))} ms${numbers}${advice}`;
    }
  }
}
